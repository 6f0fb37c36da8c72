"""The lidar of N robots: what stands, people and noise."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arena_core import Lidar
from arena_kernels.compiled import borrowing
from arena_kernels.random import normals
from arena_kernels.raycast import Beams, cast_discs, cast_grid, cast_segments, make_beams
from arena_sim2d.bodies import Floats, Moving


class Scanner(NamedTuple):
    """A lidar as the kernels read it: ``mount`` (3,) in ``base_link``, ``period`` in ticks, noise and minimum range in m.

    ``normals`` (B,) is the kernels' own.
    """

    beams: Beams
    mount: Floats
    period: int
    range_min: float
    noise_std: float
    normals: Floats


class Scans(NamedTuple):
    """The newest scan of each of N robots: ``ranges`` (N, B) m, ``ticks`` (N,) of their stamps, noise stream keys."""

    ranges: NDArray[np.float32]
    ticks: NDArray[np.int64]
    keys: NDArray[np.uint64]


def scanner(lidar: Lidar, inner_step: float) -> Scanner:
    """Return what the kernels need to know of a lidar."""
    return Scanner(
        make_beams(lidar.angle_min, lidar.angle_increment, lidar.beams, lidar.range_max),
        lidar.mount.array(),
        round(lidar.period / inner_step),
        float(lidar.range_min),
        float(lidar.noise_std),
        np.zeros(lidar.beams),
    )


@borrowing
def scan(world: Moving, device: Scanner, scans: Scans, k: int, tick: int) -> None:
    """Take the scan of robot k at ``tick``."""
    scene, robots, people = world.scene, world.robots, world.people
    theta = robots.poses[k, 2]
    c, s = math.cos(theta), math.sin(theta)
    x = robots.poses[k, 0] + c * device.mount[0] - s * device.mount[1]
    y = robots.poses[k, 1] + s * device.mount[0] + c * device.mount[1]
    yaw = theta + device.mount[2]
    ranges, obstacles, count = scans.ranges[k], scene.obstacles, people.counts[k]
    cast_grid(scene.stack, scene.grid_of[k], x, y, yaw, device.beams, ranges)
    first, last = obstacles.discs_of[k], obstacles.discs_of[k + 1]
    cast_discs(x, y, yaw, device.beams, obstacles.centres[first:last], obstacles.radii[first:last], ranges)
    cast_segments(x, y, yaw, device.beams, obstacles.edges[obstacles.edges_of[k] : obstacles.edges_of[k + 1]], ranges)
    cast_discs(x, y, yaw, device.beams, people.positions[k, :count], people.radii[k, :count], ranges)
    _disturb(device, scans.keys[k], tick, ranges)
    scans.ticks[k] = tick


@borrowing
def _disturb(device: Scanner, key: np.uint64, tick: int, ranges: NDArray[np.float32]) -> None:
    """Add Gaussian noise to what was hit; what is nearer than the minimum range reads as the minimum range."""
    if device.noise_std > 0.0:
        normals(key, tick, device.normals)
    for i in range(len(ranges)):
        if ranges[i] < math.inf:
            ranges[i] = min(max(ranges[i] + device.noise_std * device.normals[i], device.range_min), device.beams.range_max)
