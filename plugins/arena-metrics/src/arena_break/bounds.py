"""Within what hard problems are searched, as ``bounds.yaml`` or a file of the user's says."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from importlib.resources import files
from typing import Annotated, Any

from arena_core import ConfigurationError, InputFileError
from arena_core.files import read_yaml
from arena_core.parameters import Bounds, NonNegative, NonNegativeInt, Positive, PositiveInt, read_settings

ALLOWED = "bounds as in docs/break.md"
Speed = Annotated[float, Bounds(low=0.05, high=1.6)]  # m/s; who is faster runs
Away = Annotated[float, Bounds(low=3.0, high=1000.0)]  # m


@dataclass(frozen=True, slots=True)
class RobotBounds:
    """How far start and goal are apart, m; what is free about them and on the way, m; and how much time there is:
    ``time_share`` of what the way takes at a share ``pace`` of the greatest speed, and ``time_spare`` s.
    """

    min_distance: Positive
    max_distance: Positive
    clearance: NonNegative
    passage: NonNegative
    pace: Annotated[float, Bounds(low=0.05, high=1.0)]
    time_share: Positive
    time_spare: NonNegative


@dataclass(frozen=True, slots=True)
class PeopleBounds:
    """How many people there are at most, how fast they walk, m/s, how far from the robot, from its start and goal, from
    walls and from each other they begin, m, how far they walk before and behind the robot's way, m, and how much sooner
    or later than the robot they come there, but not sooner than ``soonest``, s.
    """

    most: Annotated[int, Bounds(low=1, high=100)]
    slowest: Speed
    fastest: Speed
    radius: Positive
    spawn_distance: Away
    keep_off: NonNegative
    clearance: Positive
    apart: NonNegative
    reach_min: Positive
    reach_max: Positive
    soonest: NonNegative
    moment: NonNegative


@dataclass(frozen=True, slots=True)
class MarginBounds:
    """What the clairvoyant keeps from people and from walls, m."""

    people: NonNegative
    walls: NonNegative


@dataclass(frozen=True, slots=True)
class SearchBounds:
    """All of them; ``keys`` are the seeds of noise, ``batch`` problems are asked for together, people within ``near`` m
    are near the robot.
    """

    robot: RobotBounds
    people: PeopleBounds
    margin: MarginBounds
    keys: list[NonNegativeInt]
    batch: PositiveInt
    map_seed: NonNegativeInt
    near: Positive

    @property
    def genes(self) -> int:
        """Return how many numbers 0 .. 1 describe a problem."""
        return OWN_GENES + PERSON_GENES * self.people.most

    def facts(self) -> dict[str, Any]:
        """Return what a card says of them."""
        return asdict(self)


OWN_GENES, PERSON_GENES = 5, 6


def read_bounds(path: str | None) -> SearchBounds:
    """Read bounds, those that ship where there is no path; raise InputFileError with file and key."""
    source = str(files("arena_break") / "bounds.yaml") if path is None else path
    content = read_yaml(source, ALLOWED)
    shipped = read_yaml(str(files("arena_break") / "bounds.yaml"), ALLOWED)
    try:
        found: SearchBounds = read_settings(_filled(content, shipped), SearchBounds, "")
    except ConfigurationError as error:
        raise InputFileError(f"{source}: {str(error).strip()}") from None
    if fault := _fault_of(found):
        raise InputFileError(f"{source}: {fault}")
    return found


def _filled(content: Any, shipped: Any) -> Any:
    """Return bounds with what they leave open as it ships."""
    if not isinstance(content, Mapping) or not isinstance(shipped, Mapping):
        return content
    return {**shipped, **{key: _filled(value, shipped.get(key)) for key, value in content.items()}}


def _fault_of(bounds: SearchBounds) -> str:
    pairs = (
        ("robot.min_distance", bounds.robot.min_distance, "robot.max_distance", bounds.robot.max_distance),
        ("people.slowest", bounds.people.slowest, "people.fastest", bounds.people.fastest),
        ("people.reach_min", bounds.people.reach_min, "people.reach_max", bounds.people.reach_max),
    )
    for low_key, low, high_key, high in pairs:
        if low > high:
            return f"{low_key} is {low:g}; allowed: up to {high_key}, {high:g}"
    if len(set(bounds.keys)) < len(bounds.keys) or not bounds.keys:
        return f"keys is {bounds.keys}; allowed: one seed or more, each once"
    return ""
