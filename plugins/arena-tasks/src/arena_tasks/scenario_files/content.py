"""What a scenario's content is called, so that results from different files are never taken for the same."""

from __future__ import annotations

from hashlib import blake2b

from arena_core import OccupancyGrid
from arena_tasks.scenario_files.pack import Pack


def content_hash(file_hash: str, grid: OccupancyGrid, pack: Pack | None) -> str:
    """Return twelve hexadecimal digits of a scenario file's bytes and its map's
    cells, in a pack after ``ID@VERSION:``.
    """
    digest = blake2b(file_hash.encode() + grid.derive(_grid_digest), digest_size=6).hexdigest()
    return f"{pack.id}@{pack.version}:{digest}" if pack else digest


def _grid_digest(grid: OccupancyGrid) -> bytes:
    place = repr((grid.data.shape, grid.resolution, grid.origin.array().tolist(), grid.occupied_from))
    return blake2b(grid.data.tobytes() + place.encode(), digest_size=16).digest()
