"""A world in three dimensions: upright solids with a bottom and a top.

Its 2-D grid is the slice at the height of the lidar.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from arena_core.values.geometry import FloatArray, Pose
from arena_core.values.rectangles import cover_with_rectangles
from arena_core.values.world import Furniture, Obstacle, OccupancyGrid


@dataclass(frozen=True, slots=True, eq=False)
class Prism:
    """An upright prism over a simple polygon ``vertices_xy`` (V, 2), m, from ``bottom`` to ``top``, m."""

    vertices_xy: FloatArray
    bottom: float
    top: float


@dataclass(frozen=True, slots=True, eq=False)
class Scene:
    """What stands in a world, in the frame ``origin``, whose pose is in ``map``; the ground is level, at height 0.

    ``boxes`` (N, 7) are x, y (m), yaw (rad), length, width, bottom and top (m); ``cylinders`` (M, 5) are x, y, radius,
    bottom and top, m. ``size`` (m, m) is the ground, from ``origin`` to its upper right corner; None where it is not
    bounded.
    """

    origin: Pose
    size: tuple[float, float] | None
    boxes: FloatArray = field(default_factory=lambda: np.empty((0, 7)))
    cylinders: FloatArray = field(default_factory=lambda: np.empty((0, 5)))
    prisms: tuple[Prism, ...] = ()


def wall_boxes(grid: OccupancyGrid) -> FloatArray:
    """Return few boxes that fill a grid's occupied cells, each cell once: (N, 5) of x, y, yaw, length and
    width, in the grid's frame.
    """
    first_row, first_column, end_row, end_column = cover_with_rectangles(grid.occupied).T * grid.resolution
    middle = 0.5 * (first_column + end_column), 0.5 * (first_row + end_row)
    return np.stack((*middle, np.zeros(len(first_row)), end_column - first_column, end_row - first_row), axis=1)


def scene_of(
    grid: OccupancyGrid, obstacles: Sequence[Obstacle], height: float, furniture: Sequence[Furniture] = ()
) -> Scene:
    """Return a map's walls as merged boxes, a scenario's obstacles as cylinders and prisms, all
    ``height`` m high, and furniture.
    """
    pieces = furniture_scene(furniture, grid.origin)
    rows, columns = grid.data.shape
    discs = [obstacle for obstacle in obstacles if len(obstacle.vertices_xy) == 1]
    polygons = [obstacle.vertices_xy for obstacle in obstacles if len(obstacle.vertices_xy) > 1]
    centres = _in_frame(np.array([disc.vertices_xy[0] for disc in discs]).reshape(-1, 2), grid.origin)
    return Scene(
        grid.origin,
        (columns * grid.resolution, rows * grid.resolution),
        np.vstack((raise_footprints(wall_boxes(grid), height), pieces.boxes)),
        np.vstack(
            (raise_footprints(np.column_stack((centres, [disc.radius for disc in discs])), height), pieces.cylinders)
        ),
        tuple(Prism(_in_frame(vertices, grid.origin), 0.0, height) for vertices in polygons),
    )


def furniture_scene(furniture: Sequence[Furniture], origin: Pose) -> Scene:
    """Return pieces of furniture alone, in the frame ``origin``, piece by piece."""
    boxes, cylinders = [np.empty((0, 7))], [np.empty((0, 5))]
    for piece in furniture:
        place = origin.relative(piece.pose)
        boxes.append(
            np.column_stack(
                (out_of_frame(piece.boxes[:, :2], place), piece.boxes[:, 2] + place.theta, piece.boxes[:, 3:])
            )
        )
        cylinders.append(np.column_stack((out_of_frame(piece.cylinders[:, :2], place), piece.cylinders[:, 2:])))
    return Scene(origin, None, np.vstack(boxes), np.vstack(cylinders))


def raise_footprints(footprints: FloatArray, height: float) -> FloatArray:
    """Return rows (N, K) of footprints as rows (N, K + 2) of solids that stand on the ground, ``height`` m high."""
    return np.column_stack((footprints, np.zeros(len(footprints)), np.full(len(footprints), float(height))))


def out_of_frame(points: FloatArray, frame: Pose) -> FloatArray:
    """Return points (N, 2) seen from a pose as they are in the frame that the pose is in."""
    cosine, sine = np.cos(frame.theta), np.sin(frame.theta)
    return np.asarray(points @ np.array(((cosine, sine), (-sine, cosine))) + (frame.x, frame.y))


def _in_frame(points: FloatArray, frame: Pose) -> FloatArray:
    """Return points (N, 2) of ``map`` as seen from a pose."""
    cosine, sine = np.cos(frame.theta), np.sin(frame.theta)
    return np.asarray((points - (frame.x, frame.y)) @ np.array(((cosine, -sine), (sine, cosine))))
