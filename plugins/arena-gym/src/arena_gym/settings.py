"""The environment's own settings, as its YAML has them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from arena_core import ConfigurationError
from arena_core.parameters import NonNegative, NonNegativeInt, Positive, PositiveInt


@dataclass(frozen=True, slots=True)
class Span:
    """Numbers from ``low`` to ``high``."""

    low: NonNegative
    high: NonNegative

    def __post_init__(self) -> None:
        _check_order(self.low, self.high)


@dataclass(frozen=True, slots=True)
class CountSpan:
    """Whole numbers from ``low`` to ``high``."""

    low: NonNegativeInt
    high: NonNegativeInt

    def __post_init__(self) -> None:
        _check_order(self.low, self.high)


@dataclass(frozen=True, slots=True)
class CrowdKind:
    """A kind of people: the ``share`` of episodes that have it, a factor of their speeds, a reaction to the
    robot (None: the task's).
    """

    share: NonNegative
    speed: Span
    reaction: str | None

    def __post_init__(self) -> None:
        if self.speed.low <= 0.0:
            raise ConfigurationError(f"randomization.crowds: speed.low is {self.speed.low}; allowed: > 0")


@dataclass(frozen=True, slots=True)
class EnvironmentSettings:
    """The pool of problems; how many collisions end an episode, and for how long a robot may stand (s); None: any.

    An action is a velocity for ``every`` control steps; that of a switch lasts as long as the switch says.
    """

    seed: NonNegativeInt
    worlds: PositiveInt
    problems_per_world: PositiveInt
    collisions_to_end: PositiveInt | None
    standing_to_end: Positive | None
    every: PositiveInt


@dataclass(frozen=True, slots=True)
class Randomization:
    """What differs between episodes: range noise (m), latency (control steps), speeds of robot and people,
    which people and how many.
    """

    lidar_noise: Span
    latency: CountSpan
    speed_share: Span
    people: CountSpan | None
    people_speed: Span
    crowds: dict[str, CrowdKind]

    def __post_init__(self) -> None:
        if self.crowds and not sum(kind.share for kind in self.crowds.values()) > 0.0:
            raise ConfigurationError("randomization.crowds: the shares are all 0; allowed: one at least above 0")
        if not 0.0 < self.speed_share.low <= self.speed_share.high <= 1.0:
            raise ConfigurationError(
                f"randomization.speed_share is {self.speed_share.low} .. {self.speed_share.high}; allowed: > 0 .. 1"
            )
        if self.people_speed.low <= 0.0:
            raise ConfigurationError(f"randomization.people_speed.low is {self.people_speed.low}; allowed: > 0")


@dataclass(frozen=True, slots=True)
class SwitchSettings:
    """Planners that an action chooses among, with the local map and the tracker that they share.

    A policy decides at every ``every``-th control step; an action holds for ``held`` such decisions.
    """

    every: PositiveInt
    held: PositiveInt
    members: dict[str, dict[str, Any]]
    local_map: dict[str, Any]
    tracker: dict[str, Any]

    def __post_init__(self) -> None:
        if len(self.members) < 2:
            there = ", ".join(self.members) or "none"
            raise ConfigurationError(
                f"switch.members has {there}; allowed: two or more installed planners (arena-aio[default] brings "
                "rosnav and teb)"
            )


def _check_order(low: float, high: float) -> None:
    if low > high:
        raise ConfigurationError(f"randomization: low is {low}, above high, {high}; allowed: low <= high")
