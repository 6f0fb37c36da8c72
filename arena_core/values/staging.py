"""When a task that adapts moves to another level: a rule on its own, for benchmarks and for training alike."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from arena_core.base.errors import ConfigurationError
from arena_core.values.parameters import Fraction, NonNegativeInt, PositiveInt


@dataclass(frozen=True, slots=True)
class Staging:
    """Levels 0 .. ``levels`` - 1, driven in blocks of ``block`` episodes, the first block on level ``start``.

    The next level follows where the share of successes in a block is ``promote`` or more, the one before where it is
    ``fall_back`` or less; in between the level stays. Raises ConfigurationError for a rule that contradicts itself.
    """

    levels: PositiveInt
    start: NonNegativeInt
    block: PositiveInt
    promote: Fraction
    fall_back: Fraction

    def __post_init__(self) -> None:
        if self.promote <= self.fall_back:
            raise ConfigurationError(
                f"task.promote is {self.promote:g}; allowed: above task.fall_back, {self.fall_back:g}"
            )
        if self.start >= self.levels:
            raise ConfigurationError(
                f"task.start is {self.start}; allowed: 0 .. {self.levels - 1}, the levels of the curriculum"
            )

    def next(self, stage: int, succeeded: Sequence[bool]) -> int:
        """Return the level after a whole block on level ``stage`` in which these episodes ``succeeded``."""
        share = sum(succeeded) / len(succeeded)
        step = int(share >= self.promote) - int(share <= self.fall_back)
        return min(max(stage + step, 0), self.levels - 1)
