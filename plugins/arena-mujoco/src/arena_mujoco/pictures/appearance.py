"""How pictures look: the figures of looks.yaml."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from typing import Annotated

import yaml

from arena_core.parameters import Bounds, Positive, read_settings

Colour = list[float]


@dataclass(frozen=True, slots=True)
class Follow:
    """A camera behind the robot: ``distance`` m, ``elevation`` deg, smoothed over ``calm`` s."""

    distance: Positive
    elevation: Annotated[float, Bounds(low=-89.0, high=0.0)]
    calm: Positive


@dataclass(frozen=True, slots=True)
class Top:
    """A camera above all: ``margin`` m around the map."""

    margin: Positive


@dataclass(frozen=True, slots=True)
class Onboard:
    """A camera at the front of the robot: ``above`` m over its top, opening ``fovy`` deg upright."""

    above: Positive
    fovy: Annotated[float, Bounds(low=10.0, high=150.0)]


@dataclass(frozen=True, slots=True)
class Appearance:
    """Colours (red, green, blue, opacity), heights m, cameras."""

    robot: Colour
    mates: list[Colour]
    nose: Colour
    wheel: Colour
    wall: Colour
    door: Colour
    furniture: Colour
    floor: list[Colour]
    goal: Colour
    path: Colour
    trail: Colour
    returns: Colour
    skin: Colour
    legs: Colour
    people: list[Colour]
    wall_height: Positive
    hip: Positive
    shoulder: Positive
    head: Positive
    head_radius: Positive
    torso: Positive
    leg: Positive
    line: Positive
    dot: Positive
    follow: Follow
    top: Top
    onboard: Onboard


@cache
def load_appearance() -> Appearance:
    """Return what the package ships."""
    return read_settings(
        yaml.safe_load((files("arena_mujoco.pictures") / "looks.yaml").read_text()), Appearance, "looks"
    )
