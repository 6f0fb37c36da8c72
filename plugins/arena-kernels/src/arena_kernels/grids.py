"""Occupancy grids packed into flat arrays, for kernels that work on many worlds at once."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from arena_kernels.compiled import borrowing, inlined
from arena_kernels.distance import Grid, grid_distance
from arena_kernels.scalars import Integer

TILE = 8  # cells; ``tile_index`` shifts by its binary logarithm
LINE = 64  # bytes of a cache line: those of a tile


class GridStack(NamedTuple):
    """G distinct grids, packed; cell (row, column) of grid g lies at ``offsets[g] + row * shapes[g, 1] + column``.

    ``cells`` uint8, 1 = occupied. ``distance`` float32, m, between cell centres (inf: no occupied cell). ``reach`` is
    the ray caster's table (``quadrant_reach``), grid g at ``reach_offsets[g]``. ``shapes`` (G, 2) rows, columns.
    ``origins`` (G, 3) is the pose in ``map`` of cell (0, 0)'s lower left corner, ``rotations`` (G, 2) the cosine and
    sine of its yaw.
    """

    cells: NDArray[np.uint8]
    distance: NDArray[np.float32]
    reach: NDArray[np.uint8]
    offsets: NDArray[np.int64]
    reach_offsets: NDArray[np.int64]
    shapes: NDArray[np.int64]
    resolutions: NDArray[np.float64]
    origins: NDArray[np.float64]
    rotations: NDArray[np.float64]


class PlacedGrid(Grid, Protocol):
    """A grid with a place in ``map``: ``origin`` has x, y and theta; ``derive``
    keeps what was computed from the grid.
    """

    @property
    def origin(self) -> Any:
        """Return the pose of cell (0, 0)'s lower left corner."""

    def derive(self, function: Callable[[Any], Any]) -> Any:
        """Return ``function(self)``, computed once."""


def stack_grids(grids: Sequence[PlacedGrid]) -> tuple[GridStack, NDArray[np.int64]]:
    """Pack the distinct grids among those of N worlds; return them and which one each world uses, (N,)."""
    distinct = list({id(grid): grid for grid in grids}.values())
    place = {id(grid): index for index, grid in enumerate(distinct)}
    return _pack_grids(distinct), np.array([place[id(grid)] for grid in grids], np.int64)


def _pack_grids(grids: Sequence[PlacedGrid]) -> GridStack:
    cells = [grid.derive(_flat_cells) for grid in grids]
    reaches = [grid.derive(quadrant_reach) for grid in grids]
    origins = np.array([(grid.origin.x, grid.origin.y, grid.origin.theta) for grid in grids], np.float64).reshape(-1, 3)
    return GridStack(
        _join_arrays(cells),
        _join_arrays([grid.derive(grid_distance).ravel() for grid in grids]),
        _join_tiles(reaches),
        _part_offsets(cells),
        _part_offsets(reaches),
        np.array([grid.occupied.shape for grid in grids], np.int64).reshape(-1, 2),
        np.array([grid.resolution for grid in grids], np.float64),
        origins,
        np.stack((np.cos(origins[:, 2]), np.sin(origins[:, 2])), axis=1),
    )


def _join_arrays(parts: Sequence[NDArray[Any]]) -> NDArray[Any]:
    """Concatenate flat arrays; a single one is shared, not copied."""
    return parts[0] if len(parts) == 1 else np.concatenate(parts)


def _join_tiles(parts: Sequence[NDArray[np.uint8]]) -> NDArray[np.uint8]:
    """Concatenate tables of tiles, each tile in a cache line of its own; a single one is shared, not copied."""
    if len(parts) == 1:
        return parts[0]
    return np.concatenate(parts, out=aligned_buffer(sum(len(part) for part in parts)))


def aligned_buffer(length: int) -> NDArray[np.uint8]:
    """Return room for so many bytes that begins with a cache line."""
    room = np.empty(length + LINE, np.uint8)
    start = -room.ctypes.data % LINE
    return room[start : start + length]


def _part_offsets(parts: Sequence[NDArray[Any]]) -> NDArray[np.int64]:
    return np.cumsum([0, *(len(part) for part in parts)], dtype=np.int64)[:-1]


def _flat_cells(grid: Grid) -> NDArray[np.uint8]:
    return np.array(grid.occupied, dtype=np.uint8).ravel()


def quadrant_reach(grid: Grid) -> NDArray[np.uint8]:
    """Return, flat, four tables of ``table_size``: the side in cells of the largest empty square whose lowest cell this
    is.

    Table q is of the grid mirrored in its columns if q & 1, in its rows if q & 2: a ray of any direction then runs to
    higher columns and rows. Occupied cells and the rim beyond the last column and row have 0; larger sides than 255 are
    cut. A table lies in tiles of 8 x 8 cells, a cache line each: rays of many worlds wait for memory, and cross fewer
    tiles than rows (``tile_index``).
    """
    blocked = np.array(grid.occupied, dtype=np.uint8)
    table = np.zeros((4, blocked.shape[0] + 1, blocked.shape[1] + 1), np.uint8)
    for quadrant in range(4):
        mirrored = blocked[:: -1 if quadrant & 2 else 1, :: -1 if quadrant & 1 else 1]
        _largest_squares(np.ascontiguousarray(mirrored), table[quadrant])
    return _join_tiles([_tile_table(part) for part in table])


def _tile_table(table: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Return a table (H, W), padded with zeros, tile by tile."""
    rows, columns = (-(-size // TILE) for size in table.shape)
    padded = np.zeros((rows * TILE, columns * TILE), np.uint8)
    padded[: table.shape[0], : table.shape[1]] = table
    return np.ascontiguousarray(padded.reshape(rows, TILE, columns * TILE).swapaxes(1, 2)).ravel()


@borrowing
def table_size(rows: Integer, columns: Integer) -> int:
    """Return the length of one reach table of a grid of so many rows and columns."""
    return (rows // TILE + 1) * (columns // TILE + 1) * TILE * TILE


@inlined
def tile_index(row: Integer, column: Integer, strip: Integer) -> Integer:
    """Return where a cell lies in a table whose strips of eight rows take so many bytes, column by column."""
    return (row >> 3) * strip + (column << 3) + (row & 7)


@borrowing
def _largest_squares(blocked: NDArray[np.uint8], reach: NDArray[np.uint8]) -> None:
    """Grow each square from those of the three neighbours that it would swallow."""
    rows, columns = blocked.shape
    for row in range(rows - 1, -1, -1):
        for column in range(columns - 1, -1, -1):
            if not blocked[row, column]:
                beside = min(reach[row, column + 1], reach[row + 1, column])
                reach[row, column] = min(min(beside, reach[row + 1, column + 1]), 254) + 1


@borrowing
def to_grid(stack: GridStack, g: Integer, x: float, y: float) -> tuple[float, float]:
    """Return a position of ``map`` in the frame of grid ``g``, in cells (column, row)."""
    dx, dy = x - stack.origins[g, 0], y - stack.origins[g, 1]
    c, s = stack.rotations[g, 0], stack.rotations[g, 1]
    return (c * dx + s * dy) / stack.resolutions[g], (c * dy - s * dx) / stack.resolutions[g]


@borrowing
def is_blocked(stack: GridStack, g: Integer, x: float, y: float) -> bool:
    """Return whether a position of ``map`` lies in an occupied cell of grid ``g``; outside the grid nothing is."""
    u, v = to_grid(stack, g, x, y)
    rows, columns = stack.shapes[g, 0], stack.shapes[g, 1]
    if not (0.0 <= u < columns and 0.0 <= v < rows):
        return False
    return bool(stack.cells[stack.offsets[g] + np.int64(v) * columns + np.int64(u)])


@borrowing
def distance_and_gradient(stack: GridStack, g: Integer, x: float, y: float) -> tuple[float, float, float]:
    """Return the distance to the nearest wall's surface, m, and its gradient in ``map``, interpolated between cell
    centres.

    Half a cell is taken off the distance between centres, so the error is at most about half a cell. Without any wall
    the distance is inf and the gradient zero; a position outside the grid gets the values of the nearest one inside.
    """
    u, v = to_grid(stack, g, x, y)
    rows, columns = stack.shapes[g, 0], stack.shapes[g, 1]
    u = min(max(u - 0.5, 0.0), columns - 1.0)
    v = min(max(v - 0.5, 0.0), rows - 1.0)
    column, row = min(np.int64(u), max(columns - 2, 0)), min(np.int64(v), max(rows - 2, 0))
    right, up = min(column + 1, columns - 1) - column, (min(row + 1, rows - 1) - row) * columns
    corner = stack.offsets[g] + row * columns + column
    d00, d01 = float(stack.distance[corner]), float(stack.distance[corner + right])
    d10, d11 = float(stack.distance[corner + up]), float(stack.distance[corner + up + right])
    if d00 == np.inf:
        return np.inf, 0.0, 0.0
    a, b = u - column, v - row
    low, high = d00 + a * (d01 - d00), d10 + a * (d11 - d10)
    along_u = ((1.0 - b) * (d01 - d00) + b * (d11 - d10)) / stack.resolutions[g]
    along_v = (high - low) / stack.resolutions[g]
    c, s = stack.rotations[g, 0], stack.rotations[g, 1]
    return low + b * (high - low) - 0.5 * stack.resolutions[g], c * along_u - s * along_v, s * along_u + c * along_v
