"""Policy cards: what a policy was trained for, in a JSON file beside the ONNX file of the same name."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from arena_core import InputFileError, ObservationField
from arena_core.commands import one_line
from arena_core.files import read_json, write_text_whole

MOST_EVERY = 100  # control steps for which one answer may hold
FORMAT = "arena-policy"
VERSION = 1


@dataclass(frozen=True, slots=True)
class PolicyCard:
    """What has to match before a policy drives, and what its users want to know.

    ``encoder`` is the encoder's name with its parameters, ``layout`` the fields that it makes; ``action`` the names of
    the actions with what -1 and 1 mean (m/s, rad/s); ``content_sha256`` is that of the ONNX file. ``training`` holds
    seed, configuration, steps, curve, evaluation and package versions, and is read by people alone. ``members`` are the
    planners that a switch chooses among, in the order of the network's answers, each with its ``content_sha256``,
    ``distribution`` and ``version``; the actions of a switch are the whole range of the robot's. ``every`` is for how
    many control steps an answer holds. ``parts`` are the hashes of the networks that the encoder runs, by the parameter
    that names each.
    """

    planner: str
    robot: str
    kinematics: str
    control_period: float
    encoder: Mapping[str, Any]
    layout: Sequence[ObservationField]
    action: Mapping[str, Sequence[float]]
    action_range: Mapping[str, Any]
    sha256: str
    training: Mapping[str, Any] = field(default_factory=dict)
    members: Mapping[str, Mapping[str, str]] = field(default_factory=dict)
    parts: Mapping[str, str] = field(default_factory=dict)
    every: int = 1


def write_card(path: Path, card: PolicyCard) -> None:
    """Write a card, whole or not at all."""
    content = {"format": FORMAT, "version": VERSION, **asdict(card)}
    write_text_whole(path, json.dumps(content, indent=1, allow_nan=False) + "\n")


def read_card(path: Path) -> PolicyCard:
    """Read a card; raise InputFileError with file and key for anything that is not one."""
    content = read_json(path, "a policy with its card beside it (docs/policies.md)")
    if not isinstance(content, dict) or content.get("format") != FORMAT or content.get("version") != VERSION:
        raise InputFileError(
            f"{path}: format and version are not {FORMAT} {VERSION}; allowed: a card that `arena train` wrote"
        )
    try:
        return PolicyCard(
            planner=str(content["planner"]),
            robot=str(content["robot"]),
            kinematics=str(content["kinematics"]),
            control_period=float(content["control_period"]),
            encoder=dict(content["encoder"]),
            layout=tuple(_read_field(fields) for fields in content["layout"]),
            action={str(name): tuple(map(float, ends)) for name, ends in content["action"].items()},
            action_range=dict(content["action_range"]),
            sha256=str(content["sha256"]),
            training=dict(content["training"]),
            members={str(name): _read_member(member) for name, member in content.get("members", {}).items()},
            parts={_check_part_name(name): str(value) for name, value in content.get("parts", {}).items()},
            every=_check_every(content.get("every", 1)),
        )
    except KeyError as error:
        raise InputFileError(f"{path}: {error.args[0]} is missing; allowed: a card as in docs/policies.md") from None
    except (AttributeError, TypeError, ValueError, OverflowError) as error:
        raise InputFileError(
            f"{path}: is no policy card ({one_line(str(error))}); allowed: a card as in docs/policies.md"
        ) from None


def _read_field(fields: Mapping[str, Any]) -> ObservationField:
    made = ObservationField(**fields)
    if not all(isinstance(text, str) for text in (made.name, made.unit, made.meaning)):
        raise TypeError("a field of layout has no name, unit or meaning")
    return made


def _read_member(member: Mapping[str, Any]) -> dict[str, str]:
    return {key: str(member[key]) for key in ("sha256", "distribution", "version")}


def _check_every(value: Any) -> int:
    if not isinstance(value, int) or isinstance(value, bool) or not 1 <= value <= MOST_EVERY:
        raise ValueError(f"every is {value!r}, not a whole number from 1 to {MOST_EVERY}")
    return value


def _check_part_name(name: str) -> str:
    if not name.isidentifier():
        raise ValueError(f"parts has {name!r}, which names no parameter")
    return name


def content_sha256(content: bytes) -> str:
    """Return the hash that names a file's content."""
    return hashlib.sha256(content).hexdigest()


def part_path(policy: Path, name: str) -> Path:
    """Return where a network that the policy's encoder runs lies: ``jackal.vision.onnx`` beside ``jackal.onnx``."""
    return policy.with_name(f"{policy.stem}.{name}.onnx")
