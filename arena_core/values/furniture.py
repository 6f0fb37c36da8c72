"""Furniture with overhang: legs at the height of a lidar, tops above.

What of it is met depends on the height at which one meets it.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from arena_core.base.errors import ConfigurationError
from arena_core.values.geometry import FloatArray, Pose
from arena_core.values.obstacles import add_obstacles
from arena_core.values.scene import out_of_frame
from arena_core.values.world import Furniture, Obstacle, OccupancyGrid, World

OVERHEAD = 2.0  # m; what hangs higher than this is over everybody's head
BOX, CYLINDER = "[x, y, length, width, bottom, top] (m)", "[x, y, radius, bottom, top] (m)"
CORNERS = np.array(((0.5, 0.5), (-0.5, 0.5), (-0.5, -0.5), (0.5, -0.5)))


@dataclass(frozen=True, slots=True)
class FurnitureKind:
    """A kind of furniture as conf/furniture has it: its solids by name, in its own frame, m; they stand upright, sides
    along x and y.

    Each of ``boxes`` is x, y, length, width, bottom and top; each of ``cylinders`` is x, y, radius, bottom and top.
    """

    boxes: dict[str, list[float]]
    cylinders: dict[str, list[float]]

    def at(self, kind: str, pose: Pose) -> Furniture:
        """Return a piece of this kind, which is called ``kind``; raise
        ConfigurationError for a solid without an extent.
        """
        if not self.boxes and not self.cylinders:
            raise ConfigurationError(
                f"furniture {kind} has no solids; allowed: one or more of boxes {BOX} or cylinders {CYLINDER}"
            )
        boxes, cylinders = (
            _solid_rows(kind, "boxes", self.boxes, 6, BOX),
            _solid_rows(kind, "cylinders", self.cylinders, 5, CYLINDER),
        )
        return Furniture(kind, pose, np.insert(boxes, 2, 0.0, axis=1), cylinders)


def _solid_rows(kind: str, shape: str, solids: Mapping[str, list[float]], width: int, allowed: str) -> FloatArray:
    """Return solids as rows (N, width)."""
    for name, row in solids.items():
        if len(row) != width or min(row[2:-2]) <= 0.0 or not 0.0 <= row[-2] < row[-1]:
            raise ConfigurationError(
                f"furniture {kind}: {shape}.{name} is {row}; allowed: {allowed}, extents > 0, 0 <= bottom < top"
            )
    return np.array(list(solids.values()), np.float64).reshape(-1, width)


def furniture_outlines(pieces: Iterable[Furniture], low: float, high: float) -> tuple[Obstacle, ...]:
    """Return what of furniture a person meets who reaches from ``low`` to ``high`` m, in
    ``map``; a slice where both are equal.
    """
    found = []
    for piece in pieces:
        for x, y, yaw, length, width, _, _ in piece.boxes[_within_heights(piece.boxes, low, high)].tolist():
            found.append(Obstacle(out_of_frame(out_of_frame(CORNERS * (length, width), Pose(x, y, yaw)), piece.pose)))
        for x, y, radius, _, _ in piece.cylinders[_within_heights(piece.cylinders, low, high)].tolist():
            found.append(Obstacle(out_of_frame(np.array([[x, y]]), piece.pose), radius))
    return tuple(found)


def _within_heights(rows: FloatArray, low: float, high: float) -> NDArray[np.bool_]:
    """Tell which solids reach between two heights; a level plane at the top of one passes over it."""
    return np.asarray((rows[:, -2] <= high) & (rows[:, -1] > low))


def add_furniture(world: World) -> OccupancyGrid:
    """Return the map with all occupied that furniture covers below heads, where no one can stand; without
    furniture the map itself.
    """
    return world.grid.derive(_Furnished(world.furniture)) if world.furniture else world.grid


@dataclass(frozen=True, slots=True)
class _Furnished:
    """A key and function for ``grid.derive``; pieces are equal only to themselves."""

    pieces: tuple[Furniture, ...]

    def __call__(self, grid: OccupancyGrid) -> OccupancyGrid:
        return add_obstacles(grid, furniture_outlines(self.pieces, 0.0, OVERHEAD))


def furniture_meta(piece: Furniture) -> dict[str, Any]:
    """Return a piece as records have it."""
    pose = piece.pose
    solids = {"boxes": piece.boxes.tolist(), "cylinders": piece.cylinders.tolist()}
    return {"kind": piece.kind, "pose": [pose.x, pose.y, pose.theta], **solids}


def furniture_shapes(pieces: Iterable[Furniture]) -> list[dict[str, Any]]:
    """Return furniture as seen from above: obstacles as records have them, what hangs over
    (``overhang``) before what stands.
    """
    pieces = list(pieces)
    tops = [{**_shape_dict(outline), "overhang": True} for outline in furniture_outlines(pieces, 0.0, OVERHEAD)]
    return tops + [_shape_dict(outline) for outline in furniture_outlines(pieces, 0.0, 0.0)]


def _shape_dict(outline: Obstacle) -> dict[str, Any]:
    return {"vertices_xy": outline.vertices_xy.tolist(), "radius": outline.radius}


def furniture_of(scenario: Mapping[str, Any]) -> tuple[Furniture, ...]:
    """Return the furniture of a record's ``meta["scenario"]``; records from before there was any have none."""
    return tuple(
        Furniture(
            piece["kind"],
            Pose(*piece["pose"]),
            np.asarray(piece["boxes"], np.float64).reshape(-1, 7),
            np.asarray(piece["cylinders"], np.float64).reshape(-1, 5),
        )
        for piece in scenario.get("furniture", [])
    )
