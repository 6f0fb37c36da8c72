"""Whom a lidar sees."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from arena_core import LaserScan, Robot
from arena_core.records import WorldState

WITHIN = 1.5  # of a body's radius: so near to its middle a beam that hits it ends


def seen_people(state: WorldState, scan: LaserScan, robot: Robot) -> NDArray[np.int64]:
    """Return the rows of the people on whom a beam of the scan ends."""
    lidar = state.pose.compose(robot.lidar.mount)
    offsets, radii = state.pedestrians.positions - (lidar.x, lidar.y), state.pedestrians.radii
    away = np.hypot(offsets[:, 0], offsets[:, 1])
    bearings = np.arctan2(offsets[:, 1], offsets[:, 0]) - lidar.theta
    beams = scan.angle_min + scan.angle_increment * np.arange(len(scan.ranges))
    off = np.abs((beams - bearings[:, None] + np.pi) % (2.0 * np.pi) - np.pi)
    towards = off <= np.arcsin(np.minimum(radii / np.maximum(away, radii), 1.0))[:, None]
    ends_there = np.abs(scan.ranges - away[:, None]) <= WITHIN * radii[:, None]
    return np.flatnonzero((towards & ends_there).any(axis=1))  # who is absent is at NaN: no beam ends there


def slow_where_blind(robot: Robot, speed: float) -> Robot:
    """Return the robot with no more than ``speed`` (m/s) backwards where its lidar does not see what is behind."""
    last = robot.lidar.angle_min + robot.lidar.angle_increment * (robot.lidar.beams - 1)
    if last - robot.lidar.angle_min >= 2.0 * math.pi - 2.0 * robot.lidar.angle_increment:
        return robot
    return replace(robot, limits=replace(robot.limits, vx_min=max(robot.limits.vx_min, -speed)))
