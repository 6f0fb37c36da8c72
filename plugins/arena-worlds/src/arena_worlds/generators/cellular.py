"""A generator of irregular clutter: a cellular automaton that smooths random cells.

Perille, Truong, Xiao and Stone, Benchmarking Metric Ground Navigation, SSRR 2020: the worlds of the BARN challenge.
"""

# annotations are not postponed, as in generated.py
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from arena_core import FREE, OCCUPIED, ConfigurationError
from arena_core.parameters import Fraction, Positive
from arena_worlds.generators.canvas import Canvas
from arena_worlds.generators.generated import Count, Generated, Span

NEIGHBOURS = np.array(((1, 1, 1), (1, 0, 1), (1, 1, 1)), np.uint8)
FILL_ABOVE, CLEAR_BELOW = 4, 2  # of 8 neighbours (Perille et al.)


@dataclass(frozen=True, slots=True)
class CellularByDifficulty:
    """What difficulty decides: ``fill``, the share of cells filled at first."""

    fill: Span


@dataclass(frozen=True)
class Cellular(Generated):
    """Cells of ``cell`` m, a share ``fill`` of them filled at random, then ``smoothing`` steps of the automaton."""

    cell: Positive
    smoothing: Count
    fill: Fraction | None
    by_difficulty: CellularByDifficulty

    kind = "cellular"

    def check(self) -> None:
        """Raise ConfigurationError for cells that the grid cannot show."""
        if not self.resolution <= self.cell <= min(self.width, self.height):
            raise ConfigurationError(
                f"world.cell is {self.cell:g}; allowed: resolution to the smaller side, "
                f"{self.resolution:g} .. {min(self.width, self.height):g} m"
            )

    def draw(self, random: np.random.Generator) -> Canvas:
        """Fill cells at random, smooth them, and draw them in the hall."""
        canvas = Canvas(self.width, self.height, self.resolution)
        rows, columns = (self._cells_along(count) for count in canvas.inside.shape)
        fill = self.by_difficulty.fill.at(self.difficulty) if self.fill is None else self.fill
        filled = random.random((rows[-1] + 1, columns[-1] + 1)) < fill
        for _ in range(self.smoothing):
            filled = smooth_cells(filled)
        canvas.inside = np.where(filled[np.ix_(rows, columns)], np.int8(OCCUPIED), np.int8(FREE))
        return canvas

    def _cells_along(self, count: int) -> NDArray[np.int64]:
        """Return in which of the automaton's cells the grid's cells along one side lie."""
        return np.asarray((np.arange(count) + 0.5) * (self.resolution / self.cell), np.int64)


def smooth_cells(filled: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return the next state: more than 4 filled neighbours fill a cell, fewer than 2 clear it;
    beyond the border none is.
    """
    around = ndimage.convolve(filled.astype(np.uint8), NEIGHBOURS, mode="constant", cval=0)
    return np.asarray((around > FILL_ABOVE) | (filled & (around >= CLEAR_BELOW)))
