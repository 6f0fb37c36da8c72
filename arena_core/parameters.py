"""Types for constructor parameters: the registry checks each configured value against them before anything runs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated


@dataclass(frozen=True, slots=True)
class Bounds:
    """The values that a number may take; ``above`` is exclusive, ``low`` and ``high`` are inclusive."""

    low: float = float("-inf")
    high: float = float("inf")
    above: float = float("-inf")

    def allows(self, value: float) -> bool:
        """Tell whether ``value`` is possible (NaN is not)."""
        return self.low <= value <= self.high and value > self.above

    def __str__(self) -> str:
        if self.above > float("-inf"):
            return f"> {self.above:g}" + ("" if self.high == float("inf") else f" and <= {self.high:g}")
        if self.high == float("inf"):
            return f">= {self.low:g}"
        if self.low == float("-inf"):
            return f"<= {self.high:g}"
        return f"{self.low:g} .. {self.high:g}"


Positive = Annotated[float, Bounds(above=0.0)]
NonNegative = Annotated[float, Bounds(low=0.0)]
Fraction = Annotated[float, Bounds(low=0.0, high=1.0)]
PositiveInt = Annotated[int, Bounds(low=1)]
NonNegativeInt = Annotated[int, Bounds(low=0)]
