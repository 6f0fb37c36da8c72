"""Steps of a robot's brain on made-up sensors, so that its kernels are compiled before it drives."""

from __future__ import annotations

import math

import numpy as np

from arena_core.loop.guide import Mission
from arena_core.loop.navigator import Navigator
from arena_core.values.geometry import Pose, Twist
from arena_core.values.sensing import LaserScan, Odometry, Sensors
from arena_core.values.world import OccupancyGrid

SIDE, RESOLUTION = 10.0, 0.05  # m, of the empty room
STRIDE = 0.3  # m from step to step: a filter that waits for the robot to move updates
STEPS = 3


def warm_up(navigator: Navigator, *, known: bool, tracks: bool = False) -> None:
    """Let a navigator go a few steps across an empty room; a planner that does not compile is not asked.

    ``tracks`` has people followed in any case, for those who show them. Raises what its parts raise. The next ``reset``
    forgets all but compiled code, as it does after an episode.
    """
    mission = Mission(walled_room() if known else None, Pose(-2.0, 0.0), Pose(2.0, 0.0), 0.3, 0, "rehearsal")
    navigator.reset(mission)
    for step in range(STEPS):
        sensors = _sample_sensors(navigator, step)
        if navigator.planner.compiles:
            navigator.decide(sensors)
        else:
            navigator.look(sensors).local_map()
    for step in range(STEPS, 2 * STEPS) if tracks else ():
        if (found := navigator.look(_sample_sensors(navigator, step)).tracks) is not None:
            found()


def walled_room(side: float = SIDE, resolution: float = RESOLUTION) -> OccupancyGrid:
    """Return a square room, walled, its centre at the origin of ``map``."""
    n = round(side / resolution)
    data = np.zeros((n, n), np.int8)
    data[[0, -1], :] = data[:, [0, -1]] = 100
    return OccupancyGrid(data, resolution, Pose(-side / 2, -side / 2, 0.0))


def _sample_sensors(navigator: Navigator, step: int) -> Sensors:
    """Return what the sensors would show of the room, but for a wall of the same distance all round."""
    lidar, stamp = navigator.robot.lidar, step * navigator.control_period
    away = min(0.5 * lidar.range_max, 0.4 * SIDE)
    ranges = np.full(lidar.beams, away, np.float32)
    ranges[::7] = math.inf
    pose = Pose(-2.0 + STRIDE * step, 0.0)
    scan = LaserScan(
        stamp, lidar.angle_min, lidar.angle_increment, lidar.range_min, lidar.range_max, ranges, lidar.mount
    )
    return Sensors(stamp, scan, Odometry(stamp, pose, Twist(STRIDE / navigator.control_period)), pose)
