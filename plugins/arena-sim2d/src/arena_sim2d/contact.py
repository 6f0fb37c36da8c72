"""Who touches whom: the rising edges of contact, and when a contact ends."""

from __future__ import annotations

from arena_kernels.compiled import borrowing
from arena_kernels.footprint import Gap, gap_to_cells, place
from arena_sim2d.bodies import Moving
from arena_sim2d.gaps import gap_to_obstacle, gap_to_round, obstacle_count
from arena_sim2d.motion import Velocity

TOLERANCE = 1e-9  # m; an overlap below this is rounding
RELEASE = 0.01  # m; a contact ends when the gap is wider, so that one long touch is one event
APPROACH = 0.01  # m/s; a robot that approaches more slowly than this did not cause the contact


@borrowing
def record_overlaps(world: Moving, k: int, tick: int, velocity: Velocity) -> None:
    """Note a contact with everything that the robot's body, put where it wanted to be, overlaps; ``velocity`` (``map``) led there."""
    gap = gap_to_cells(world.scene.stack, world.scene.grid_of[k], world.body, -TOLERANCE)
    if gap[0] < 0.0:
        record(world, k, tick, 0, -1, gap, velocity, 0.0, 0.0)
    for index in range(obstacle_count(world.scene.obstacles, k)):
        gap = gap_to_obstacle(world.scene.obstacles, k, index, world.body, -TOLERANCE)
        if gap[0] < 0.0:
            record(world, k, tick, 1 + index, -1, gap, velocity, 0.0, 0.0)
    for i in range(world.people.counts[k]):
        gap = _gap_to_person(world, k, i, -TOLERANCE)
        if gap[0] < 0.0:
            vx, vy = world.people.velocities[k, i, 0], world.people.velocities[k, i, 1]
            record(world, k, tick, world.touch.first_person + i, world.people.ids[k, i], gap, velocity, vx, vy)


@borrowing
def _gap_to_person(world: Moving, k: int, i: int, within: float) -> Gap:
    x, y = world.people.positions[k, i, 0], world.people.positions[k, i, 1]
    return gap_to_round(world.body, x, y, world.people.radii[k, i], within)


@borrowing
def record(
    world: Moving, k: int, tick: int, thing: int, person: int, gap: Gap, velocity: Velocity, other_vx: float, other_vy: float
) -> None:
    """Note the rising edge of robot k's contact with a thing, unless it already touches it; velocities are in ``map``.

    The robot caused the contact if its own surface moved towards the other. What cannot move never did.
    """
    touch = world.touch
    if touch.held[k, thing]:
        return
    touch.held[k, thing] = True
    _, nx, ny, px, py = gap
    x, y = world.robots.poses[k, 0], world.robots.poses[k, 1]
    own = (velocity[0] - velocity[2] * (py - y)) * nx + (velocity[1] + velocity[2] * (px - x)) * ny
    row = touch.edges[k, touch.counts[k]]
    row[0], row[1] = tick, thing
    row[2] = max(own - other_vx * nx - other_vy * ny, 0.0)
    row[3] = person < 0 or own > APPROACH
    row[4], row[5], row[6] = x, y, person
    touch.counts[k] += 1


@borrowing
def release_contacts(world: Moving, k: int) -> bool:
    """End the contacts of robot k whose gap has opened; tell whether any is left."""
    touch, any_left = world.touch, False
    for thing in range(touch.held.shape[1]):
        if touch.held[k, thing]:
            place(world.body, world.robots.poses[k, 0], world.robots.poses[k, 1], world.robots.poses[k, 2])
            touch.held[k, thing] = _is_near(world, k, thing)
            any_left |= touch.held[k, thing]
    return any_left


@borrowing
def _is_near(world: Moving, k: int, thing: int) -> bool:
    if thing == 0:
        gap = gap_to_cells(world.scene.stack, world.scene.grid_of[k], world.body, RELEASE)
    elif thing < world.touch.first_person:
        gap = gap_to_obstacle(world.scene.obstacles, k, thing - 1, world.body, RELEASE)
    else:
        gap = _gap_to_person(world, k, thing - world.touch.first_person, RELEASE)
    return bool(gap[0] < RELEASE)
