"""Types for constructor parameters: the registry checks each configured value against them before anything runs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from arena_core.base.limits import LIMITS

MANY = 1000  # from here on a limit is there to keep slips out, and the least value is what a reader looks for


@dataclass(frozen=True, slots=True)
class Bounds:
    """The values that a number may take; ``above`` is exclusive, ``low`` and ``high`` are inclusive."""

    low: float = float("-inf")
    high: float = float("inf")
    above: float = float("-inf")

    def allows(self, value: float) -> bool:
        """Return whether ``value`` is possible (NaN is not)."""
        return self.low <= value <= self.high and value > self.above

    def __str__(self) -> str:
        if self.above > float("-inf"):
            return f"> {self.above:g}" + ("" if self.high == float("inf") else f" and <= {self.high:g}")
        if self.high == float("inf"):
            return f">= {self.low:g}"
        if self.low == float("-inf"):
            return f"<= {self.high:g}"
        return f"{self.low:g} .. {self.high:g}" if self.high < MANY else f">= {self.low:g} and <= {self.high:g}"


@dataclass(frozen=True, slots=True)
class Flat:
    """Marks a record whose fields are keys of their own: ``sampling: Annotated[Sampling, Flat()]`` groups the code, and
    the YAML has ``batch_size`` beside all others.
    """


Positive = Annotated[float, Bounds(above=0.0)]
NonNegative = Annotated[float, Bounds(low=0.0)]
Fraction = Annotated[float, Bounds(low=0.0, high=1.0)]
PositiveInt = Annotated[int, Bounds(low=1)]
NonNegativeInt = Annotated[int, Bounds(low=0)]
Speed = Annotated[float, Bounds(above=0.0, high=100.0)]  # m/s or rad/s
Acceleration = Annotated[float, Bounds(low=0.001, high=1000.0)]  # m/s^2 or rad/s^2
Step = Annotated[float, Bounds(low=0.0001, high=10.0)]  # s or m, of what is gone through step by step
Horizon = Annotated[float, Bounds(above=0.0, high=100.0)]  # s or m that are gone through so
Samples = Annotated[int, Bounds(low=1, high=LIMITS.samples)]  # of what is tried at every control step
Count = Annotated[int, Bounds(low=0, high=LIMITS.people)]  # of what stands or walks in a world
Episodes = Annotated[int, Bounds(low=1, high=LIMITS.episodes)]
Workers = Annotated[int, Bounds(low=1, high=LIMITS.workers)]
Beams = Annotated[int, Bounds(low=1, high=LIMITS.beams)]
