"""What each pose of a band is paired with: static points, moving discs at its time, via points."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from arena_kernels.compiled import compiled, inner
from arena_kernels.costmap_window import CostmapWindow, distance_at
from arena_kernels.foreseen import Foreseen, leg_at, place_on
from arena_teb.association import Reach, associate_points
from arena_teb.columns import LEFT, RIGHT, TIME, X, Y
from arena_teb.polygons import Hulls
from arena_teb.problem import FloatArray, Shape, Surroundings

OPPOSITE = -0.5  # cosine between the directions to the left and the right, below which a pose lies in a passage


class Scene(NamedTuple):
    """What a control step sees, in ``map``: the window without what moves, its polygons, if cells are turned into such,
    discs with ``radii`` (K,) that go where they are ``foreseen`` for ``horizon`` s and then stand, points ``vias`` (V,
    2)."""

    window: CostmapWindow
    hulls: Hulls
    foreseen: Foreseen
    radii: FloatArray
    horizon: float
    vias: FloatArray


class Vicinity(NamedTuple):
    """How near counts: static points within ``reach`` of the origin; speed is cut to ``slowest`` (share) where the
    origin is ``slow_from`` m or less from the nearest one, and free from ``free_from`` m on."""

    reach: Reach
    slowest: float
    slow_from: float
    free_from: float


@compiled
def find_surroundings(band: FloatArray, scene: Scene, vicinity: Vicinity, shape: Shape) -> Surroundings:
    """Pair the poses of a band (N, 4) with what is around them, moving discs where they are foreseen up to a
    horizon (IV of RAS 2017).
    """
    count, tracks = len(band), len(scene.radii)
    points, caps, room = (
        associate_points(band, scene.window, scene.hulls, vicinity.reach),
        np.ones(count),
        np.full(count, np.inf),
    )
    point_radius = 0.5 * scene.window.resolution
    moving = np.empty((count, tracks, 2))
    time = 0.0
    for k in range(count):
        free = distance_at(scene.window, band[k, X], band[k, Y])
        free = math.inf if free == -math.inf else free  # nothing is known beyond the window
        ahead = min(time, scene.horizon)
        leg = leg_at(scene.foreseen, ahead)
        for j in range(tracks):
            moving[k, j, X], moving[k, j, Y] = place_on(scene.foreseen, j, leg, ahead)
            free = min(free, math.hypot(moving[k, j, X] - band[k, X], moving[k, j, Y] - band[k, Y]) - scene.radii[j])
        caps[k] = speed_cap(free, vicinity)
        if vicinity.reach.forced == 0.0:  # else the first two points are not the nearest ones
            room[k] = room_beside(band[k], points[k], point_radius + shape.inscribed)
        time += band[k, TIME]
    poses = np.empty(len(scene.vias), np.int64)
    for j in range(len(scene.vias)):
        poses[j] = nearest_pose(band, scene.vias[j, X], scene.vias[j, Y])
    return Surroundings(points, point_radius, caps, room, moving, scene.radii, scene.vias, poses)


@inner
def room_beside(pose: FloatArray, points: FloatArray, taken: float) -> float:
    """Return the gap, m, that the nearest points to the left and right, ``points[LEFT]`` and ``points[RIGHT]``, leave
    on either side.

    ``taken`` m of each half of the passage is the robot's half width and the point's radius. Infinite where they do not
    face each other.
    """
    left_x, left_y = points[LEFT, X] - pose[X], points[LEFT, Y] - pose[Y]
    right_x, right_y = points[RIGHT, X] - pose[X], points[RIGHT, Y] - pose[Y]
    if math.isinf(left_x) or math.isinf(right_x):
        return math.inf
    if left_x * right_x + left_y * right_y > OPPOSITE * math.hypot(left_x, left_y) * math.hypot(right_x, right_y):
        return math.inf
    return max(0.5 * math.hypot(left_x - right_x, left_y - right_y) - taken, 0.0)


@inner
def speed_cap(distance: float, vicinity: Vicinity) -> float:
    """Return the share of the speed limit that is allowed at a distance from the nearest obstacle."""
    if distance >= vicinity.free_from or vicinity.slowest >= 1.0:
        return 1.0
    share = max(distance - vicinity.slow_from, 0.0) / (vicinity.free_from - vicinity.slow_from)
    return vicinity.slowest + (1.0 - vicinity.slowest) * share


@inner
def nearest_pose(band: FloatArray, x: float, y: float) -> int:
    """Return the pose between start and goal that is nearest to a point."""
    best, at = math.inf, 1
    for k in range(1, len(band) - 1):
        squared = (band[k, X] - x) ** 2 + (band[k, Y] - y) ** 2
        if squared < best:
            best, at = squared, k
    return at
