"""How a Gazebo model moves: the key frames of a pose animation, in the source of the model plugin that plays it."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from arena_core import InputFileError
from arena_core.files import LIMITS, read_bytes
from arena_worlds.formats.xml_file import parse_numbers

ROUNDING = 0.011  # s; sources have two digits
NUMBER = r"\s*([-+0-9.eE]+)\s*"
LENGTH = re.compile(rf'PoseAnimation\(\s*"[^"]*"\s*,{NUMBER},\s*(true|false)\s*\)')
KEY_FRAME = re.compile(rf"CreateKeyFrame\({NUMBER}\)")
PLACE = re.compile(rf"Translation\(\s*ignition::math::Vector3d\({NUMBER},{NUMBER},{NUMBER}\)")
SOURCE = """#include <gazebo/gazebo.hh>
#include <gazebo/physics/physics.hh>
#include <gazebo/common/common.hh>
#include <ignition/math.hh>

namespace gazebo
{{
  class {name} : public ModelPlugin
  {{
    public: void Load(physics::ModelPtr _parent, sdf::ElementPtr)
    {{
      common::PoseAnimationPtr anim(new common::PoseAnimation("{name}", {length:.2f}, true));
      common::PoseKeyFrame *key;
{frames}
      _parent->SetAnimation(anim);
    }}
  }};
  GZ_REGISTER_MODEL_PLUGIN({name})
}}
"""
FRAME = """      key = anim->CreateKeyFrame({stamp:.2f});
      key->Translation(ignition::math::Vector3d({x:.2f}, {y:.2f}, 0));
      key->Rotation(ignition::math::Quaterniond(0, 0, 0));"""


@dataclass(frozen=True, slots=True, eq=False)
class Animation:
    """Key frames: ``stamps`` (K,) s, from 0 on, and ``positions`` (K, 2) m in
    ``map``; after the last one it begins again.
    """

    stamps: NDArray[np.float64]
    positions: NDArray[np.float64]


def animation_source(name: str, animation: Animation) -> str:
    """Return the C++ source of a Gazebo plugin that moves its model so; stamps and positions to the hundredth."""
    places = zip(animation.stamps.tolist(), animation.positions.tolist(), strict=True)
    frames = "\n".join(FRAME.format(stamp=stamp, x=x, y=y) for stamp, (x, y) in places)
    return SOURCE.format(name=name, length=animation.stamps[-1], frames=frames)


def read_animation(path: Path) -> Animation:
    """Read the key frames of a plugin's source; raise InputFileError where it holds none, or not
    in the order of their stamps.
    """
    text = read_bytes(path, LIMITS.source_bytes, "the source of a pose animation").decode("utf-8", "replace")
    stamps, places = (
        _read_numbers(path, KEY_FRAME.findall(text)),
        _read_numbers(path, [" ".join(xyz) for xyz in PLACE.findall(text)]),
    )
    if len(stamps) < 2 or len(stamps) != len(places):
        raise InputFileError(
            f"{path}: has {len(stamps)} CreateKeyFrame(s) and {len(places)} Translation(...Vector3d(x, y, z)); "
            "allowed: two or more of each, as many"
        )
    times = stamps[:, 0]
    _check_times(path, text, times)
    return Animation(times, places[:, :2].copy())


def _read_numbers(path: Path, texts: list[str]) -> NDArray[np.float64]:
    rows = [parse_numbers(text) for text in texts]
    wrong = [text for text, row in zip(texts, rows, strict=True) if row is None]
    if wrong:
        raise InputFileError(f"{path}: a key frame has {wrong[0]!r}; allowed: numbers within 10 km")
    return np.array(rows, np.float64)


def _check_times(path: Path, text: str, times: NDArray[np.float64]) -> None:
    if times[0] != 0.0 or (np.diff(times) < 0.0).any() or times[-1] <= 0.0:
        raise InputFileError(f"{path}: key frames are at {times[:4].tolist()} ... s; allowed: 0 first, then rising")
    length = LENGTH.search(text)
    lasts = parse_numbers(length[1]) if length is not None else None
    if length is None or lasts is None or length[2] != "true" or abs(lasts[0] - times[-1]) > ROUNDING:
        said = "missing" if length is None else f"{length[1]}, {length[2]}"
        raise InputFileError(
            f"{path}: PoseAnimation is {said}; allowed: {times[-1]:g}, the last key frame's, and true (it repeats)"
        )
