"""Worlds for the map editor: drawn by kind, read from files of other programs, measured; for
none of it the server has to wait.
"""

from __future__ import annotations

import base64
from pathlib import Path
from typing import Any

from arena_studio.background.requests import (
    DrawWorld,
    FurnitureKinds,
    MeasureWorld,
    OpenWorld,
    RouteEnds,
    WorldKinds,
)
from arena_studio.mapping.drawn_worlds import draw_world, drawable_kinds, measure_file, read_parameters
from arena_studio.mapping.furnishing import furniture_kinds
from arena_studio.mapping.map_document import grid_document, map_document
from arena_studio.mapping.transfer import pack_cells
from arena_studio.project import Project


def world_kinds(_: WorldKinds) -> list[dict[str, Any]]:
    """Return the kinds of worlds that can be drawn."""
    return drawable_kinds()


def furniture_shapes_by_kind(_: FurnitureKinds) -> dict[str, list[dict[str, Any]]]:
    """Return the outlines of each kind of furniture in its own frame, m."""
    return furniture_kinds()


def draw_first_world(request: DrawWorld) -> str:
    """Return the first world of a seed as the page takes maps, in base64; raise ConfigurationError."""
    world = draw_world(request.kind, request.seed, read_parameters(request.parameters))
    header, codes = grid_document(world.grid, None)
    header["furniture"] = [{"kind": piece.kind, "pose": piece.pose.array().tolist()} for piece in world.furniture]
    return base64.b64encode(pack_cells(header, codes.tobytes())).decode()


def open_world(request: OpenWorld) -> str:
    """Return a world of the project as the page takes maps, in base64; raise ArenaError."""
    header, codes = map_document(_current_project(), request.path)
    return base64.b64encode(pack_cells(header, codes.tobytes())).decode()


def measure_world(request: MeasureWorld) -> list[dict[str, Any]]:
    """Return how difficult a world of the project is; raise ArenaError."""
    return measure_file(_current_project(), request.path, request.robot_radius)


def route_ends(request: RouteEnds) -> tuple[list[float], list[float]]:
    """Return a start and a goal across a world of the project; raise ArenaError."""
    from arena_studio.mapping.route_ends import start_and_goal

    return start_and_goal(_current_project(), request.path)


def _current_project() -> Project:
    return Project(Path.cwd())
