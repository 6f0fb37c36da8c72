"""A generator of open ground: a border, and square obstacles at random places.

The outdoor worlds of Heiden et al., Bench-MR: A Motion Planning Benchmark for Wheeled Mobile Robots, RA-L 2021.
"""

# annotations are not postponed, as in generated.py
from dataclasses import dataclass

import numpy as np

from arena_core import ConfigurationError, Positive
from arena_worlds.canvas import Canvas
from arena_worlds.generated import Count, Generated, Span


@dataclass(frozen=True, slots=True)
class OutdoorByDifficulty:
    """What difficulty decides: ``obstacles`` per 100 m2, ``obstacle_size`` m."""

    obstacles: Span
    obstacle_size: Span


@dataclass(frozen=True)
class Outdoor(Generated):
    """``obstacles`` squares of ``obstacle_size`` m at random places; they may overlap."""

    obstacles: Count | None
    obstacle_size: Positive | None
    by_difficulty: OutdoorByDifficulty

    kind = "outdoor"

    def check(self) -> None:
        """Raise ConfigurationError for squares too large for the hall."""
        if self._size() > min(self.width, self.height) / 2:
            raise ConfigurationError(
                f"world.obstacle_size is {self._size():g}; allowed: up to half the smaller side, {min(self.width, self.height) / 2:g} m"
            )

    def draw(self, random: np.random.Generator) -> Canvas:
        """Drop the squares on the ground."""
        canvas = Canvas(self.width, self.height, self.resolution)
        count = self.per_area(self.by_difficulty.obstacles) if self.obstacles is None else self.obstacles
        half = 0.5 * self._size()
        for x, y in random.uniform((0.0, 0.0), (self.width, self.height), (count, 2)).tolist():
            canvas.fill(x - half, y - half, x + half, y + half)
        return canvas

    def _size(self) -> float:
        return self.obstacle_size or self.by_difficulty.obstacle_size.at(self.difficulty)
