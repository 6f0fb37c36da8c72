"""What a map is like: the widths of its ways, which generated worlds can be asked to have."""

from __future__ import annotations

from dataclasses import dataclass

from arena_core.parameters import Fraction, Positive
from arena_worlds.widths import Widths


@dataclass(frozen=True, slots=True)
class MapSimilarity:
    """The measures of a map, and by which share of each another map may differ from it."""

    free: Positive
    width_p10: Positive
    width: Positive
    width_p90: Positive
    beside_walls: Fraction
    within: Fraction

    def differences(self, found: Widths) -> str:
        """Return which measures differ by more than ``within``, with their values; empty where none does."""
        wanted = {
            "free": (self.free, found.free),
            "width_p10": (self.width_p10, found.low),
            "width": (self.width, found.middle),
            "width_p90": (self.width_p90, found.high),
            "beside_walls": (self.beside_walls, found.tight),
        }
        return ", ".join(
            f"{name} {value:.3g}"
            for name, (like, value) in wanted.items()
            if not abs(value - like) <= self.within * like
        )
