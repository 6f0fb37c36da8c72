"""Who touches whom: overlaps of the robot, the rising edges of contact, and when a contact ends."""

from __future__ import annotations

import math

from numba import njit

from arena_kernels.footprint import NOTHING, Gap, gap_to_cells, gap_to_disc
from arena_sim2d.bodies import Chassis, Floats, People, Touch
from arena_sim2d.gaps import gap_to_obstacle, gap_to_people, gap_to_things, obstacle_count, obstacle_may_be_within
from arena_sim2d.scene import Scene

TOLERANCE = 1e-9  # m; an overlap below this is rounding
RELEASE = 0.01  # m; a contact ends when the gap is wider, so that one long touch is one event
MOVING = 0.01  # m/s; a robot that approaches more slowly than this did not cause the contact


@njit(cache=True)
def robot_gap(scene: Scene, chassis: Chassis, people: People, k: int, hull: Floats, x: float, y: float, within: float) -> float:
    """Return the least gap between robot k, its outline placed in ``hull``, and anything; beyond ``within`` it may be any larger one."""
    gap = gap_to_things(scene, k, hull, chassis.rounding, x, y, chassis.radius, within)[0]
    return min(gap, gap_to_people(people.counts[k], people.positions[k], people.radii[k], hull, chassis.rounding, x, y, chassis.radius))


@njit(cache=True)
def record_overlaps(
    scene: Scene,
    chassis: Chassis,
    people: People,
    touch: Touch,
    k: int,
    tick: int,
    hull: Floats,
    pose: tuple[float, float, float],
    motion: tuple[float, float, float],
) -> None:
    """Note a contact with everything that the outline in ``hull`` overlaps; ``motion`` is the velocity in ``map`` that led there."""
    x, y = pose[0], pose[1]
    gap = gap_to_cells(scene.stack, scene.grid_of[k], hull, chassis.rounding, x, y, chassis.radius, 0.0)
    if gap[0] < -TOLERANCE:
        record(touch, k, tick, 0, -1, gap, x, y, motion, 0.0, 0.0)
    for index in range(obstacle_count(scene.obstacles, k)):
        if obstacle_may_be_within(scene.obstacles, k, index, x, y, chassis.radius):
            gap = gap_to_obstacle(scene.obstacles, k, index, hull, chassis.rounding)
            if gap[0] < -TOLERANCE:
                record(touch, k, tick, 1 + index, -1, gap, x, y, motion, 0.0, 0.0)
    for i in range(people.counts[k]):
        gap = gap_to_person(chassis, people, k, i, hull, x, y, 0.0)
        if gap[0] < -TOLERANCE:
            vx, vy = people.velocities[k, i, 0], people.velocities[k, i, 1]
            record(touch, k, tick, touch.first_person + i, people.ids[k, i], gap, x, y, motion, vx, vy)


@njit(cache=True)
def gap_to_person(chassis: Chassis, people: People, k: int, i: int, hull: Floats, x: float, y: float, within: float) -> Gap:
    """Return the gap between robot k and one person, ``NOTHING`` if the person is surely farther than ``within``."""
    px, py, radius = people.positions[k, i, 0], people.positions[k, i, 1], people.radii[k, i]
    if math.hypot(px - x, py - y) - chassis.radius - radius > within:
        return NOTHING
    return gap_to_disc(hull, chassis.rounding, px, py, radius)


@njit(cache=True)
def record(
    touch: Touch,
    k: int,
    tick: int,
    thing: int,
    person: int,
    gap: Gap,
    x: float,
    y: float,
    motion: tuple[float, float, float],
    other_vx: float,
    other_vy: float,
) -> None:
    """Note the rising edge of robot k's contact with a thing, unless it already touches it.

    (x, y) is where the robot is, ``motion`` its velocity in ``map``. It caused the contact if its own surface moved towards the
    other; what cannot move never did.
    """
    if touch.held[k, thing]:
        return
    touch.held[k, thing] = True
    _, nx, ny, px, py = gap
    own = (motion[0] - motion[2] * (py - y)) * nx + (motion[1] + motion[2] * (px - x)) * ny
    closing = max(own - other_vx * nx - other_vy * ny, 0.0)
    caused = person < 0 or own > MOVING
    row = touch.edges[k, touch.counts[k]]
    row[0], row[1], row[2], row[3] = tick, thing, closing, caused
    row[4], row[5], row[6] = x, y, person
    touch.counts[k] += 1


@njit(cache=True)
def release(scene: Scene, chassis: Chassis, people: People, touch: Touch, k: int, hull: Floats, x: float, y: float) -> bool:
    """End the contacts of robot k whose gap has opened; tell whether any is left."""
    any_left = False
    for thing in range(touch.held.shape[1]):
        if not touch.held[k, thing]:
            continue
        if thing == 0:
            gap = gap_to_cells(scene.stack, scene.grid_of[k], hull, chassis.rounding, x, y, chassis.radius, 2.0 * RELEASE)
        elif thing < touch.first_person:
            gap = gap_to_obstacle(scene.obstacles, k, thing - 1, hull, chassis.rounding)
        else:
            gap = gap_to_person(chassis, people, k, thing - touch.first_person, hull, x, y, 2.0 * RELEASE)
        touch.held[k, thing] = gap[0] <= RELEASE
        any_left |= touch.held[k, thing]
    return any_left
