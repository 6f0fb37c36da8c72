"""Trajectories at constant velocity: circular arcs, followed without trigonometry from one pose to the next."""

from __future__ import annotations

import math

import numpy as np

from arena_dwa.columns import TURN_COSINE, TURN_SINE
from arena_dwa.settings import FloatArray
from arena_kernels.compiled import borrowing, compiled

PlanarPose = tuple[float, float, float, float]  # x, y (m, map) and cosine and sine of the heading


@borrowing
def planar_pose(x: float, y: float, theta: float) -> PlanarPose:
    """Return a pose with its heading as cosine and sine."""
    return x, y, math.cos(theta), math.sin(theta)


@borrowing
def pose_after_arc(vx: float, vy: float, wz: float, time: float) -> PlanarPose:
    """Return the pose after ``time`` s at constant velocity, seen from where it began (Fox,
    Burgard, Thrun 1997, eq. 10-12).
    """
    turn = wz * time
    return pose_from_turn(vx, vy, wz, time, math.cos(turn), math.sin(turn))


@compiled
def turn_rotations(speeds: FloatArray, time: float) -> FloatArray:
    """Return cosine and sine (K, 2) of how far turning speeds (K,) turn in ``time`` s."""
    turns = np.empty((len(speeds), 2))
    for k in range(len(speeds)):
        turns[k, TURN_COSINE], turns[k, TURN_SINE] = math.cos(speeds[k] * time), math.sin(speeds[k] * time)
    return turns


@borrowing
def pose_from_turn(vx: float, vy: float, wz: float, time: float, c: float, s: float) -> PlanarPose:
    """Return the pose at the end of an arc whose turn has this cosine and sine."""
    if abs(wz * time) < 1e-6:
        return vx * time, vy * time, c, s
    return (vx * s - vy * (1.0 - c)) / wz, (vx * (1.0 - c) + vy * s) / wz, c, s


@borrowing
def compose_poses(stand: PlanarPose, step: PlanarPose) -> PlanarPose:
    """Return the pose that ``step``, seen from ``stand``, has in the frame of ``stand``."""
    x, y, c, s = stand
    along, aside, turn_c, turn_s = step
    return x + c * along - s * aside, y + s * along + c * aside, c * turn_c - s * turn_s, s * turn_c + c * turn_s
