"""The discrete velocities that are chosen from."""

from __future__ import annotations

import math

import numpy as np

from arena_cadrl.parameters import ActionSettings, Floats
from arena_core import Robot
from arena_policies.actions import ActionRange


def discrete_velocities(robot: Robot, range_: ActionRange, choosing: ActionSettings) -> Floats:
    """Return velocities (A, 3): of robots that cannot go sideways in ``base_link``; of others (speed, direction from
    the target, 0).

    The first one stands still.
    """
    limits = robot.limits_with(vx_min=range_.vx_min, vx_max=range_.vx_max, vy_max=range_.vy_max, wz_max=range_.wz_max)
    if robot.holonomic:
        angles = [2.0 * math.pi * k / choosing.directions for k in range(choosing.directions)]
        return np.array(
            [(0.0, 0.0, 0.0), *((share * limits.vx_max, angle, 0.0) for share in choosing.speeds for angle in angles)]
        )
    forwards = [
        (share * limits.vx_max, 0.0, turn * limits.wz_max)
        for share in (0.0, *choosing.speeds)
        for turn in choosing.turns
    ]
    backwards = [(limits.vx_min, 0.0, turn * limits.wz_max) for turn in choosing.backing_turns if limits.vx_min < 0.0]
    return np.array([(0.0, 0.0, 0.0), *(each for each in (*forwards, *backwards) if any(each))])


def velocity_commands(
    kinds: Floats, robot: Robot, vy_max: float, wz_max: float, theta: float, bearing: float
) -> Floats:
    """Return the commands (A, 3) in ``base_link`` for velocities (A, 3), a robot's heading and the target's direction
    in ``map``, rad.

    A robot that can go sideways turns its front, where its scanner looks, to the target; its direction holds in the
    middle of a period.
    """
    if not robot.holonomic:
        return kinds
    off = math.remainder(bearing - theta, 2.0 * math.pi)
    turn = math.copysign(min(wz_max, math.sqrt(robot.limits.alpha_max * abs(off)), 2.0 * abs(off)), off)
    angles = kinds[:, 1] + off - 0.5 * turn * robot.control_period
    along, across = kinds[:, 0] * np.cos(angles), kinds[:, 0] * np.sin(angles)
    return np.column_stack((along, np.clip(across, -vy_max, vy_max), np.full(len(kinds), turn)))
