"""What each pose of a band is paired with: the nearest static points to its left and right, moving discs at its time, via points."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from arena_kernels.compiled import borrowing, compiled, inner
from arena_kernels.window import LETHAL, Window, distance_at
from arena_teb.problem import FloatArray, Surroundings


class Scene(NamedTuple):
    """What a control step sees, in ``map``: the window without what moves, discs ``positions`` (K, 2) with ``velocities`` and
    ``radii``, points ``vias`` (V, 2) to pass."""

    window: Window
    positions: FloatArray
    velocities: FloatArray
    radii: FloatArray
    vias: FloatArray


class Vicinity(NamedTuple):
    """How near counts: static points within ``reach`` m of the origin; speed is cut to ``slowest`` (share) where the origin is
    ``slow_from`` m or less from the nearest one, and free from ``free_from`` m on."""

    reach: float
    slowest: float
    slow_from: float
    free_from: float


@compiled
def surroundings(band: FloatArray, scene: Scene, vicinity: Vicinity) -> Surroundings:
    """Pair the poses of a band (N, 4) with what is around them, moving discs at constant velocity (IV of RAS 2017)."""
    count, tracks = len(band), len(scene.radii)
    points, caps = np.full((count, 2, 2), np.inf), np.ones(count)
    moving = np.empty((count, tracks, 2))
    time = 0.0
    for k in range(count):
        distance = distance_at(scene.window, band[k, 0], band[k, 1])
        caps[k] = speed_cap(distance, vicinity)
        if -math.inf < distance < vicinity.reach:
            nearest_points(scene.window, band[k, 0], band[k, 1], band[k, 2], vicinity.reach, points[k])
        for j in range(tracks):
            moving[k, j, 0] = scene.positions[j, 0] + time * scene.velocities[j, 0]
            moving[k, j, 1] = scene.positions[j, 1] + time * scene.velocities[j, 1]
        time += band[k, 3]
    poses = np.empty(len(scene.vias), np.int64)
    for j in range(len(scene.vias)):
        poses[j] = nearest_pose(band, scene.vias[j, 0], scene.vias[j, 1])
    return Surroundings(points, 0.5 * scene.window.resolution, caps, moving, scene.radii, scene.vias, poses)


@inner
def speed_cap(distance: float, vicinity: Vicinity) -> float:
    """Return the share of the speed limit that is allowed at a distance from static obstacles."""
    if distance >= vicinity.free_from or vicinity.slowest >= 1.0:
        return 1.0
    share = max(distance - vicinity.slow_from, 0.0) / (vicinity.free_from - vicinity.slow_from)
    return vicinity.slowest + (1.0 - vicinity.slowest) * share


@borrowing
def nearest_points(window: Window, x: float, y: float, heading: float, reach: float, found: FloatArray) -> None:
    """Write the centres of the nearest lethal cells to the left and to the right of a pose into ``found`` (2, 2)."""
    rows, columns = window.costs.shape
    u, v = (x - window.origin_x) / window.resolution - 0.5, (y - window.origin_y) / window.resolution - 0.5
    cells = reach / window.resolution
    c, s = math.cos(heading), math.sin(heading)
    left, right = cells * cells, cells * cells
    for row in range(max(0, math.ceil(v - cells)), min(rows - 1, math.floor(v + cells)) + 1):
        dy = row - v
        for column in range(max(0, math.ceil(u - cells)), min(columns - 1, math.floor(u + cells)) + 1):
            if window.costs[row, column] < LETHAL:
                continue
            dx = column - u
            squared = dx * dx + dy * dy
            if c * dy - s * dx >= 0.0:
                if squared < left:
                    left = squared
                    found[0, 0], found[0, 1] = x + dx * window.resolution, y + dy * window.resolution
            elif squared < right:
                right = squared
                found[1, 0], found[1, 1] = x + dx * window.resolution, y + dy * window.resolution


@inner
def nearest_pose(band: FloatArray, x: float, y: float) -> int:
    """Return the pose between start and goal that is nearest to a point."""
    best, at = math.inf, 1
    for k in range(1, len(band) - 1):
        squared = (band[k, 0] - x) ** 2 + (band[k, 1] - y) ** 2
        if squared < best:
            best, at = squared, k
    return at
