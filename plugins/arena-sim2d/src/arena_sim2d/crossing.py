"""The two movers of a tick: people step, then the robot drives; neither ever ends up inside another body."""

from __future__ import annotations

import math

from arena_kernels.compiled import borrowing
from arena_kernels.footprint import Body, disc_like, gap_to_disc, place
from arena_sim2d.bodies import Floats, Moving, People
from arena_sim2d.contact import TOLERANCE, record, record_overlaps
from arena_sim2d.gaps import gap_to_people, gap_to_things
from arena_sim2d.motion import Position, Velocity, drive, next_velocity

TOUCHING = 1e-3  # m; a robot that is this close to what blocks it does not try a part of its motion
HALVINGS = 8  # of a blocked motion: the fastest robot then stops within 0.1 mm of what it meets


@borrowing
def move_people(world: Moving, k: int, tick: int, dt: float) -> None:
    """Let each person of world k take its stride, kept out of walls, obstacles and the robot."""
    people, robot = world.people, world.robots.poses[k]
    place(world.body, robot[0], robot[1], robot[2])
    for i in range(people.counts[k]):
        dx, dy = people.strides[k, i, 0], people.strides[k, i, 1]
        if dx == 0.0 and dy == 0.0:
            continue
        body = disc_like(world.person, people.radii[k, i])
        x, y, free = _out_of_things(world, k, i, body, people.positions[k, i, 0] + dx, people.positions[k, i, 1] + dy)
        if free and math.sqrt((x - robot[0]) ** 2 + (y - robot[1]) ** 2) < world.body.radius + body.radius:
            x, y, free = _off_the_robot(world, k, i, tick, dt, body, x, y)
        if free:
            people.positions[k, i, 0], people.positions[k, i, 1] = x, y
        else:
            people.velocities[k, i, 0], people.velocities[k, i, 1] = 0.0, 0.0


@borrowing
def _out_of_things(world: Moving, k: int, i: int, body: Body, x: float, y: float) -> tuple[float, float, bool]:
    """Return where person i ends that wants to be at (x, y), sliding along what stands there; False if there is no room."""
    place(body, x, y, 0.0)
    gap = gap_to_things(world.scene, k, body, -TOLERANCE)
    if gap[0] >= 0.0:
        return x, y, True
    place(body, world.people.positions[k, i, 0], world.people.positions[k, i, 1], 0.0)
    before = gap_to_things(world.scene, k, body, 0.0)[0]
    if gap[0] >= before:
        return x, y, True  # already in it, as some published scenarios place people: let them walk out
    _stop_into(world.people, k, i, gap[1], gap[2])
    x, y = x + gap[0] * gap[1], y + gap[0] * gap[2]
    place(body, x, y, 0.0)
    return x, y, gap_to_things(world.scene, k, body, min(before, 0.0) - TOLERANCE)[0] == math.inf


@borrowing
def _off_the_robot(world: Moving, k: int, i: int, tick: int, dt: float, body: Body, x: float, y: float) -> tuple[float, float, bool]:
    """Return where person i ends that wants to be at (x, y), sliding along the robot; False if there is no room."""
    people, robots = world.people, world.robots
    gap = gap_to_disc(world.body, x, y, body.radius)
    if gap[0] >= 0.0:
        return x, y, True
    velocity = in_map(robots.poses[k, 2], (robots.velocities[k, 0], robots.velocities[k, 1], robots.velocities[k, 2]))
    vx, vy = people.strides[k, i, 0] / dt, people.strides[k, i, 1] / dt
    record(world, k, tick, world.touch.first_person + i, people.ids[k, i], gap, velocity, vx, vy)
    _stop_into(people, k, i, -gap[1], -gap[2])
    x, y = x + (TOLERANCE - gap[0]) * gap[1], y + (TOLERANCE - gap[0]) * gap[2]
    if gap_to_disc(world.body, x, y, body.radius)[0] < 0.0:
        return x, y, False
    place(body, x, y, 0.0)
    return x, y, gap_to_things(world.scene, k, body, -TOLERANCE)[0] == math.inf


@borrowing
def _stop_into(people: People, k: int, i: int, nx: float, ny: float) -> None:
    """Take away the part of a person's velocity that points along the unit vector (nx, ny)."""
    inward = people.velocities[k, i, 0] * nx + people.velocities[k, i, 1] * ny
    if inward > 0.0:
        people.velocities[k, i, 0] -= inward * nx
        people.velocities[k, i, 1] -= inward * ny


@borrowing
def move_robot(world: Moving, k: int, tick: int, command: Floats, dt: float) -> None:
    """Drive robot k for a tick; a motion that would end in another body is cut short, and the robot may still turn on the spot."""
    robots = world.robots
    pose = (robots.poses[k, 0], robots.poses[k, 1], robots.poses[k, 2])
    velocity = next_velocity(world.chassis, robots.velocities[k], command, dt)
    turn = (0.0, 0.0, velocity[2])
    if velocity[0] == 0.0 and velocity[1] == 0.0 and velocity[2] == 0.0:
        _settle(world, k, pose, velocity)
    elif _is_free(world, k, drive(pose, velocity, dt)):
        _settle(world, k, drive(pose, velocity, dt), velocity)
    else:
        record_overlaps(world, k, tick, in_map(pose[2], velocity))
        share = _free_share(world, k, pose, velocity, dt)
        if share > 0.0:
            _settle(world, k, drive(pose, velocity, share * dt), turn)
        elif _is_free(world, k, drive(pose, turn, dt)):
            _settle(world, k, drive(pose, turn, dt), turn)
        else:
            _settle(world, k, pose, (0.0, 0.0, 0.0))


@borrowing
def _is_free(world: Moving, k: int, pose: Position) -> bool:
    """Tell whether robot k would overlap nothing at a pose."""
    return _gap_at(world, k, pose, -TOLERANCE) == math.inf


@borrowing
def _gap_at(world: Moving, k: int, pose: Position, within: float) -> float:
    place(world.body, pose[0], pose[1], pose[2])
    return min(gap_to_things(world.scene, k, world.body, within)[0], gap_to_people(world.people, k, world.body, within))


@borrowing
def _free_share(world: Moving, k: int, pose: Position, velocity: Velocity, dt: float) -> float:
    """Return how much of a blocked motion is free, by bisection; 0 when the robot already is where it is blocked."""
    if _gap_at(world, k, pose, TOUCHING) < math.inf:
        return 0.0
    low, high = 0.0, 1.0
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        if _is_free(world, k, drive(pose, velocity, middle * dt)):
            low = middle
        else:
            high = middle
    return low


@borrowing
def _settle(world: Moving, k: int, pose: Position, velocity: Velocity) -> None:
    poses, velocities = world.robots.poses, world.robots.velocities
    poses[k, 0], poses[k, 1], poses[k, 2] = pose
    velocities[k, 0], velocities[k, 1], velocities[k, 2] = velocity


@borrowing
def in_map(theta: float, velocity: Velocity) -> Velocity:
    """Turn a velocity from ``base_link`` to ``map``."""
    c, s = math.cos(theta), math.sin(theta)
    return c * velocity[0] - s * velocity[1], s * velocity[0] + c * velocity[1], velocity[2]
