"""What a training of the learned predictor is told."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from arena_core import ConfigurationError
from arena_core.parameters import Bounds, Fraction, NonNegative, Positive, PositiveInt

Weights = dict[str, NonNegative]
Hypotheses = Annotated[int, Bounds(low=1, high=32)]
Times = Annotated[int, Bounds(low=2, high=64)]  # two of them make a leg
Episodes = Annotated[int, Bounds(low=1, high=100)]
Blocks = Annotated[int, Bounds(low=2, high=10_000)]


@dataclass(frozen=True, slots=True)
class Between:
    """A range that a number is drawn from, evenly."""

    low: NonNegative
    high: NonNegative


@dataclass(frozen=True, slots=True)
class DriveSettings:
    """Which drives are watched: ``blocks`` configurations with ``episodes`` drives each, of which the first
    ``validation`` are not fitted to; what is drawn for each, with weights or between two ends.
    """

    blocks: Blocks
    episodes: Episodes
    validation: PositiveInt
    time_limit: Positive
    worlds: Weights
    robots: list[str]
    people: Weights
    crowds: Weights
    localizers: Weights
    pedestrians: Between
    difficulty: Between
    pace: Between
    social: Between
    relaxation: Between
    reach: Between


@dataclass(frozen=True, slots=True)
class FitSettings:
    """How the network is fitted: its size, its ``hypotheses`` at ``times`` steps of ``step`` s, and how it learns."""

    step: Positive
    times: Times
    every: Positive
    epochs: PositiveInt
    batch: PositiveInt
    rate: Positive
    decay: NonNegative
    width: PositiveInt
    neighbour_width: PositiveInt
    hypotheses: Hypotheses
    share: Fraction
    likelihood: NonNegative
    true_share: Fraction
    threads: PositiveInt


def check_drives(drives: DriveSettings) -> None:
    """Raise ConfigurationError for settings that no drive can be drawn from."""
    if drives.validation >= drives.blocks:
        raise ConfigurationError(
            f"trainer.drives.validation is {drives.validation}; allowed: fewer than blocks ({drives.blocks})"
        )
    if not drives.robots:
        raise ConfigurationError("trainer.drives.robots is []; allowed: one robot or more")
    for name in ("worlds", "people", "crowds", "localizers"):
        weights = getattr(drives, name)
        if not sum(weights.values()):
            raise ConfigurationError(f"trainer.drives.{name} is {weights}; allowed: names with weights, one above 0")
    for name in ("pedestrians", "difficulty", "pace", "social", "relaxation", "reach"):
        between = getattr(drives, name)
        if between.low > between.high:
            raise ConfigurationError(
                f"trainer.drives.{name} is {between.low:g} to {between.high:g}; allowed: low not above high"
            )
