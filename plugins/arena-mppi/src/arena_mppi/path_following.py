"""A guide for a robot that stands: the controls that would follow the path at a creep, to sample round.

Through a gap little wider than the robot hardly one of two thousand random sequences leads (after Trevisan and
Alonso-Mora, Biased-MPPI, IEEE Robotics and Automation Letters 9(6), 2024, whose ancillary controllers add such
samples).
"""

from __future__ import annotations

import math

import numpy as np

from arena_mppi.critics import SPACING
from arena_mppi.parameters import Chassis, Floats, Scene

CREEP = 0.2  # m/s, at most, of a robot that stands
AHEAD = 0.1  # m along the path that the guide looks
TURN_FIRST = 0.4  # rad; a path that lies farther aside is first turned to
GAIN = 3.0  # 1/s, by which times its bearing the robot turns to a point
ASIDE = np.arange(-5, 6) * 0.02  # m, how far a point of the path may be moved to where there is more room
ROOM = 0.3  # m beyond the robot's radius; more room is not looked for
STAYING = 0.1  # m of room that a metre aside is worth


def follow_path(
    scene: Scene, radius: float, chassis: Chassis, state: Floats, speed: float, dt: float, steps: int
) -> Floats:
    """Return velocities (T, 3) that lead a robot of ``radius`` (m) from the origin along the middle of the way, at
    ``speed`` m/s at most.

    ``state`` is cosine and sine of its heading, vx, vy, wz; ``dt`` in s. They change no faster than the robot's can.
    """
    path, x, y, place = center_path(scene, radius), 0.0, 0.0, 0
    heading, velocity = math.atan2(state[1], state[0]), state[2:].astype(np.float64)
    change = np.array((chassis.vx_change, chassis.vy_change, chassis.wz_change), np.float64)
    ahead, out = round(AHEAD / float(SPACING)), np.zeros((steps, 3), np.float32)
    for t in range(steps):
        place = _nearest_index(path, place, x, y)
        target_x, target_y = path[min(place + ahead, len(path) - 1)].tolist()
        bearing = math.remainder(math.atan2(target_y - y, target_x - x) - heading, 2.0 * math.pi)
        wanted = _velocity_towards(bearing, speed * min(1.0, math.hypot(target_x - x, target_y - y) / AHEAD), chassis)
        velocity += np.clip(np.array(wanted) - velocity, -change, change)
        out[t] = velocity
        vx, vy, wz = velocity.tolist()
        heading += wz * dt
        x, y = (
            x + dt * (vx * math.cos(heading) - vy * math.sin(heading)),
            y + dt * (vx * math.sin(heading) + vy * math.cos(heading)),
        )
    return out


def center_path(scene: Scene, radius: float) -> Floats:
    """Return the scene's path (M, 2) with every point moved aside to where a robot of ``radius`` (m) has room."""
    path = scene.path
    if len(path) < 2:
        return path
    along = np.gradient(path, axis=0)
    normals = np.column_stack((-along[:, 1], along[:, 0])) / np.maximum(np.hypot(*along.T), 1e-6)[:, None]
    places = path[:, None] + ASIDE[:, None] * normals[:, None]
    room = np.minimum(gaps_at(scene, places) - radius, ROOM) - STAYING * np.abs(ASIDE)
    return np.asarray(places[np.arange(len(path)), room.argmax(axis=1)], np.float32)


def gaps_at(scene: Scene, places: Floats) -> Floats:
    """Return the distance to the nearest lethal cell's edge at ``places`` (..., 2), m, interpolated; at the
    window's edge the edge's.
    """
    rows, columns = scene.gaps.shape
    u = np.clip((places[..., 0] - scene.gaps_x) / scene.gaps_resolution - 0.5, 0.0, columns - 1.001)
    v = np.clip((places[..., 1] - scene.gaps_y) / scene.gaps_resolution - 0.5, 0.0, rows - 1.001)
    j, i = u.astype(int), v.astype(int)
    below = scene.gaps[i, j] * (1.0 - u + j) + scene.gaps[i, j + 1] * (u - j)
    above = scene.gaps[i + 1, j] * (1.0 - u + j) + scene.gaps[i + 1, j + 1] * (u - j)
    return np.asarray(below * (1.0 - v + i) + above * (v - i))


def _nearest_index(path: Floats, first: int, x: float, y: float) -> int:
    rest = path[first : first + 8]
    return first + int(np.argmin((rest[:, 0] - x) ** 2 + (rest[:, 1] - y) ** 2))


def _velocity_towards(bearing: float, speed: float, chassis: Chassis) -> tuple[float, float, float]:
    """Return the velocity towards a point at ``bearing`` (rad): sideways where the robot can, else turning first."""
    wz_max, vx_max, vy_max = float(chassis.wz_max), float(chassis.vx_max), float(chassis.vy_max)
    wz = min(max(GAIN * bearing, -wz_max), wz_max)
    if vy_max > 0.0:
        return speed * math.cos(bearing), min(vy_max, speed) * math.sin(bearing), 0.0
    if chassis.turn_at_rest <= 0.0:  # a car
        tightest = float(chassis.curvature) * speed
        return min(speed, vx_max), 0.0, min(max(wz, -tightest), tightest)
    return min(speed, vx_max) * max(0.0, 1.0 - abs(bearing) / TURN_FIRST), 0.0, wz
