"""Records and maps of a run's folder: written whole, read back as they were (docs/records.md lists every array)."""

from __future__ import annotations

import io
import json
from collections.abc import Mapping
from hashlib import blake2b
from pathlib import Path
from typing import IO, Any
from zipfile import ZIP_DEFLATED, ZipFile, ZipInfo

import numpy as np
from numpy.typing import NDArray

from arena_core.base.arrays import read_arrays
from arena_core.base.errors import InputFileError, one_line
from arena_core.base.files import AnyPath, check_inside, reason_of
from arena_core.base.limits import LIMITS
from arena_core.base.whole_files import write_whole
from arena_core.loop.grain import GRAIN
from arena_core.loop.record_layout import fault_of, fault_of_timing
from arena_core.loop.record_places import record_path, run_folder_of, timing_of, timing_path
from arena_core.values.episode import EpisodeRecord
from arena_core.values.geometry import Pose
from arena_core.values.world import OccupancyGrid

FORMAT = 1


def write_record(folder: Path, episode: int, record: EpisodeRecord) -> None:
    """Write ``records/NNNN.npz`` and ``timing/NNNN.npz`` (record_places.py), each whole or not at all."""
    meta = json.dumps(record.meta, sort_keys=True)
    timing, arrays = timing_path(folder, episode), record_path(folder, episode)
    check_inside(folder, timing.parent)
    check_inside(folder, arrays.parent)
    write_whole(timing, lambda file: _write_npz(file, record.timing))
    write_whole(arrays, lambda file: _write_npz(file, {"meta": np.array(meta), **record.arrays}))


def read_record(path: AnyPath) -> EpisodeRecord:
    """Read a record with its timing; raise InputFileError when it is missing, damaged, of another format,
    or a link out of the run.
    """
    path = Path(path)
    check_inside(run_folder_of(path), path)
    arrays = _read_npz(path)
    try:
        meta = json.loads(str(arrays.pop("meta")))
    except (KeyError, ValueError, RecursionError) as error:
        raise InputFileError(
            f"{path}: no record ({reason_of(error)}); allowed: a file that `arena run` wrote"
        ) from error
    if isinstance(meta, dict) and meta.get("format") != FORMAT:
        raise InputFileError(f"{path}: format is {one_line(repr(meta.get('format')), 40)}; allowed: {FORMAT}")
    if fault := fault_of(arrays, meta):
        raise InputFileError(f"{path}: no record ({one_line(fault)}); allowed: a file that `arena run` wrote")
    timing = _read_timing(timing_of(path))
    # as they were before they were written
    rows_first = {name: np.ascontiguousarray(array) for name, array in arrays.items()}
    return EpisodeRecord(rows_first, meta, timing)


def _read_timing(path: Path) -> dict[str, NDArray[np.float64]]:
    arrays = _read_npz(path) if path.exists() else {}
    if fault := fault_of_timing(arrays):
        raise InputFileError(f"{path}: no times ({one_line(fault)}); allowed: a file that `arena run` wrote")
    return arrays


def write_grid(folder: Path, grid: OccupancyGrid) -> str:
    """Write a map once as ``worlds/HASH.npz`` (data, resolution, origin) and return that relative name."""
    origin = grid.origin.array()
    digest = blake2b(
        grid.data.tobytes() + repr((grid.data.shape, grid.resolution, origin.tolist())).encode(), digest_size=8
    ).hexdigest()
    name = f"worlds/{digest}.npz"
    check_inside(folder, folder / name)
    if not (folder / name).exists():
        content = {"data": grid.data, "resolution": np.array(grid.resolution), "origin": origin}
        write_whole(folder / name, lambda file: _write_npz(file, content))
    return name


def read_grid(path: AnyPath) -> OccupancyGrid:
    """Read a run's map, ``worlds/HASH.npz``; raise InputFileError when it is missing, damaged or
    leads out of the run's folder.
    """
    path, allowed = Path(path), "the maps that `arena run` wrote beside the records"
    check_inside(path.parent.parent, path)
    content = read_arrays(path, allowed)
    try:
        data, resolution, origin = content["data"], float(content["resolution"]), content["origin"].astype(np.float64)
    except (KeyError, TypeError, ValueError) as error:
        raise InputFileError(f"{path}: damaged ({one_line(repr(error))}); allowed: {allowed}") from None
    fits = data.ndim == 2 and data.dtype == np.int8 and data.size <= LIMITS.cells and origin.shape == (3,)
    known = 0.0 < resolution <= LIMITS.number_largest and (np.abs(origin) <= LIMITS.record_farthest).all()
    if not (fits and known):
        raise InputFileError(f"{path}: damaged (its arrays are not those of a map); allowed: {allowed}")
    return OccupancyGrid(data, resolution, Pose.of(origin))


def _write_npz(file: IO[bytes], arrays: Mapping[str, NDArray[Any]]) -> None:
    """Write arrays as ``np.savez_compressed`` does, with the quickest compression; rounded ones column by
    column: they pack better.
    """
    with ZipFile(file, "w") as archive:
        for name, array in arrays.items():
            content = io.BytesIO()
            np.lib.format.write_array(
                content, np.asfortranarray(array) if name in GRAIN else np.asanyarray(array), allow_pickle=False
            )
            member = ZipInfo(f"{name}.npy")  # dated 1980: equal records are equal files
            member.external_attr = 0o600 << 16
            archive.writestr(member, content.getbuffer(), ZIP_DEFLATED, 1)


def _read_npz(path: Path) -> dict[str, Any]:
    return read_arrays(path, "a file that `arena run` wrote")
