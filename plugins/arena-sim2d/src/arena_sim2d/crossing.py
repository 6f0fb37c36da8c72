"""The two movers of a tick: people step, then the robot drives; neither ever ends up inside another body."""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from arena_kernels.footprint import gap_to_disc, place
from arena_sim2d.bodies import Chassis, Floats, People, Robots, Touch
from arena_sim2d.contact import TOLERANCE, record, record_overlaps, robot_gap
from arena_sim2d.gaps import gap_to_things
from arena_sim2d.motion import Velocity, drive, next_velocity
from arena_sim2d.scene import Scene

TOUCHING = 1e-3  # m; a robot that is this close to what blocks it does not try a part of its motion
HALVINGS = 8  # of a blocked motion: the fastest robot then stops within 0.1 mm of what it meets


@njit(cache=True)
def move_people(
    scene: Scene, chassis: Chassis, robots: Robots, people: People, touch: Touch, k: int, tick: int, dt: float, hull: Floats
) -> None:
    """Let each person of world k take its stride, kept out of walls, obstacles and the robot, whose outline lies in ``hull``."""
    body = np.empty((1, 2))
    for i in range(people.counts[k]):
        dx, dy = people.strides[k, i, 0], people.strides[k, i, 1]
        if dx == 0.0 and dy == 0.0:
            continue
        from_x, from_y = people.positions[k, i, 0], people.positions[k, i, 1]
        x, y, free = _out_of_things(scene, people, k, i, body, from_x + dx, from_y + dy)
        if free and math.hypot(x - robots.poses[k, 0], y - robots.poses[k, 1]) < chassis.radius + people.radii[k, i]:
            x, y, free = _off_the_robot(scene, chassis, robots, people, touch, k, i, tick, dt, body, hull, x, y)
        if free:
            people.positions[k, i, 0], people.positions[k, i, 1] = x, y
        else:
            people.velocities[k, i] = 0.0


@njit(cache=True)
def _out_of_things(scene: Scene, people: People, k: int, i: int, body: Floats, x: float, y: float) -> tuple[float, float, bool]:
    """Return where person i ends that wants to be at (x, y), sliding along what stands there; False if there is no room."""
    radius = people.radii[k, i]
    body[0, 0], body[0, 1] = x, y
    gap = gap_to_things(scene, k, body, radius, x, y, radius, 0.0)
    if gap[0] >= -TOLERANCE:
        return x, y, True
    body[0] = people.positions[k, i]
    before = gap_to_things(scene, k, body, radius, body[0, 0], body[0, 1], radius, 0.0)[0]
    if gap[0] >= before:
        return x, y, True  # already in it, as some published scenarios place people: let them walk out
    _stop_into(people, k, i, gap[1], gap[2])
    x, y = x + gap[0] * gap[1], y + gap[0] * gap[2]
    body[0, 0], body[0, 1] = x, y
    return x, y, gap_to_things(scene, k, body, radius, x, y, radius, 0.0)[0] >= min(before, 0.0) - TOLERANCE


@njit(cache=True)
def _off_the_robot(
    scene: Scene,
    chassis: Chassis,
    robots: Robots,
    people: People,
    touch: Touch,
    k: int,
    i: int,
    tick: int,
    dt: float,
    body: Floats,
    hull: Floats,
    x: float,
    y: float,
) -> tuple[float, float, bool]:
    """Return where person i ends that wants to be at (x, y), sliding along the robot; False if there is no room."""
    radius = people.radii[k, i]
    gap = gap_to_disc(hull, chassis.rounding, x, y, radius)
    if gap[0] >= 0.0:
        return x, y, True
    vx, vy = people.strides[k, i, 0] / dt, people.strides[k, i, 1] / dt
    rx, ry, theta = robots.poses[k, 0], robots.poses[k, 1], robots.poses[k, 2]
    motion = _in_map(theta, (robots.velocities[k, 0], robots.velocities[k, 1], robots.velocities[k, 2]))
    record(touch, k, tick, touch.first_person + i, people.ids[k, i], gap, rx, ry, motion, vx, vy)
    _stop_into(people, k, i, -gap[1], -gap[2])
    out = TOLERANCE - gap[0]
    x, y = x + out * gap[1], y + out * gap[2]
    if gap_to_disc(hull, chassis.rounding, x, y, radius)[0] < 0.0:
        return x, y, False
    body[0, 0], body[0, 1] = x, y
    return x, y, gap_to_things(scene, k, body, radius, x, y, radius, 0.0)[0] >= -TOLERANCE


@njit(cache=True)
def _stop_into(people: People, k: int, i: int, nx: float, ny: float) -> None:
    """Take away the part of a person's velocity that points along the unit vector (nx, ny)."""
    inward = people.velocities[k, i, 0] * nx + people.velocities[k, i, 1] * ny
    if inward > 0.0:
        people.velocities[k, i, 0] -= inward * nx
        people.velocities[k, i, 1] -= inward * ny


@njit(cache=True)
def move_robot(
    scene: Scene,
    chassis: Chassis,
    robots: Robots,
    people: People,
    touch: Touch,
    k: int,
    tick: int,
    command: Floats,
    dt: float,
    hull: Floats,
) -> None:
    """Drive robot k for a tick; a motion that would end in another body is cut short, and the robot may still turn on the spot."""
    velocity = next_velocity(chassis, robots.velocities[k], command, dt)
    if velocity[0] == 0.0 and velocity[1] == 0.0 and velocity[2] == 0.0:
        robots.velocities[k] = 0.0
        return
    x, y, theta = robots.poses[k, 0], robots.poses[k, 1], robots.poses[k, 2]
    if _is_free(scene, chassis, people, k, hull, drive(x, y, theta, velocity, dt)):
        _settle(robots, k, drive(x, y, theta, velocity, dt), velocity)
        return
    record_overlaps(scene, chassis, people, touch, k, tick, hull, drive(x, y, theta, velocity, dt), _in_map(theta, velocity))
    share = _free_share(scene, chassis, people, k, hull, (x, y, theta), velocity, dt)
    if share > 0.0:
        _settle(robots, k, drive(x, y, theta, velocity, share * dt), (0.0, 0.0, velocity[2]))
        return
    turn = (0.0, 0.0, velocity[2])
    if velocity[2] != 0.0 and _is_free(scene, chassis, people, k, hull, drive(x, y, theta, turn, dt)):
        _settle(robots, k, drive(x, y, theta, turn, dt), turn)
    else:
        _settle(robots, k, (x, y, theta), (0.0, 0.0, 0.0))


@njit(cache=True)
def _is_free(scene: Scene, chassis: Chassis, people: People, k: int, hull: Floats, pose: Velocity) -> bool:
    place(chassis.vertices, pose[0], pose[1], pose[2], hull)
    return robot_gap(scene, chassis, people, k, hull, pose[0], pose[1], 0.0) >= -TOLERANCE


@njit(cache=True)
def _free_share(
    scene: Scene, chassis: Chassis, people: People, k: int, hull: Floats, pose: Velocity, velocity: Velocity, dt: float
) -> float:
    """Return how much of a blocked motion is free, by bisection; 0 when the robot already is where it is blocked."""
    place(chassis.vertices, pose[0], pose[1], pose[2], hull)
    if robot_gap(scene, chassis, people, k, hull, pose[0], pose[1], TOUCHING) < TOUCHING:
        return 0.0
    low, high = 0.0, 1.0
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        if _is_free(scene, chassis, people, k, hull, drive(pose[0], pose[1], pose[2], velocity, middle * dt)):
            low = middle
        else:
            high = middle
    return low


@njit(cache=True)
def _settle(robots: Robots, k: int, pose: Velocity, velocity: Velocity) -> None:
    for axis in range(3):
        robots.poses[k, axis] = pose[axis]
        robots.velocities[k, axis] = velocity[axis]


@njit(cache=True)
def _in_map(theta: float, velocity: Velocity) -> Velocity:
    c, s = math.cos(theta), math.sin(theta)
    return c * velocity[0] - s * velocity[1], s * velocity[0] + c * velocity[1], velocity[2]
