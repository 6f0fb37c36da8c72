"""What each pose of a band is paired with: static points, moving discs at its time, via points."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from arena_kernels.compiled import compiled, inner
from arena_kernels.window import Window, distance_at
from arena_teb.association import Reach, associated
from arena_teb.polygons import Hulls
from arena_teb.problem import FloatArray, Surroundings


class Scene(NamedTuple):
    """What a control step sees, in ``map``: the window without what moves, its polygons, if cells are turned into such, discs
    ``positions`` (K, 2) with ``velocities`` and ``radii``, which move on for ``horizon`` s and then stand, points ``vias`` (V, 2)."""

    window: Window
    hulls: Hulls
    positions: FloatArray
    velocities: FloatArray
    radii: FloatArray
    horizon: float
    vias: FloatArray


class Vicinity(NamedTuple):
    """How near counts: static points within ``reach`` of the origin; speed is cut to ``slowest`` (share) where the origin is
    ``slow_from`` m or less from the nearest one, and free from ``free_from`` m on."""

    reach: Reach
    slowest: float
    slow_from: float
    free_from: float


@compiled
def surroundings(band: FloatArray, scene: Scene, vicinity: Vicinity) -> Surroundings:
    """Pair the poses of a band (N, 4) with what is around them, moving discs at constant velocity up to a horizon (IV of RAS 2017)."""
    count, tracks = len(band), len(scene.radii)
    points, caps = associated(band, scene.window, scene.hulls, vicinity.reach), np.ones(count)
    moving = np.empty((count, tracks, 2))
    time = 0.0
    for k in range(count):
        free = distance_at(scene.window, band[k, 0], band[k, 1])
        free = math.inf if free == -math.inf else free  # nothing is known beyond the window
        ahead = min(time, scene.horizon)
        for j in range(tracks):
            moving[k, j, 0] = scene.positions[j, 0] + ahead * scene.velocities[j, 0]
            moving[k, j, 1] = scene.positions[j, 1] + ahead * scene.velocities[j, 1]
            free = min(free, math.hypot(moving[k, j, 0] - band[k, 0], moving[k, j, 1] - band[k, 1]) - scene.radii[j])
        caps[k] = speed_cap(free, vicinity)
        time += band[k, 3]
    poses = np.empty(len(scene.vias), np.int64)
    for j in range(len(scene.vias)):
        poses[j] = nearest_pose(band, scene.vias[j, 0], scene.vias[j, 1])
    return Surroundings(points, 0.5 * scene.window.resolution, caps, moving, scene.radii, scene.vias, poses)


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
        squared = (band[k, 0] - x) ** 2 + (band[k, 1] - y) ** 2
        if squared < best:
            best, at = squared, k
    return at
