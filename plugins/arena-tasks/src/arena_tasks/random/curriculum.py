"""Curriculum files: levels of rising difficulty, numbered from 0 without a gap (docs/scenarios.md)."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from hashlib import blake2b
from importlib.resources import files
from pathlib import Path
from typing import Any

from arena_core import InputFileError
from arena_core.files import LIMITS, local_path
from arena_tasks.scenario_files.json_fields import Field
from arena_tasks.scenario_files.yaml_fields import read_yaml

BUILT_IN = files("arena_tasks") / "curricula"
DEFAULT = "released"
MOST_SHOWN = 20  # numbers of levels in an error
NEEDED = ("difficulty", "obstacles", "pedestrians", "pedestrian_speed", "speed_share")
OPTIONAL = ("min_distance", "max_distance")


@dataclass(frozen=True, slots=True)
class Level:
    """What one level changes of random problems; ``key`` is its place in the file.

    ``difficulty`` is the world's, None for the world as it is; ``pedestrian_speed`` m/s; ``speed_share`` of the robot's
    speed limits; distances from start to goal in m, None for those of the random task.
    """

    key: str
    difficulty: float | None
    obstacles: int
    pedestrians: int
    pedestrian_speed: float
    speed_share: float
    min_distance: float | None
    max_distance: float | None


@dataclass(frozen=True, slots=True)
class Curriculum:
    """The levels of ``file``; the hash names what they say, not how it is written."""

    file: Path
    content_hash: str
    levels: tuple[Level, ...]


def built_in() -> list[str]:
    """Return the names of the curricula that come with the package."""
    return sorted(entry.name.removesuffix(".yaml") for entry in BUILT_IN.iterdir() if entry.name.endswith(".yaml"))


def read_curriculum(path: str | None) -> Curriculum:
    """Read a curriculum file, or the built-in one of this name; raise InputFileError with file and key."""
    name = path or DEFAULT
    file = Path(str(BUILT_IN / f"{name}.yaml")) if name in built_in() else local_path(name)
    return curriculum_of(read_yaml(file, f"a curriculum file, or one of {', '.join(built_in())}"))


def curriculum_of(root: Field) -> Curriculum:
    """Return the curriculum that a file's content is; raise InputFileError with file and key."""
    root.check_keys("levels")
    levels = _read_levels(root["levels"])
    return Curriculum(root.file, blake2b(repr(levels).encode(), digest_size=6).hexdigest(), levels)


def curriculum_text(levels: Sequence[Mapping[str, Any]]) -> str:
    """Return the text of a curriculum file, a line for each level."""
    lines = [f"  {number}: {json.dumps(dict(level)).replace(chr(34), '')}" for number, level in enumerate(levels)]
    return "\n".join(["levels:", *lines]) + "\n"


def _read_levels(field: Field) -> tuple[Level, ...]:
    if not field.value:
        raise field.rejection("at least one level")
    numbers = [name for name, _ in field.entries()]
    if set(numbers) != set(range(len(numbers))):
        shown = ", ".join(json.dumps(number, default=str) for number in numbers[:MOST_SHOWN])
        raise InputFileError(f"{field.file}: levels are numbered {shown}; allowed: 0, 1, 2 and so on without a gap")
    return tuple(read_level(field[number]) for number in range(len(numbers)))


def read_level(field: Field) -> Level:
    """Return one level; raise InputFileError with file and key."""
    field.check_keys(*NEEDED, *OPTIONAL)
    level = Level(
        key=field.key,
        difficulty=None if field["difficulty"].value is None else field["difficulty"].number(low=0.0, high=1.0),
        obstacles=field["obstacles"].read_integer(0, LIMITS.people),
        pedestrians=field["pedestrians"].read_integer(0, LIMITS.people),
        pedestrian_speed=field["pedestrian_speed"].number(above=0.0),
        speed_share=field["speed_share"].number(above=0.0, high=1.0),
        min_distance=_read_distance(field, "min_distance"),
        max_distance=_read_distance(field, "max_distance"),
    )
    if level.min_distance is not None and level.max_distance is not None and level.min_distance > level.max_distance:
        raise field["min_distance"].rejection(f"up to max_distance, {level.max_distance:g} m")
    return level


def _read_distance(field: Field, name: str) -> float | None:
    return field[name].number(above=0.0) if field.has(name) and field[name].value is not None else None
