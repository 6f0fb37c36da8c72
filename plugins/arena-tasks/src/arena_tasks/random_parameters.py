"""The parameters of random problems as their YAML groups them; every key has its unit and source there."""

from __future__ import annotations

from dataclasses import dataclass

from arena_core import ConfigurationError
from arena_core.parameters import Count, Fraction, NonNegative, Positive, Samples

FARTHEST = 2.5  # standard deviations from the mean that anybody's speed is, at most


@dataclass(frozen=True, slots=True)
class PeopleParameters:
    """Who walks, how fast, and how: ``children`` and ``elders`` are shares of the people, ``speed_spread`` one of the
    mean speed.

    At a waypoint people stay, with ``pause_probability``, for ``pause_time`` s on average. With ``respawn`` who ends
    the round comes again elsewhere.
    """

    speed: Positive
    speed_spread: Fraction
    radius: Positive
    children: Fraction
    elders: Fraction
    pause_probability: Fraction
    pause_time: NonNegative
    respawn: bool

    def __post_init__(self) -> None:
        if self.children + self.elders > 1.0:
            allowed = f"up to {1.0 - self.children:g}, what the children leave"
            raise ConfigurationError(f"task.people.elders is {self.elders:g}; allowed: {allowed}")
        if self.speed_spread >= 1.0 / FARTHEST:
            allowed = f"below {1.0 / FARTHEST:g}, or a person would not walk at all"
            raise ConfigurationError(f"task.people.speed_spread is {self.speed_spread:g}; allowed: {allowed}")


@dataclass(frozen=True, slots=True)
class GroupParameters:
    """A ``share`` of the people walks in groups of ``size_min`` .. ``size_max``."""

    share: Fraction
    size_min: Samples
    size_max: Samples

    def __post_init__(self) -> None:
        _check_order("groups.size", self.size_min, self.size_max, 2)


@dataclass(frozen=True, slots=True)
class RoundParameters:
    """What a round is like: waypoints ``leg_min`` .. ``leg_max`` m apart (straight); a share ``to_and_fro`` of them
    turns back at the end.

    Of the people placed along the robot's likely way, a share ``meeting`` comes to it: of these a share ``crossing``
    goes from one side of it to the other, the others go along it.
    """

    waypoints_min: Samples
    waypoints_max: Samples
    leg_min: Positive
    leg_max: Positive
    to_and_fro: Fraction
    meeting: Fraction
    crossing: Fraction

    def __post_init__(self) -> None:
        _check_order("rounds.waypoints", self.waypoints_min, self.waypoints_max, 2)
        _check_order("rounds.leg", self.leg_min, self.leg_max)


@dataclass(frozen=True, slots=True)
class ObstacleParameters:
    """How many obstacles stand on no map, and what they are like; along the robot's likely way up to ``reach`` m from
    it.

    Radii are those of the discs, and of the circles round the polygons, whose share is ``polygons``.
    """

    count: Count
    radius_min: Positive
    radius_max: Positive
    polygons: Fraction
    reach: Positive

    def __post_init__(self) -> None:
        _check_order("obstacles.radius", self.radius_min, self.radius_max)


@dataclass(frozen=True, slots=True)
class TripParameters:
    """Where start and goal lie, m apart (straight); ``shrink_to_world`` takes half the diagonal of too small a world
    instead.

    ``clearance`` and ``keep_off`` count in robot radii, ``margin`` m is kept beyond all bodies.
    """

    min_distance: Positive
    max_distance: Positive
    shrink_to_world: bool
    clearance: NonNegative
    keep_off: NonNegative
    margin: NonNegative

    def __post_init__(self) -> None:
        if self.min_distance > self.max_distance:
            allowed = f"up to max_distance, {self.max_distance:g} m"
            raise ConfigurationError(f"task.trip.min_distance is {self.min_distance:g}; allowed: {allowed}")


def _check_order(name: str, least: float, greatest: float, lowest: int | None = None) -> None:
    """Raise ConfigurationError unless NAME_min is no more than NAME_max, and no less than ``lowest``."""
    if least <= greatest and (lowest is None or least >= lowest):
        return
    short = name.rpartition(".")[2]
    allowed = f"{short}_min <= {short}_max" if lowest is None else f"{lowest} <= {short}_min <= {short}_max"
    raise ConfigurationError(f"task.{name}_min is {least:g} and {short}_max {greatest:g}; allowed: {allowed}")
