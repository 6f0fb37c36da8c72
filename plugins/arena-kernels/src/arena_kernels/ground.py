"""One world's distance field, cut out of the stack once a step, so that lookups in inner loops
carry one array instead of nine.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from arena_kernels.compiled import borrowing, compiled
from arena_kernels.grids import GridStack


class Ground(NamedTuple):
    """``field`` (H, W): distances between cell centres, m; ``x, y``, ``cosine, sine``: pose of
    its lower left corner; ``cell`` m.
    """

    field: NDArray[np.float32]
    x: float
    y: float
    cosine: float
    sine: float
    cell: float


LAYOUT = np.dtype(
    [("first", np.int64), ("rows", np.int64), ("columns", np.int64)]
    + [(name, np.float64) for name in ("x", "y", "cosine", "sine", "cell")],
    align=True,
)


def layouts_of(stack: GridStack) -> NDArray[np.void]:
    """Return where each grid's distances lie in ``stack.distance``, and the grid's place.

    Both go to a kernel as two arrays; to hand over the nine of a stack takes as long as to step ten people.
    """
    layouts = np.zeros(len(stack.offsets), LAYOUT)
    layouts["first"], layouts["cell"] = stack.offsets, stack.resolutions
    layouts["rows"], layouts["columns"] = stack.shapes.T
    layouts["x"], layouts["y"] = stack.origins[:, :2].T
    layouts["cosine"], layouts["sine"] = stack.rotations.T
    return layouts


class GroundStack(NamedTuple):
    """The grids of N worlds: ``grids`` (N,) says which of the ``layouts`` each has, ``distance``
    holds all of their cells.
    """

    grids: NDArray[np.int64]
    distance: NDArray[np.float32]
    layouts: NDArray[np.void]


@compiled
def world_ground(land: GroundStack, world: int) -> Ground:
    """Return the grid of one world."""
    return ground_of(land.distance, land.layouts[land.grids[world]])


@compiled
def ground_of(distance: NDArray[np.float32], layout: Any) -> Ground:
    """Return the grid with this layout."""
    field = distance[layout.first : layout.first + layout.rows * layout.columns].reshape((layout.rows, layout.columns))
    return Ground(field, layout.x, layout.y, layout.cosine, layout.sine, layout.cell)


@borrowing
def in_cells(ground: Ground, x: float, y: float) -> tuple[float, float]:
    """Return a position of ``map`` in cells (row, column) of the grid."""
    dx, dy = x - ground.x, y - ground.y
    return (ground.cosine * dy - ground.sine * dx) / ground.cell, (ground.cosine * dx + ground.sine * dy) / ground.cell


@borrowing
def in_map(ground: Ground, row: float, column: float) -> tuple[float, float]:
    """Return a position given in cells in ``map``."""
    u, v = column * ground.cell, row * ground.cell
    return ground.x + ground.cosine * u - ground.sine * v, ground.y + ground.sine * u + ground.cosine * v


@borrowing
def wall_clearance(ground: Ground, x: float, y: float) -> float:
    """Return the distance to the nearest wall's surface, m."""
    return clearance_and_gradient(ground, x, y)[0]


@borrowing
def clearance_and_gradient(ground: Ground, x: float, y: float) -> tuple[float, float, float]:
    """Return the distance to the nearest wall's surface, m, and its gradient in ``map``, interpolated between cell
    centres.

    The same as ``arena_kernels.grids.distance_and_gradient``.
    """
    rows, columns = ground.field.shape
    v, u = in_cells(ground, x, y)
    u, v = min(max(u - 0.5, 0.0), columns - 1.0), min(max(v - 0.5, 0.0), rows - 1.0)
    left, low = min(int(u), max(columns - 2, 0)), min(int(v), max(rows - 2, 0))
    right, high = min(left + 1, columns - 1), min(low + 1, rows - 1)
    d00, d01 = float(ground.field[low, left]), float(ground.field[low, right])
    d10, d11 = float(ground.field[high, left]), float(ground.field[high, right])
    if d00 == np.inf:  # no wall anywhere
        return np.inf, 0.0, 0.0
    a, b = u - left, v - low
    below, above = d00 + a * (d01 - d00), d10 + a * (d11 - d10)
    along_u, along_v = ((1.0 - b) * (d01 - d00) + b * (d11 - d10)) / ground.cell, (above - below) / ground.cell
    gx, gy = ground.cosine * along_u - ground.sine * along_v, ground.sine * along_u + ground.cosine * along_v
    return below + b * (above - below) - 0.5 * ground.cell, gx, gy
