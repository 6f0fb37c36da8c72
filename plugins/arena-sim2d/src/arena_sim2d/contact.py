"""Whom the robot touches: the rising edges of contact, and when a contact ends."""

from __future__ import annotations

from arena_kernels.compiled import inner
from arena_kernels.footprint import NOTHING, Gap, place_body
from arena_kernels.motion import Velocity, in_map
from arena_kernels.walls import gap_to_walls
from arena_sim2d.bodies import ROBOTS, World
from arena_sim2d.clearances import gap_to_mate, gap_to_obstacle, gap_to_round

TOLERANCE = 1e-9  # m; an overlap below this is rounding
RELEASE = 0.01  # m; a contact ends when the gap is wider, so that one long touch is one event
APPROACH = 0.01  # m/s; a robot that approaches more slowly than this did not cause the contact


@inner
def note_overlaps(world: World, tick: int, velocity: Velocity) -> None:
    """Note a contact with everything that the robot's body, put where it wanted to be, overlaps;
    ``velocity`` (``map``) led there.
    """
    for thing in range(world.first_person + world.robots[world.k].people):
        if world.touching[thing]:
            continue
        gap = _gap_to_thing(world, thing, -TOLERANCE)
        if gap[0] < 0.0:
            person = thing - world.first_person
            vx, vy = (world.people[person].vx, world.people[person].vy) if person >= 0 else (0.0, 0.0)
            note_contact(world, tick, thing, gap, velocity, vx, vy)
    for row in range(world.first, world.first + world.team):
        if row != world.k and not world.touching[world.first_robot + row - world.first]:
            gap = gap_to_mate(world, row, world.body, -TOLERANCE)
            if gap[0] < 0.0:
                _note_meeting(world, tick, row, gap, velocity)


@inner
def _note_meeting(world: World, tick: int, row: int, gap: Gap, velocity: Velocity) -> None:
    """Note a contact of the robot with that in ``row``, for both: each caused it if it moved towards the other."""
    mate = world.robots[row]
    theirs = in_map(mate.theta, (mate.vx, mate.vy, mate.wz))
    note_contact(world, tick, world.first_robot + row - world.first, gap, velocity, theirs[0], theirs[1])
    depth, nx, ny, px, py = gap
    back = (depth, -nx, -ny, px - depth * nx, py - depth * ny)
    thing = world.first_robot + world.k - world.first
    note_contact(member_world(world, row), tick, thing, back, theirs, velocity[0], velocity[1])


@inner
def member_world(world: World, row: int) -> World:
    """Return a world as it is that of another robot of its team."""
    return World(
        world.walls,
        world.obstacles,
        world.sides,
        world.doors,
        world.openings,
        world.robots,
        row,
        world.people,
        world.team_touching[row - world.first],
        world.team_contacts[row - world.first],
        world.first_person,
        world.first_robot,
        world.team,
        world.first,
        world.team_touching,
        world.team_contacts,
        world.bodies[world.robots[row].kind],
        world.bodies,
        world.person,
        world.outline,
    )


@inner
def _gap_to_thing(world: World, thing: int, within: float) -> Gap:
    if thing == 0:
        return gap_to_walls(world.walls, world.body, within)
    if thing >= world.first_robot:
        return gap_to_mate(world, world.first + thing - world.first_robot, world.body, within)
    if thing >= world.first_person:
        person = world.people[thing - world.first_person]
        return gap_to_round(world.body, person.x, person.y, person.radius, within)
    if thing <= world.robots[world.k].obstacles and world.obstacles[thing - 1].meets & ROBOTS:
        return gap_to_obstacle(world, thing - 1, world.body, within)
    return NOTHING


@inner
def note_contact(
    world: World, tick: int, thing: int, gap: Gap, velocity: Velocity, other_vx: float, other_vy: float
) -> None:
    """Note the rising edge of a contact, unless the robot already touches the thing; velocities are in ``map``.

    The robot caused the contact if its own surface moved towards the other. What cannot move never did.
    """
    if world.touching[thing]:
        return
    world.touching[thing] = True
    robot = world.robots[world.k]
    contact = world.contacts[robot.contacts]
    robot.contacts += 1
    _, nx, ny, px, py = gap
    own = (velocity[0] - velocity[2] * (py - robot.y)) * nx + (velocity[1] + velocity[2] * (px - robot.x)) * ny
    contact.tick, contact.thing = tick, thing
    contact.person = -1
    if thing >= world.first_robot:
        contact.person = thing - world.first_robot
    elif thing >= world.first_person:
        contact.person = world.people[thing - world.first_person].id
    contact.caused = thing < world.first_person or own > APPROACH
    contact.speed = max(own - other_vx * nx - other_vy * ny, 0.0)
    contact.x, contact.y = robot.x, robot.y


@inner
def release_contacts(world: World) -> bool:
    """End the contacts whose gap has opened; return whether any is left."""
    robot, any_left = world.robots[world.k], False
    for thing in range(len(world.touching)):
        if world.touching[thing]:
            place_body(world.body, robot.x, robot.y, robot.theta)
            world.touching[thing] = _gap_to_thing(world, thing, RELEASE)[0] < RELEASE
            any_left |= world.touching[thing]
            if thing >= world.first_robot:  # two robots let go of each other together
                other = thing - world.first_robot
                world.team_touching[other, world.first_robot + world.k - world.first] = world.touching[thing]
    return any_left
