"""The worlds of the BARN challenge (Perille et al. 2020): fields of cylinders, and the
reference paths that come with them.
"""

from __future__ import annotations

import re
from functools import lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from arena_core import ConfigurationError, InputFileError, OccupancyGrid, World, WorldSource
from arena_core.files import read_array
from arena_core.parameters import NonNegative, Positive
from arena_worlds.formats.sdf import read_sdf
from arena_worlds.formats.solids import grid_of

CELL = 0.15  # m, of the grid that the worlds and paths were made on: a cylinder's diameter
CELL_ORIGIN = (-4.575, 5.075)  # m, x and y of a reference path's cell (0, 0) in the world (the challenge's run.py)
LONGEST_PATH = 100_000  # cells


class BarnWorlds(WorldSource):
    """World ``index`` is file ``index`` modulo their number, in the order of the numbers in their names.

    ``path`` is a file or a folder; ``path_files`` the folder of the reference paths, which World.reference_xy then has.
    """

    def __init__(
        self, path: str | None, path_files: str | None, resolution: Positive, margin: NonNegative, *, known: bool
    ) -> None:
        if path is None:
            raise ConfigurationError(
                "world.path is null; allowed: a .world or .world.gz file or a folder, as in world.path=world_files"
            )
        self._files = world_files(Path(path))
        self._paths = _paths_folder(self._files[0], path_files)
        self._resolution, self._margin, self._known = resolution, margin, known
        for file in self._files:  # what is wrong with a file is said before anything runs
            self._make_world(file)

    def world(self, seed: int, index: int) -> World:
        """Return the world of scenario ``index``, the same for every seed."""
        return self._make_world(self._files[index % len(self._files)])

    def _make_world(self, file: Path) -> World:
        written = file.stat()
        name = file.name.split(".")[0]
        grid = _load_grid(file, written.st_mtime_ns, written.st_size, self._resolution, self._margin)
        return World(f"barn/{name}", grid, self._known, _reference_path(self._paths, name))


def world_files(path: Path) -> list[Path]:
    """Return the world files that ``path`` names, in the order of their numbers; raise
    InputFileError when there is none.
    """
    if path.is_file():
        return [path]
    files = [file for file in path.iterdir() if file.name.endswith((".world", ".world.gz"))] if path.is_dir() else []
    if not files:
        raise InputFileError(
            f"{path}: is no file and no folder with world files; allowed: "
            "a .world or .world.gz file or a folder of them"
        )
    return sorted(files, key=lambda file: (_name_number(file.name), file.name))


def read_reference_path(path: Path) -> NDArray[np.float64]:
    """Return a reference path (M, 2) in the world, m, from its cells; raise InputFileError."""
    cells = read_array(path, "the path_N.npy of world_N")
    if cells.ndim != 2 or cells.shape[1] != 2 or not 0 < len(cells) <= LONGEST_PATH:
        raise InputFileError(
            f"{path}: shape is {cells.shape}; allowed: (M, 2), up to {LONGEST_PATH} cells of column and row"
        )
    if cells.dtype.kind not in "iu":
        raise InputFileError(f"{path}: type is {cells.dtype}; allowed: whole numbers")
    return np.asarray(cells, np.float64) * CELL + CELL_ORIGIN


def _paths_folder(world: Path, path_files: str | None) -> Path | None:
    if path_files is None:
        beside = world.resolve().parent.parent / "path_files"
        return beside if beside.is_dir() else None
    if not Path(path_files).is_dir():
        raise ConfigurationError(f"world.path_files is {path_files}; allowed: a folder of path_N.npy files, or null")
    return Path(path_files)


def _reference_path(folder: Path | None, name: str) -> NDArray[np.float64] | None:
    return None if folder is None else read_reference_path(folder / f"path_{_name_number(name)}.npy")


def _name_number(name: str) -> int:
    """Return the first number in a name, -1 where there is none."""
    digits = re.search(r"\d{1,9}", name)
    return int(digits[0]) if digits else -1


@lru_cache(maxsize=512)
def _load_grid(file: Path, written_ns: int, size: int, resolution: float, margin: float) -> OccupancyGrid:
    return grid_of(read_sdf(file), resolution, margin)
