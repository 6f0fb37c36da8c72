"""The two movers of a tick: people step, then the robot drives; neither ever ends up inside another body."""

from __future__ import annotations

import math

from arena_kernels.compiled import inner
from arena_kernels.footprint import disc_like, gap_to_disc, place_body
from arena_kernels.motion import ACKERMANN, Chassis, Position, Velocity, drive_arc, in_map, next_velocity
from arena_sim2d.bodies import Floats, Row, World
from arena_sim2d.clearances import gap_of_person, gap_to_people, gap_to_team, gap_to_things, is_clear
from arena_sim2d.contact import TOLERANCE, member_world, note_contact, note_overlaps

HALVINGS = 8  # of a blocked motion: the fastest robot then stops within 0.1 mm of what it meets


@inner
def move_people(world: World, tick: int, dt: float) -> None:
    """Let each person go its way of a tick, kept out of walls, obstacles and robots."""
    robot = world.robots[world.k]
    place_body(world.body, robot.x, robot.y, robot.theta)
    for i in range(robot.people):
        person = world.people[i]
        if person.dx == 0.0 and person.dy == 0.0:
            continue
        x, y, free = person.x + person.dx, person.y + person.dy, True
        if person.alone:
            person.x, person.y = x, y
            continue
        if not person.through_walls and not is_clear(world, x, y, person.radius):
            x, y, free = _slide_off_obstacles(world, person)
        near = world.body.radius + person.radius
        if world.team > 1:
            x, y, free = _slide_off_team(world, i, tick, dt, (x, y, free))
        elif free and (x - robot.x) ** 2 + (y - robot.y) ** 2 < near * near:
            x, y, free = _slide_off_robot(world, i, tick, dt, x, y)
        if free:
            person.x, person.y = x, y
        else:
            person.vx, person.vy = 0.0, 0.0


@inner
def _slide_off_obstacles(world: World, person: Row) -> tuple[float, float, bool]:
    """Return where a person's way of a tick ends, sliding along what stands there; False if there is no room."""
    body = disc_like(world.person, person.radius)
    x, y = person.x + person.dx, person.y + person.dy
    before = 0.0
    for attempt in range(2):
        place_body(body, x, y, 0.0)
        gap = gap_of_person(world, body, before - TOLERANCE)
        if gap[0] == math.inf:
            return x, y, True
        if attempt == 0:
            place_body(body, person.x, person.y, 0.0)
            # some published scenarios place people in walls: they may walk out
            before = min(gap_of_person(world, body, 0.0)[0], 0.0)
            if gap[0] < before:
                _remove_component(person, gap[1], gap[2])
                x, y = x + gap[0] * gap[1], y + gap[0] * gap[2]
    return x, y, False


@inner
def _slide_off_robot(world: World, i: int, tick: int, dt: float, x: float, y: float) -> tuple[float, float, bool]:
    """Return where person i ends that wants to be at (x, y), sliding along the robot; False if there is no room."""
    robot, person = world.robots[world.k], world.people[i]
    gap = gap_to_disc(world.body, x, y, person.radius)
    if gap[0] >= 0.0:
        return x, y, True
    velocity = in_map(robot.theta, (robot.vx, robot.vy, robot.wz))
    note_contact(world, tick, world.first_person + i, gap, velocity, person.dx / dt, person.dy / dt)
    _remove_component(person, -gap[1], -gap[2])
    x, y = x + (TOLERANCE - gap[0]) * gap[1], y + (TOLERANCE - gap[0]) * gap[2]
    body = disc_like(world.person, person.radius)
    place_body(body, x, y, 0.0)
    free = gap_to_disc(world.body, x, y, person.radius)[0] >= 0.0
    if not person.through_walls:
        free &= gap_of_person(world, body, -TOLERANCE)[0] == math.inf
    return x, y, free


@inner
def _slide_off_team(
    world: World, i: int, tick: int, dt: float, wanted: tuple[float, float, bool]
) -> tuple[float, float, bool]:
    """Return where person i ends that wants to be somewhere, sliding along each robot that it meets; False if it has no
    room between them.
    """
    x, y, free = wanted
    person, slid = world.people[i], False
    for row in range(world.first, world.first + world.team):
        robot, body = world.robots[row], world.bodies[world.robots[row].kind]
        near = body.radius + person.radius
        if free and not robot.absent and (x - robot.x) ** 2 + (y - robot.y) ** 2 < near * near:
            place_body(body, robot.x, robot.y, robot.theta)
            before = (x, y)
            x, y, free = _slide_off_robot(member_world(world, row), i, tick, dt, x, y)
            slid |= x != before[0] or y != before[1]
    for row in range(world.first, world.first + world.team):
        robot, body = world.robots[row], world.bodies[world.robots[row].kind]
        near = body.radius + person.radius
        if slid and free and not robot.absent and (x - robot.x) ** 2 + (y - robot.y) ** 2 < near * near:
            place_body(body, robot.x, robot.y, robot.theta)
            free = gap_to_disc(body, x, y, person.radius)[0] >= 0.0
    return x, y, free


@inner
def _remove_component(person: Row, nx: float, ny: float) -> None:
    """Take away the part of a person's velocity that points along the unit vector (nx, ny)."""
    inward = max(person.vx * nx + person.vy * ny, 0.0)
    person.vx -= inward * nx
    person.vy -= inward * ny


@inner
def move_robot(world: World, chassis: Chassis, tick: int, command: Floats, dt: float, free: bool) -> None:
    """Drive the robot for a tick; a motion that would end in another body is cut short; all but cars may still turn on
    the spot.

    ``free`` says that the robot surely meets nothing.
    """
    robot = world.robots[world.k]
    pose = (robot.x, robot.y, robot.theta)
    velocity = next_velocity(chassis, robot.speed_share, (robot.vx, robot.vy, robot.wz), command, dt)
    turn = (0.0, 0.0, 0.0 if chassis.kinematics == ACKERMANN else velocity[2])
    if velocity[0] == 0.0 and velocity[1] == 0.0 and velocity[2] == 0.0:
        _set_motion(robot, pose, velocity)
        return
    there = drive_arc(pose, velocity, dt)
    if free or _is_free(world, there):
        _set_motion(robot, there, velocity)
    else:
        known = robot.contacts
        note_overlaps(world, tick, in_map(pose[2], velocity))
        share = _free_share(world, pose, velocity, dt) if robot.contacts > known else 0.0
        if share > 0.0:
            _set_motion(robot, drive_arc(pose, velocity, share * dt), turn)
        elif turn[2] != 0.0 and (world.body.corners == 1 or _is_free(world, drive_arc(pose, turn, dt))):
            _set_motion(robot, drive_arc(pose, turn, dt), turn)
        else:
            _set_motion(robot, pose, (0.0, 0.0, 0.0))


@inner
def _set_motion(robot: Row, pose: Position, velocity: Velocity) -> None:
    robot.x, robot.y, robot.theta = pose
    robot.vx, robot.vy, robot.wz = velocity


@inner
def _is_free(world: World, pose: Position) -> bool:
    """Return whether the robot's body would overlap nothing at a pose; it is put there."""
    place_body(world.body, pose[0], pose[1], pose[2])
    alone = (
        is_clear(world, pose[0], pose[1], world.body.radius)
        or gap_to_things(world, world.body, -TOLERANCE)[0] == math.inf
    )
    alone = alone and gap_to_people(world, world.body, -TOLERANCE) == -TOLERANCE
    return alone and gap_to_team(world, world.body, -TOLERANCE) == -TOLERANCE


@inner
def _free_share(world: World, pose: Position, velocity: Velocity, dt: float) -> float:
    """Return how much of a motion that ends in a body is free, by bisection."""
    low, high = 0.0, 1.0
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        if _is_free(world, drive_arc(pose, velocity, middle * dt)):
            low = middle
        else:
            high = middle
    return low
