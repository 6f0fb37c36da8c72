"""A map as a plain picture: dark is occupied, bright is free, grey between is unknown."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np
from PIL import Image

from arena_core import FREE, OCCUPIED, UNKNOWN, OccupancyGrid, Pose
from arena_core.files import write_bytes_whole
from arena_worlds.formats.map_image import read_occupancy
from arena_worlds.formats.map_writer import FREE_THRESH, OCCUPIED_THRESH, pixels_of
from arena_worlds.formats.map_yaml import MapFile


def read_picture(path: Path, resolution: float) -> OccupancyGrid:
    """Read a picture by map_saver's thresholds; its lower left corner is the origin of ``map``.

    Raises InputFileError.
    """
    file = MapFile(path, resolution, (0.0, 0.0, 0.0), False, OCCUPIED_THRESH, FREE_THRESH, "trinary")
    return OccupancyGrid(read_occupancy(file), resolution, Pose(0.0, 0.0))


def write_picture(path: Path, grid: OccupancyGrid) -> None:
    """Write a grid as a PNG or PGM in the shades of map_saver; resolution and origin are not in it.

    Raises RunFolderError.
    """
    cells = np.where(grid.occupied, OCCUPIED, np.where(grid.data < 0, UNKNOWN, FREE)).astype(np.int8)
    content = io.BytesIO()
    Image.fromarray(pixels_of(cells)[::-1]).save(content, "PNG" if path.suffix == ".png" else "PPM")
    write_bytes_whole(path, content.getvalue())
