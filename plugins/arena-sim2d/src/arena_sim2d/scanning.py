"""The lidar: what stands, people and noise."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arena_core import Lidar
from arena_kernels.compiled import inner
from arena_kernels.random import fill_normals
from arena_kernels.raycast import Beams, cast_disc, cast_grid, cast_segments, make_beams
from arena_sim2d.bodies import BEAMS, Floats, Row, Worlds, team_of
from arena_sim2d.clearances import place_outline
from arena_sim2d.walking import legs_now


class Scanner(NamedTuple):
    """A lidar as the kernels read it: ``mount`` (3,) in ``base_link``, ``period`` in ticks, noise and minimum range in
    m.

    ``fill_normals`` (B,) is the kernels' own.
    """

    beams: Beams
    mount: Floats
    period: int
    range_min: float
    noise_std: float
    normals: Floats


def scanner_of(lidar: Lidar, inner_step: float) -> Scanner:
    """Return what the kernels need to know of a lidar."""
    return Scanner(
        make_beams(lidar.angle_min, lidar.angle_increment, lidar.beams, lidar.range_max),
        lidar.mount.array(),
        round(lidar.period / inner_step),
        float(lidar.range_min),
        float(lidar.noise_std),
        np.zeros(lidar.beams),
    )


@inner
def take_scan(worlds: Worlds, device: Scanner, k: int, tick: int, ranges: NDArray[np.float32]) -> None:
    """Take the scan of robot k at ``tick`` into the first of ``ranges``, as many as its lidar has beams."""
    robot = worlds.robots[k]
    ranges = ranges[: len(device.beams.cosines)]
    c, s = math.cos(robot.theta), math.sin(robot.theta)
    x = robot.x + c * device.mount[0] - s * device.mount[1]
    y = robot.y + s * device.mount[0] + c * device.mount[1]
    yaw = robot.theta + device.mount[2]
    team = team_of(worlds)
    n = k // team
    cast_grid(worlds.stack, worlds.grid_of[n], (x, y, yaw), device.beams, ranges)
    for i in range(robot.obstacles):
        obstacle = worlds.obstacles[n, i]
        if obstacle.meets & BEAMS == 0:
            continue
        if obstacle.first < obstacle.last:
            cast_segments((x, y, yaw), device.beams, worlds.sides[n, obstacle.first : obstacle.last], ranges)
        else:
            cast_disc((x, y, yaw), device.beams, (obstacle.x, obstacle.y, obstacle.radius), ranges)
    for i in range(robot.people):
        person = worlds.people[n, i]
        if person.walks == 1:
            left_x, left_y, right_x, right_y, radius = legs_now(worlds.gait, person)
            cast_disc((x, y, yaw), device.beams, (left_x, left_y, radius), ranges)
            cast_disc((x, y, yaw), device.beams, (right_x, right_y, radius), ranges)
        else:
            cast_disc((x, y, yaw), device.beams, (person.x, person.y, person.radius), ranges)
    for row in range(n * team, (n + 1) * team):
        if row != k and not worlds.robots[row].absent:
            _cast_mate(worlds, device, row, (x, y, yaw), ranges)
    add_scan_noise(device, robot, tick, ranges)
    robot.scan_tick = tick


@inner
def _cast_mate(
    worlds: Worlds, device: Scanner, row: int, pose: tuple[float, float, float], ranges: NDArray[np.float32]
) -> None:
    """Shorten the beams from ``pose`` that end on the footprint of the robot in a row."""
    robot = worlds.robots[row]
    body = worlds.bodies[robot.kind]
    reach = device.beams.range_max + body.radius
    if (robot.x - pose[0]) ** 2 + (robot.y - pose[1]) ** 2 > reach * reach:
        return
    if body.corners == 1:
        cast_disc(pose, device.beams, (robot.x, robot.y, body.rounding), ranges)
    else:
        place_outline(worlds.outline, body, robot)
        cast_segments(pose, device.beams, worlds.outline[: body.corners], ranges)


@inner
def add_scan_noise(device: Scanner, robot: Row, tick: int, ranges: NDArray[np.float32]) -> None:
    """Add Gaussian noise to what was hit; what is nearer than the minimum range reads as the minimum range."""
    if device.noise_std > 0.0:
        fill_normals(robot.scan_key, tick, device.normals)
    for i in range(len(ranges)):
        if ranges[i] < math.inf:
            ranges[i] = min(
                max(ranges[i] + device.noise_std * device.normals[i], device.range_min), device.beams.range_max
            )
