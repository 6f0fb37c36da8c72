"""A layer of a Flatland world that is a list of walls in place of an image."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from arena_core import FREE, OCCUPIED, InputFileError, OccupancyGrid, Pose
from arena_worlds.canvas import LARGEST
from arena_worlds.map_yaml import number_at, origin_at, quoted, read_mapping

TYPE = "line_segments"
KEYS = "type, data, scale, origin"
CELL = 0.05  # m: side of the cells that walls are drawn on, for the files have none (own choice: that of the built-in worlds)
LARGEST_FILE = 20_000_000  # bytes


@dataclass(frozen=True, slots=True)
class LineFile:
    """What the YAML of such a layer says: ``data`` has rows x1 y1 x2 y2, in units of ``scale`` m, seen from ``origin`` (x, y, yaw)."""

    data: Path
    scale: float
    origin: tuple[float, float, float]


def read_line_yaml(path: Path) -> LineFile | None:
    """Read the YAML of a layer; None where it is one of an image. Raises InputFileError with the file, the key and what is allowed."""
    keys = read_mapping(path, KEYS)
    if keys.get("type") != TYPE:
        return None
    name = keys.get("data")
    if not isinstance(name, str) or not name or not (path.parent / name).is_file():
        raise InputFileError(f"{path}: data is {quoted(name)}; allowed: a file with rows of x1 y1 x2 y2, relative to this YAML")
    scale = number_at(path, keys, "scale")
    if scale <= 0.0:
        raise InputFileError(f"{path}: scale is {scale:g}; allowed: > 0 (m)")
    return LineFile(path.parent / name, scale, origin_at(path, keys))


def line_grid(file: LineFile) -> OccupancyGrid:
    """Return the grid with every cell occupied that a wall runs through, all others free, one cell wider than the walls."""
    walls = _rows(file.data) * file.scale
    low = np.floor(walls.min(axis=(0, 1)) / CELL) - 1
    columns, rows = (np.ceil(walls.max(axis=(0, 1)) / CELL) - low + 1).astype(int)
    if rows * columns > LARGEST:
        raise InputFileError(f"{file.data}: its walls span {columns} x {rows} cells of {CELL:g} m; allowed: {LARGEST} in all")
    data = np.full((rows, columns), FREE, np.int8)
    for start, end in walls / CELL - low:
        count = int(np.ceil(2.0 * np.abs(end - start).max())) + 1  # two points a cell
        x, y = (start + np.linspace(0.0, 1.0, count)[:, None] * (end - start)).astype(int).T
        data[y, x] = OCCUPIED
        data[y[:-1], x[1:]] = OCCUPIED  # no two cells of a wall touch by a corner alone, where a ray could slip through
    return OccupancyGrid(data, CELL, Pose(*file.origin).compose(Pose(*(low * CELL).tolist())))


def _rows(path: Path) -> NDArray[np.float64]:
    """Return the walls (W, 2, 2), each from a place to another; raise InputFileError."""
    try:
        with path.open("rb") as file:
            content = file.read(LARGEST_FILE + 1)
        rows = [line.split() for line in content.decode().splitlines() if line.strip()] if len(content) <= LARGEST_FILE else []
        walls = np.array(rows, np.float64).reshape(-1, 2, 2) if all(len(row) == 4 for row in rows) else np.empty((0, 2, 2))
    except (OSError, ValueError) as error:
        raise InputFileError(f"{path}: cannot be read ({' '.join(str(error).split())}); allowed: rows of x1 y1 x2 y2") from None
    if len(walls) == 0 or not (np.abs(walls) < 1e9).all():
        raise InputFileError(f"{path}: has no walls, or rows of other than 4 finite numbers; allowed: rows of x1 y1 x2 y2")
    return walls
