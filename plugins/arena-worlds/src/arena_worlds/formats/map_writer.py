"""Write a grid as map_server reads it: a YAML file and the PGM beside it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import yaml
from numpy.typing import NDArray

from arena_core import FREE, OCCUPIED, UNKNOWN, ConfigurationError, OccupancyGrid
from arena_core.files import write_bytes_whole, write_text_whole
from arena_worlds.formats.map_yaml import Mode

PIXELS = {OCCUPIED: 0, UNKNOWN: 205, FREE: 254}  # as map_saver writes them
OCCUPIED_THRESH, FREE_THRESH = 0.65, 0.196  # as map_saver writes them: 205 lies between


def write_map(path: Path, grid: OccupancyGrid) -> list[Path]:
    """Write ``path`` (a .yaml) and the .pgm of the same name beside it; return both. Read again they give the same
    grid, exactly.

    A grid of free, occupied and unknown cells is written in mode trinary, any other in mode raw, for no other keeps all
    values. Raises ConfigurationError for another ending, RunFolderError where a file cannot be written.
    """
    if path.suffix != ".yaml":
        raise ConfigurationError(f"{path}: allowed: a file that ends in .yaml")
    image = path.with_suffix(".pgm")
    mode, text = map_text(grid, image.name)
    write_bytes_whole(image, pgm_bytes(pixels_of(grid.data) if mode == "trinary" else grid.data.view(np.uint8)))
    write_text_whole(path, text)
    return [path, image]


def map_text(grid: OccupancyGrid, image: str) -> tuple[Mode, str]:
    """Return the mode that keeps all values of a grid, and the YAML of its map, whose image is called ``image``."""
    mode: Mode = "trinary" if np.isin(grid.data, list(PIXELS)).all() else "raw"
    return mode, _map_yaml(grid, image, mode)


def pgm_bytes(pixels: NDArray[np.uint8]) -> bytes:
    """Return a binary PGM of pixels (H, W), row 0 at the bottom."""
    rows, columns = pixels.shape
    return f"P5\n{columns} {rows}\n255\n".encode() + pixels[::-1].tobytes()


def pixels_of(data: NDArray[np.int8]) -> NDArray[np.uint8]:
    """Return the shades of free, occupied and unknown cells (H, W)."""
    shades = np.zeros(256, np.uint8)
    for value, shade in PIXELS.items():
        shades[np.uint8(value & 0xFF)] = shade
    return np.asarray(shades[data.view(np.uint8)])


def _map_yaml(grid: OccupancyGrid, image: str, mode: str) -> str:
    keys = {
        "image": image,
        "mode": mode,
        "resolution": float(grid.resolution),
        "origin": [float(grid.origin.x), float(grid.origin.y), float(grid.origin.theta)],
        "negate": 0,
        "occupied_thresh": OCCUPIED_THRESH,
        "free_thresh": FREE_THRESH,
    }
    return str(yaml.safe_dump(keys, sort_keys=False, default_flow_style=None, allow_unicode=True))
