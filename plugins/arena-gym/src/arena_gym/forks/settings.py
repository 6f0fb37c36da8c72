"""What a training with forks is told."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any

from arena_core import ConfigurationError
from arena_core.parameters import Bounds, NonNegative, Positive, PositiveInt

Blocks = Annotated[int, Bounds(low=2, high=10_000)]
Folds = Annotated[int, Bounds(low=2, high=32)]


@dataclass(frozen=True, slots=True)
class DriveSettings:
    """Which drives are forked: ``blocks`` of ``episodes`` drives each, of at most ``time_limit`` s.

    A member that is drawn drives for ``held`` s, then another is drawn; every ``apart`` s a state is forked. Worlds
    are drawn by weights, ``densities`` (people per 100 m2) and ``speeds`` (of people, m/s) from their lists, one for
    each block. ``words`` of `arena run` are those of all drives, ``navigator`` what a planner's configuration says of
    its navigator.
    """

    blocks: Blocks
    episodes: PositiveInt
    time_limit: Positive
    held: Positive
    apart: Positive
    worlds: dict[str, NonNegative]
    densities: list[float]
    speeds: list[float]
    words: list[str]
    navigator: dict[str, Any]

    def __post_init__(self) -> None:
        if not sum(self.worlds.values()):
            raise ConfigurationError(
                f"trainer.drives.worlds is {self.worlds}; allowed: names with weights, one above 0"
            )
        for name, unit in (("densities", "people per 100 m2"), ("speeds", "m/s")):
            values = getattr(self, name)
            if not values or min(values) < 0.0:
                raise ConfigurationError(f"trainer.drives.{name} is {values}; allowed: one or more, {unit}")


@dataclass(frozen=True, slots=True)
class CostSettings:
    """What a member costs in ``horizon`` s from a state: time, s, and what ``collision`` (s each) and ``discomfort`` (s
    for each m s nearer to people than ``near`` m) are worth of it.
    """

    horizon: Positive
    collision: NonNegative
    discomfort: NonNegative
    near: NonNegative


@dataclass(frozen=True, slots=True)
class FitSettings:
    """How networks are fitted to the costs: one for each of ``folds`` parts of the blocks, which it does not see, by
    ``epochs`` with a Huber loss that is square up to ``delta`` s. Their mean is exported.
    """

    folds: Folds
    epochs: PositiveInt
    batch: PositiveInt
    rate: Positive
    decay: NonNegative
    delta: Positive
