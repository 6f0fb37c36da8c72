"""A generator of corridors: nodes at random places, each joined to the nearest by an L-shaped corridor.

The indoor worlds of Heiden et al., Bench-MR: A Motion Planning Benchmark for Wheeled Mobile Robots, RA-L 2021.
"""

# annotations are not postponed, as in generated.py
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from arena_core import FREE, OCCUPIED, ConfigurationError
from arena_core.parameters import Positive
from arena_worlds.generators.canvas import WALL_CELLS, Canvas
from arena_worlds.generators.generated import Generated, SomeCount, Span


@dataclass(frozen=True, slots=True)
class IndoorByDifficulty:
    """What difficulty decides: ``corridor_width`` m, ``iterations`` per 100 m2."""

    corridor_width: Span
    iterations: Span


@dataclass(frozen=True)
class Indoor(Generated):
    """Corridors of ``corridor_width`` m grown in ``iterations`` steps from the middle of a solid hall."""

    corridor_width: Positive | None
    iterations: SomeCount | None
    by_difficulty: IndoorByDifficulty

    kind = "indoor"

    def check(self) -> None:
        """Raise ConfigurationError for corridors too narrow for the robot or too wide for the hall."""
        self.check_passage("corridor_width", self.corridor_width, self._corridor_width())
        if self._corridor_width() > min(self.width, self.height):
            raise ConfigurationError(
                f"world.corridor_width is {self._corridor_width():g}; allowed: up to the smaller side, "
                f"{min(self.width, self.height):g} m"
            )

    def draw(self, random: np.random.Generator) -> Canvas:
        """Grow the corridors, one node after the other."""
        canvas = Canvas(self.width, self.height, self.resolution, filled=True)
        half = 0.5 * self._corridor_width()
        nodes = np.empty((1 + (self.iterations or self.per_area(self.by_difficulty.iterations)), 2))
        nodes[0] = self.width / 2, self.height / 2
        low, high = (half, half, 0.0), (self.width - half, self.height - half, 1.0)
        for k, drawn in enumerate(random.uniform(low, high, (len(nodes) - 1, 3)), start=1):
            nodes[k] = drawn[:2]
            nearest = nodes[np.abs(nodes[:k] - nodes[k]).sum(axis=1).argmin()]
            _carve_corridor(canvas, nodes[k], nearest, half, along_x_first=bool(drawn[2] < 0.5))
        canvas.inside[~_thicken_walls(canvas.inside == OCCUPIED)] = FREE
        return canvas

    def _corridor_width(self) -> float:
        return self.corridor_width or self.by_difficulty.corridor_width.at(self.difficulty)


def _carve_corridor(canvas: Canvas, start: np.ndarray, end: np.ndarray, half: float, *, along_x_first: bool) -> None:
    bend = (end[0], start[1]) if along_x_first else (start[0], end[1])
    for leg in (start, end):
        (x_min, x_max), (y_min, y_max) = sorted((leg[0], bend[0])), sorted((leg[1], bend[1]))
        canvas.clear(x_min - half, y_min - half, x_max + half, y_max + half)


def _thicken_walls(solid: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return what is solid without walls thinner than those of the hall, which a ray could cut."""
    padded = np.pad(solid, WALL_CELLS, constant_values=True)
    opened = ndimage.binary_opening(padded, np.ones((WALL_CELLS, WALL_CELLS), bool))
    return np.asarray(opened[WALL_CELLS:-WALL_CELLS, WALL_CELLS:-WALL_CELLS])
