"""A world as upright solids on a ground: what a grid becomes in a simulator's world file, and
what grid such a file becomes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from arena_core import FREE, OCCUPIED, ConfigurationError, OccupancyGrid, Pose
from arena_core.files import LIMITS
from arena_core.scenes import Scene, raise_footprints, wall_boxes

# rad of roll or pitch, as solvers leave them; the top of a wall 2 m high is 2 cm off then, less than half a cell
UPRIGHT = 0.01
Cells = tuple[float, float]
EDGE = 1e-6  # cells; a box's side that lies this close to a cell's centre counts as beyond it


@dataclass(frozen=True, slots=True, eq=False)
class Solids:
    """Upright boxes and cylinders in the frame ``origin``, whose pose is in ``map``.

    ``boxes`` (N, 5) are x, y (m), yaw (rad), length and width (m); ``cylinders`` (M, 3) are x, y and radius, m.
    ``size`` (m, m) is the ground, from ``origin`` to its upper right corner; None where it is not bounded.
    """

    origin: Pose
    size: tuple[float, float] | None
    boxes: NDArray[np.float64]
    cylinders: NDArray[np.float64]

    def raised(self, height: float) -> Scene:
        """Return the solids as they stand, all ``height`` m high."""
        return Scene(
            self.origin, self.size, raise_footprints(self.boxes, height), raise_footprints(self.cylinders, height)
        )


@dataclass(frozen=True, slots=True)
class Shape:
    """A shape at ``pose`` in ``map``: box (length, width), cylinder (radius,) or the ground that
    bounds the map (length, width), m.
    """

    kind: Literal["box", "cylinder", "ground"]
    pose: Pose
    measures: tuple[float, ...]


def solids_from(shapes: Sequence[Shape]) -> Solids:
    """Return the solids of a world file; the last ground gives the frame and the extent."""
    origin, size = Pose(0.0, 0.0), None
    for shape in shapes:
        if shape.kind == "ground":
            length, width = shape.measures
            origin, size = shape.pose.compose(Pose(-0.5 * length, -0.5 * width)), (length, width)
    rows: dict[str, list[tuple[float, ...]]] = {"box": [], "cylinder": [], "ground": []}
    for shape in shapes:
        place = shape.pose if size is None else origin.relative(shape.pose)
        turn = (place.theta,) if shape.kind == "box" else ()
        rows[shape.kind].append((place.x, place.y, *turn, *shape.measures))
    return Solids(origin, size, np.array(rows["box"]).reshape(-1, 5), np.array(rows["cylinder"]).reshape(-1, 3))


def solids_of(grid: OccupancyGrid) -> Solids:
    """Return the boxes that fill a grid's occupied cells, each cell once."""
    rows, columns = grid.data.shape
    return Solids(grid.origin, (columns * grid.resolution, rows * grid.resolution), wall_boxes(grid), np.empty((0, 3)))


def grid_of(solids: Solids, resolution: float, margin: float) -> OccupancyGrid:
    """Return the grid whose occupied cells have their centre in a solid.

    A bounded ground is the grid's extent; else cells lie at whole multiples of ``resolution``, with ``margin`` m of
    open ground around the solids. Raises ConfigurationError for cells larger than the thinnest solid, and for more
    cells than fit a memory.
    """
    _check_resolution(solids, resolution)
    low, high = _grid_extent(solids, resolution, margin)
    columns, rows = (high - low).tolist()
    if not 0 < rows * columns <= LIMITS.cells:
        raise ConfigurationError(
            f"resolution is {resolution:g} and margin {margin:g}; allowed: one cell to {LIMITS.cells} cells, "
            f"here {rows} x {columns}"
        )
    _check_work(solids, resolution, columns, rows)
    data = np.full((rows, columns), FREE, np.int8)
    for x, y, yaw, length, width in solids.boxes.tolist():
        middle, extent = (x / resolution - low[0], y / resolution - low[1]), (length / resolution, width / resolution)
        _draw_box(data, middle, extent, yaw)
    for x, y, radius in solids.cylinders.tolist():
        _draw_disc(data, x / resolution - low[0], y / resolution - low[1], radius / resolution)
    corner = Pose(float(low[0] * resolution), float(low[1] * resolution))
    return OccupancyGrid(data, resolution, solids.origin.compose(corner) if low.any() else solids.origin)


def _check_work(solids: Solids, resolution: float, columns: int, rows: int) -> None:
    """Raise ConfigurationError where solids lie upon each other so often that drawing them would take minutes."""
    across = (
        np.concatenate((np.hypot(solids.boxes[:, 3], solids.boxes[:, 4]), 2.0 * solids.cylinders[:, 2])) / resolution
        + 2.0
    )
    drawn = float((np.minimum(across, columns) * np.minimum(across, rows)).sum())
    if drawn > LIMITS.drawn_cells:
        raise ConfigurationError(
            f"resolution is {resolution:g}; allowed: one at which all solids cover up to {LIMITS.drawn_cells} "
            f"cells, here {drawn:.2g}"
        )


def _check_resolution(solids: Solids, resolution: float) -> None:
    thinnest = float(min(solids.boxes[:, 3:].min(initial=np.inf), solids.cylinders[:, 2].min(initial=np.inf)))
    if resolution > thinnest * (1.0 + EDGE):
        raise ConfigurationError(
            f"resolution is {resolution:g}; allowed: up to the smallest radius or side of a solid, {thinnest:g} m"
        )


def _grid_extent(solids: Solids, resolution: float, margin: float) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return the lower left and upper right corner of the grid in whole cells of the frame ``origin``, x before y."""
    if solids.size is not None:
        return np.zeros(2, np.int64), np.ceil(np.array(solids.size) / resolution - EDGE).astype(np.int64)
    cos, sin = np.abs(np.cos(solids.boxes[:, 2])), np.abs(np.sin(solids.boxes[:, 2]))
    length, width = 0.5 * solids.boxes[:, 3], 0.5 * solids.boxes[:, 4]
    reach = np.vstack(
        (np.stack((cos * length + sin * width, sin * length + cos * width), axis=1), solids.cylinders[:, [2, 2]])
    )
    centres = np.vstack((solids.boxes[:, :2], solids.cylinders[:, :2]))
    low = np.floor(((centres - reach).min(axis=0) - margin) / resolution)
    high = np.ceil(((centres + reach).max(axis=0) + margin) / resolution)
    return low.astype(np.int64), high.astype(np.int64)


def _draw_box(data: NDArray[np.int8], middle: Cells, extent: Cells, yaw: float) -> None:
    """Occupy the cells whose centre is in the box around ``middle`` (column, row) of ``extent`` (length, width)."""
    cos, sin = np.cos(yaw), np.sin(yaw)
    half_length, half_width = 0.5 * extent[0] + EDGE, 0.5 * extent[1] + EDGE
    across, up = abs(cos) * half_length + abs(sin) * half_width, abs(sin) * half_length + abs(cos) * half_width
    window, rows, columns = _cells_around(data, *middle, across, up)
    inside = (np.abs(cos * columns + sin * rows) <= half_length) & (np.abs(cos * rows - sin * columns) <= half_width)
    window[inside] = OCCUPIED


def _draw_disc(data: NDArray[np.int8], column: float, row: float, radius: float) -> None:
    """Occupy the cells whose centre is within ``radius`` of (column, row), all in cells."""
    window, rows, columns = _cells_around(data, column, row, radius, radius)
    window[np.hypot(rows, columns) <= radius] = OCCUPIED


def _cells_around(
    data: NDArray[np.int8], column: float, row: float, across: float, up: float
) -> tuple[NDArray[np.int8], NDArray[np.float64], NDArray[np.float64]]:
    """Return a view of the cells about a place and how far their centres are above and to the right of it, in cells."""
    first_row, first_column = max(int(row - up), 0), max(int(column - across), 0)
    window = data[first_row : max(int(row + up) + 2, 0), first_column : max(int(column + across) + 2, 0)]
    rows, columns = np.ogrid[: window.shape[0], : window.shape[1]]
    return window, rows + (0.5 + first_row - row), columns + (0.5 + first_column - column)
