"""A generator of open ground: a border, and square obstacles at random places.

The outdoor worlds of Heiden et al., Bench-MR: A Motion Planning Benchmark for Wheeled Mobile Robots, RA-L 2021.
"""

# annotations are not postponed, as in generated.py
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from arena_core import ConfigurationError
from arena_core.parameters import NonNegative, Positive
from arena_worlds.generators.canvas import Canvas
from arena_worlds.generators.generated import Count, Generated, Span, UnsuitableWorld

TRIES = 500  # places drawn for a square, before the world is drawn again


@dataclass(frozen=True, slots=True)
class Gaps:
    """How far each square stands from the nearest of the others and the border, at least and at most, m."""

    least: NonNegative
    most: NonNegative


@dataclass(frozen=True, slots=True)
class OutdoorByDifficulty:
    """What difficulty decides: ``obstacles`` per 100 m2, ``obstacle_size`` m."""

    obstacles: Span
    obstacle_size: Span


@dataclass(frozen=True)
class Outdoor(Generated):
    """``obstacles`` squares of ``obstacle_size`` m at random places; they may overlap, unless
    they have to keep ``gaps``.
    """

    obstacles: Count | None
    obstacle_size: Positive | None
    gaps: Gaps | None
    by_difficulty: OutdoorByDifficulty

    kind = "outdoor"

    def check(self) -> None:
        """Raise ConfigurationError for squares too large for the hall."""
        if self._obstacle_size() > min(self.width, self.height) / 2:
            raise ConfigurationError(
                f"world.obstacle_size is {self._obstacle_size():g}; allowed: up to half the smaller side, "
                f"{min(self.width, self.height) / 2:g} m"
            )
        if self.gaps is not None and self.gaps.most < self.gaps.least:
            raise ConfigurationError(
                f"world.gaps.most is {self.gaps.most:g}; allowed: from world.gaps.least on, {self.gaps.least:g} m"
            )

    def draw(self, random: np.random.Generator) -> Canvas:
        """Drop the squares on the ground."""
        canvas = Canvas(self.width, self.height, self.resolution)
        count = self.per_area(self.by_difficulty.obstacles) if self.obstacles is None else self.obstacles
        half = 0.5 * self._obstacle_size()
        for x, y in self._draw_centres(random, count).tolist():
            canvas.fill(x - half, y - half, x + half, y + half)
        return canvas

    def _draw_centres(self, random: np.random.Generator, count: int) -> NDArray[np.float64]:
        """Return the centres of the squares (K, 2), m."""
        if self.gaps is None:
            return random.uniform((0.0, 0.0), (self.width, self.height), (count, 2))
        centres = np.empty((0, 2))
        while len(centres) < count:
            drawn = random.uniform((0.0, 0.0), (self.width, self.height), (TRIES, 2))
            gaps = self._square_gaps(drawn, centres)
            fitting = drawn[(gaps >= self.gaps.least) & (gaps <= self.gaps.most)]
            if not len(fitting):
                raise UnsuitableWorld(
                    f"world.obstacles is {count}: no place for square {len(centres) + 1} within world.gaps; "
                    "allowed: fewer, or wider gaps"
                )
            centres = np.vstack((centres, fitting[:1]))
        return centres

    def _square_gaps(self, drawn: NDArray[np.float64], centres: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return how far squares at ``drawn`` (D, 2) would be from the nearest of those at
        ``centres`` (K, 2) and the border, m.
        """
        size = self._obstacle_size()
        to_border = np.minimum(drawn, (self.width, self.height) - drawn).min(axis=1) - 0.5 * size
        between = np.maximum(np.abs(drawn[:, None] - centres) - size, 0.0)
        apart = np.hypot(between[..., 0], between[..., 1]).min(axis=1, initial=np.inf)
        return np.asarray(np.minimum(to_border, apart))

    def _obstacle_size(self) -> float:
        return self.obstacle_size or self.by_difficulty.obstacle_size.at(self.difficulty)
