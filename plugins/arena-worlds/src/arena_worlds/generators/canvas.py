"""A rectangular hall to draw walls in, in metres."""

from __future__ import annotations

import numpy as np

from arena_core import FREE, OCCUPIED, ConfigurationError, OccupancyGrid, Pose
from arena_core.files import LIMITS

WALL_CELLS = 2  # a wall of one cell could be cut by a ray along its diagonal


class Canvas:
    """A hall of ``width`` by ``height`` m with a wall around it; its lower left
    inner corner is the origin of ``map``.
    """

    def __init__(self, width: float, height: float, resolution: float, *, filled: bool = False) -> None:
        rows, columns = round(height / resolution), round(width / resolution)
        if not 0 < rows * columns <= LIMITS.cells:
            raise ConfigurationError(
                f"world.width is {width:g}, height {height:g} and resolution {resolution:g}; "
                f"allowed: a hall of at least one and at most {LIMITS.cells} cells"
            )
        self.resolution = resolution
        self.inside = np.full((rows, columns), OCCUPIED if filled else FREE, np.int8)

    def fill(self, x_min: float, y_min: float, x_max: float, y_max: float) -> None:
        """Make a rectangle occupied; what lies outside the hall is cut off."""
        self._paint_rectangle(x_min, y_min, x_max, y_max, OCCUPIED)

    def clear(self, x_min: float, y_min: float, x_max: float, y_max: float) -> None:
        """Make a rectangle free; what lies outside the hall is cut off."""
        self._paint_rectangle(x_min, y_min, x_max, y_max, FREE)

    def _paint_rectangle(self, x_min: float, y_min: float, x_max: float, y_max: float, value: int) -> None:
        first_column, first_row, last_column, last_row = (
            max(round(v / self.resolution), 0) for v in (x_min, y_min, x_max, y_max)
        )
        self.inside[first_row:last_row, first_column:last_column] = value

    def grid(self) -> OccupancyGrid:
        """Return the hall with its wall."""
        data = np.pad(self.inside, WALL_CELLS, constant_values=OCCUPIED)
        corner = -WALL_CELLS * self.resolution
        return OccupancyGrid(data, self.resolution, Pose(corner, corner))
