"""How far a body is from what stands in a world, and from its people; thin kernels above
``arena_kernels.footprint``.
"""

from __future__ import annotations

import math

from arena_kernels.compiled import inner
from arena_kernels.footprint import NOTHING, Body, Gap, gap_to_convex, gap_to_disc, gap_to_polygon
from arena_kernels.walls import gap_to_walls, walls_beyond
from arena_sim2d.bodies import PEOPLE, ROBOTS, Floats, Row, World


@inner
def is_clear(world: World, x: float, y: float, reach: float) -> bool:
    """Return whether all that stands surely is farther than ``reach`` from a point; cheap, and
    true for most bodies at most times.
    """
    clear = walls_beyond(world.walls, x, y, reach)
    for index in range(world.robots[world.k].obstacles):
        obstacle = world.obstacles[index]
        clear &= (x - obstacle.x) ** 2 + (y - obstacle.y) ** 2 > (reach + obstacle.radius) ** 2
    return bool(clear)


@inner
def gap_to_things(world: World, body: Body, within: float) -> Gap:
    """Return the least gap between a robot's body and all that stands, ``NOTHING``
    unless it is less than ``within``.
    """
    return _gap_to_things(world, body, within, ROBOTS)


@inner
def gap_of_person(world: World, body: Body, within: float) -> Gap:
    """Return the least gap between a person's body and all that stands, ``NOTHING``
    unless it is less than ``within``.
    """
    return _gap_to_things(world, body, within, PEOPLE)


@inner
def _gap_to_things(world: World, body: Body, within: float, who: int) -> Gap:
    wall = gap_to_walls(world.walls, body, within)
    obstacle = gap_to_obstacles(world, body, min(wall[0], within), who)
    return obstacle if obstacle[0] < wall[0] else wall


@inner
def gap_to_obstacles(world: World, body: Body, within: float, who: int) -> Gap:
    """Return the gap to the nearest obstacle that ``who`` may meet, ``NOTHING`` unless it is less than ``within``."""
    best = NOTHING
    for index in range(world.robots[world.k].obstacles):
        if world.obstacles[index].meets & who:
            gap = gap_to_obstacle(world, index, body, min(best[0], within))
            if gap[0] < best[0]:
                best = gap
    return best


@inner
def gap_to_obstacle(world: World, index: int, body: Body, within: float) -> Gap:
    """Return the gap to one obstacle, ``NOTHING`` unless it is less than ``within``."""
    obstacle = world.obstacles[index]
    gap = gap_to_round(body, obstacle.x, obstacle.y, obstacle.radius, within)
    if obstacle.first < obstacle.last and gap[0] < within:
        gap = gap_to_polygon(body, world.sides[obstacle.first : obstacle.last])
    return gap if gap[0] < within else NOTHING


@inner
def gap_to_round(body: Body, x: float, y: float, radius: float, within: float) -> Gap:
    """Return the gap to a disc, ``NOTHING`` unless it is less than ``within``; a disc that is
    nowhere (NaN) is never near.
    """
    reach = within + body.radius + radius
    if reach < 0.0 or not (x - body.at[0]) ** 2 + (y - body.at[1]) ** 2 < reach * reach:
        return NOTHING
    gap = gap_to_disc(body, x, y, radius)
    return gap if gap[0] < within else NOTHING


@inner
def gap_to_people(world: World, body: Body, within: float) -> float:
    """Return the least gap to the world's people, ``within`` if none is nearer."""
    for i in range(world.robots[world.k].people):
        person = world.people[i]
        within = min(within, gap_to_round(body, person.x, person.y, person.radius, within)[0])
    return within


@inner
def gap_to_mate(world: World, row: int, body: Body, within: float) -> Gap:
    """Return the gap to the robot in a row of the team, ``NOTHING`` unless it is less than ``within``."""
    other = world.robots[row]
    theirs = world.bodies[other.kind]
    reach = within + body.radius + theirs.radius
    apart = (other.x - body.at[0]) ** 2 + (other.y - body.at[1]) ** 2
    if other.absent or reach < 0.0 or not apart < reach * reach:
        return NOTHING
    if theirs.corners == 1:
        gap = gap_to_disc(body, other.x, other.y, theirs.rounding)
    else:
        place_outline(world.outline, theirs, other)
        gap = gap_to_convex(body, world.outline[: theirs.corners, 1])
    return gap if gap[0] < within else NOTHING


@inner
def place_outline(outline: Floats, body: Body, robot: Row) -> None:
    """Write the sides (C, 2, 2) of a robot's body, a polygon, where the robot is; side i ends at corner i."""
    c, s = math.cos(robot.theta), math.sin(robot.theta)
    for i in range(body.corners):
        px, py, after = body.points[0, i, 0], body.points[0, i, 1], (i + 1) % body.corners
        outline[i, 1, 0], outline[i, 1, 1] = robot.x + c * px - s * py, robot.y + s * px + c * py
        outline[after, 0, 0], outline[after, 0, 1] = outline[i, 1, 0], outline[i, 1, 1]


@inner
def gap_to_team(world: World, body: Body, within: float) -> float:
    """Return the least gap to the other robots of the team, ``within`` if none is nearer."""
    for row in range(world.first, world.first + world.team):
        if row != world.k:
            within = min(within, gap_to_mate(world, row, body, within)[0])
    return within
