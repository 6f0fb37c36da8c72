"""A layer of a Flatland world that is a list of walls in place of an image."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from arena_core import FREE, OCCUPIED, InputFileError, OccupancyGrid, Pose
from arena_core.commands import one_line
from arena_core.files import LIMITS, is_file, read_text
from arena_worlds.formats.map_yaml import number_at, origin_at, quote_value, read_mapping

TYPE = "line_segments"
KEYS = "type, data, scale, origin"
ALLOWED = "rows of x1 y1 x2 y2"
# m: side of the cells that walls are drawn on, for the files have none (own choice: that of the built-in worlds)
CELL = 0.05


@dataclass(frozen=True, slots=True)
class LineFile:
    """What the YAML of such a layer says: ``data`` has rows x1 y1 x2 y2, in units of ``scale``
    m, seen from ``origin`` (x, y, yaw).
    """

    data: Path
    scale: float
    origin: tuple[float, float, float]


def read_line_yaml(path: Path) -> LineFile | None:
    """Read the YAML of a layer;

    None where it is one of an image. Raises InputFileError with the file, the key and what is allowed.
    """
    keys = read_mapping(path, KEYS)
    if keys.get("type") != TYPE:
        return None
    name = keys.get("data")
    if not isinstance(name, str) or not name or not is_file(path.parent / name):
        raise InputFileError(
            f"{path}: data is {quote_value(name)}; allowed: a file with rows of x1 y1 x2 y2, relative to this YAML"
        )
    scale = number_at(path, keys, "scale")
    if scale <= 0.0:
        raise InputFileError(f"{path}: scale is {scale:g}; allowed: > 0 (m)")
    return LineFile(path.parent / name, scale, origin_at(path, keys))


def line_grid(file: LineFile) -> OccupancyGrid:
    """Return the grid with every cell occupied that a wall runs through, all others free, one
    cell wider than the walls.
    """
    walls = _read_walls(file.data) * file.scale
    low = np.floor(walls.min(axis=(0, 1)) / CELL) - 1
    extent = np.ceil(walls.max(axis=(0, 1)) / CELL) - low + 1
    if not extent.prod() <= LIMITS.cells:
        raise InputFileError(
            f"{file.data}: its walls span {extent[0]:.0f} x {extent[1]:.0f} cells of {CELL:g} m; allowed: "
            f"{LIMITS.cells} in all"
        )
    columns, rows = extent.astype(int)
    data = np.full((rows, columns), FREE, np.int8)
    for start, end in walls / CELL - low:
        count = int(np.ceil(2.0 * np.abs(end - start).max())) + 1  # two points a cell
        x, y = (start + np.linspace(0.0, 1.0, count)[:, None] * (end - start)).astype(int).T
        data[y, x] = OCCUPIED
        data[y[:-1], x[1:]] = OCCUPIED  # no two cells of a wall touch by a corner alone, where a ray could slip through
    return OccupancyGrid(data, CELL, Pose(*file.origin).compose(Pose(*(low * CELL).tolist())))


def _read_walls(path: Path) -> NDArray[np.float64]:
    """Return the walls (W, 2, 2), each from a place to another; raise InputFileError."""
    lines = [line for line in read_text(path, LIMITS.walls_bytes, ALLOWED).splitlines() if line.strip()]
    if len(lines) > LIMITS.walls:
        raise InputFileError(f"{path}: has {len(lines)} rows; allowed: {LIMITS.walls}")
    rows = [line.split() for line in lines]
    try:
        walls = (
            np.array(rows, np.float64).reshape(-1, 2, 2) if all(len(row) == 4 for row in rows) else np.empty((0, 2, 2))
        )
    except ValueError as error:
        raise InputFileError(f"{path}: cannot be read ({one_line(str(error))}); allowed: {ALLOWED}") from None
    if len(walls) == 0 or not (np.abs(walls) <= LIMITS.number_largest).all():
        raise InputFileError(
            f"{path}: has no walls, or rows of other than 4 finite numbers; allowed: rows of x1 y1 x2 y2"
        )
    return walls
