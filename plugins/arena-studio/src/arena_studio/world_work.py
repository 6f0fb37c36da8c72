"""Worlds for the map editor: drawn by kind, read from files of other programs, measured; for
none of it the server has to wait.
"""

from __future__ import annotations

import base64
from pathlib import Path
from typing import Any

from arena_studio.mapping.drawn_worlds import draw_world, drawable_kinds, measure_file, read_parameters
from arena_studio.mapping.map_document import grid_document, map_document
from arena_studio.mapping.transfer import pack_cells
from arena_studio.project import Project


def world_kinds() -> list[dict[str, Any]]:
    """Return the kinds of worlds that can be drawn."""
    return drawable_kinds()


def drawn(kind: str, seed: int, parameters: str) -> str:
    """Return the first world of a seed as the page takes maps, in base64; raise ConfigurationError."""
    world = draw_world(kind, seed, read_parameters(parameters))
    header, codes = grid_document(world.grid, None)
    header["furniture"] = [{"kind": piece.kind, "pose": piece.pose.array().tolist()} for piece in world.furniture]
    return base64.b64encode(pack_cells(header, codes.tobytes())).decode()


def world(path: str) -> str:
    """Return a world of the project as the page takes maps, in base64; raise ArenaError."""
    header, codes = map_document(_current_project(), path)
    return base64.b64encode(pack_cells(header, codes.tobytes())).decode()


def measures(path: str, robot_radius: float | None) -> list[dict[str, Any]]:
    """Return how difficult a world of the project is; raise ArenaError."""
    return measure_file(_current_project(), path, robot_radius)


def ends(path: str) -> tuple[list[float], list[float]]:
    """Return a start and a goal across a world of the project; raise ArenaError."""
    from arena_studio.mapping.route_ends import start_and_goal

    return start_and_goal(_current_project(), path)


def _current_project() -> Project:
    return Project(Path.cwd())
