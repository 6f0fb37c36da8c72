"""How worlds begin, all together or single ones again."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from arena_core import (
    Branches,
    ConfigurationError,
    Crowd,
    ImpossibleScenario,
    Pose,
    Robot,
    RobotBatch,
    Scenario,
    stream_key,
)
from arena_core.tasks import Member
from arena_kernels.footprint import Body, make_body
from arena_kernels.legs import Gait
from arena_kernels.pool import GridPool
from arena_sim2d.bodies import CONTACT, DOOR, OBSTACLE, PERSON, ROBOT, Rows, Worlds
from arena_sim2d.contact import TOLERANCE
from arena_sim2d.doors import table_doors
from arena_sim2d.obstacles import Reach, table_obstacles

Slots = NDArray[np.int64]

# tables of Worlds that have a row for each world, and for each robot; grids are shared
OF_WORLDS = ("grid_of", "obstacles", "sides", "doors", "openings", "people")
OF_ROBOTS = ("robots", "touching", "contacts")
THINGS = ("a wall", "an obstacle", "a person", "another robot")


def no_worlds(robots: Sequence[Robot], scenarios: Sequence[Scenario], pool: GridPool, gait: Gait) -> Worlds:
    """Return the tables of N worlds in which nothing is yet; ``robots`` are the types that there are."""
    corners = max(len(robot.footprint.vertices_xy) for robot in robots)
    total, team = len(scenarios), max((scenario.robots for scenario in scenarios), default=1)
    return Worlds(
        grid_of=pool.place([scenario.world.grid for scenario in scenarios]),
        stack=pool.stack,
        obstacles=np.zeros((total, 0), OBSTACLE),
        sides=np.zeros((total, 0, 2, 2)),
        doors=np.zeros((total, 0), DOOR),
        openings=np.zeros((total, 0, 2)),
        robots=np.zeros(total * team, ROBOT),
        people=np.zeros((total, 0), PERSON),
        touching=np.zeros((total * team, 1 + _team_things(team)), np.bool_),
        contacts=np.zeros((total * team, 0), CONTACT),
        first_person=1,
        bodies=tuple(make_body(robot.footprint.vertices_xy, robot.footprint.radius) for robot in robots),
        person=make_body(np.empty((0, 2)), 1.0),
        outline=np.zeros((max(corners, 1), 2, 2)),
        gait=gait,
    )


def _team_things(team: int) -> int:
    """Return how many robots a robot may touch, itself among them; none where it is alone."""
    return team if team > 1 else 0


def rows_of(slots: Slots, team: int) -> Slots:
    """Return the rows of the robots of these worlds, world after world."""
    return (slots[:, None] * team + np.arange(team)).reshape(-1)


def kinds_of(robot: Robot, scenarios: Sequence[Scenario]) -> tuple[Robot, ...]:
    """Return the types of robots that are in some worlds, ``robot`` first: teammates may be of others."""
    kinds = [robot]
    for scenario in scenarios:
        kinds += [mate.body for mate in scenario.team if mate.body is not None and place_of_kind(mate, kinds) < 0]
    return tuple(kinds)


def place_of_kind(mate: Member, kinds: Sequence[Robot]) -> int:
    """Return the place of a teammate's type, -1 where it is none of them."""
    return 0 if mate.body is None else next((k for k, kind in enumerate(kinds) if kind is mate.body), -1)


def begin_worlds(
    worlds: Worlds, scenarios: Sequence[Scenario], slots: Slots, crowd: Crowd, pool: GridPool, edges: int, reach: Reach
) -> Worlds:
    """Begin the ``scenarios`` of these ``slots``; all other worlds go on as they are.

    ``crowd`` holds the people of all worlds. A robot gains at most ``edges`` contacts with one thing between two looks
    at them.
    """
    tabled = [table_obstacles(scenarios[slot], reach) for slot in slots.tolist()]
    obstacles = _widen_table(worlds.obstacles, max((len(rows) for rows, _ in tabled), default=0))
    sides = _widen_table(worlds.sides, max((len(part) for _, part in tabled), default=0))
    timetables = [
        table_doors(scenarios[slot], len(rows) - len(scenarios[slot].doors))
        for slot, (rows, _) in zip(slots.tolist(), tabled, strict=True)
    ]
    doors = _widen_table(worlds.doors, max((len(rows) for rows, _ in timetables), default=0))
    openings = _widen_table(worlds.openings, max((len(part) for _, part in timetables), default=0))
    people = _table_people(crowd)
    kept = np.ones(len(people), np.bool_)
    kept[slots] = False
    common = min(people.shape[1], worlds.people.shape[1])
    people[kept, :common] = worlds.people[kept, :common]
    for slot, (rows, part), (leaves, times) in zip(slots.tolist(), tabled, timetables, strict=True):
        obstacles[slot, : len(rows)], sides[slot, : len(part)] = rows, part
        doors[slot, : len(leaves)], openings[slot, : len(times)] = leaves, times
        doors[slot, len(leaves) :] = np.zeros(1, DOOR)
        own = worlds.robots[slot * worlds.team : (slot + 1) * worlds.team]
        _begin_team(own, scenarios[slot], int(crowd.counts[slot]), len(rows))
    grid_of = pool.place([scenario.world.grid for scenario in scenarios])
    begun = worlds._replace(
        obstacles=obstacles,
        sides=sides,
        doors=doors,
        openings=openings,
        people=people,
        grid_of=grid_of,
        stack=pool.stack,
    )
    return _keep_contacts(
        worlds, begun._replace(first_person=1 + obstacles.shape[1]), rows_of(slots, worlds.team), edges
    )


def fork_worlds(worlds: Worlds, branches: Branches) -> Worlds:
    """Return tables of their own that go on from those of these branches; grids and sides are shared."""
    slots, rows = branches.slots, rows_of(branches.slots, worlds.team)
    forked = worlds._replace(
        **{name: getattr(worlds, name)[slots] for name in OF_WORLDS},
        **{name: getattr(worlds, name)[rows] for name in OF_ROBOTS},
    )
    forked.robots["odometry_key"] ^= np.repeat(branches.streams, worlds.team)
    forked.robots["scan_key"] ^= np.repeat(branches.streams, worlds.team)
    _take_away(forked, ~present_robots(branches, worlds.team))
    return forked._replace(
        bodies=tuple(map(_copy_body, worlds.bodies)), person=_copy_body(worlds.person), outline=worlds.outline.copy()
    )


def present_robots(branches: Branches, team: int) -> NDArray[np.bool_]:
    """Return which robots of the branches' worlds are in them, a row each; raise ConfigurationError where ``robots``
    has another number of columns.
    """
    count = branches.robots.shape[1]
    if count not in (1, team):
        raise ConfigurationError(f"branches.robots has {count} columns; allowed: 1, or {team} as worlds have robots")
    return np.broadcast_to(branches.robots, (len(branches), team)).reshape(-1)


def _copy_body(body: Body) -> Body:
    """Return a body with arrays of its own, for kernels to put it somewhere."""
    return body._replace(points=body.points.copy(), at=body.at.copy())


def _take_away(worlds: Worlds, gone: NDArray[np.bool_]) -> None:
    """Put robots out of their worlds; what they touched they touch no longer."""
    robots = worlds.robots
    robots["absent"][gone] = 1
    for name in ("x", "y"):
        robots[name][gone] = RobotBatch.FAR
    for name in ("vx", "vy", "wz"):
        robots[name][gone] = 0.0
    worlds.touching[gone] = False
    if worlds.team > 1:
        mates = gone.reshape(-1, 1, worlds.team).repeat(worlds.team, axis=1).reshape(-1, worlds.team)
        worlds.touching[:, worlds.first_robot :] &= ~mates


def _widen_table(table: NDArray[Any], width: int) -> NDArray[Any]:
    """Return a table (N, W, ...) with room for ``width`` columns; the same one if it has."""
    if table.shape[1] >= width:
        return table
    wide = np.zeros((len(table), width, *table.shape[2:]), table.dtype)
    wide[:, : table.shape[1]] = table
    return wide


def _keep_contacts(before: Worlds, worlds: Worlds, rows: Slots, edges: int) -> Worlds:
    """Make room for contacts; robots that go on still touch what they touched, though people may have got other
    numbers. Those in ``rows`` begin, and touch nothing.
    """
    things = worlds.first_robot + _team_things(worlds.team)
    touching = np.zeros((len(worlds.robots), things), np.bool_)
    touching[:, : before.first_person] = before.touching[:, : before.first_person]
    known = before.touching[:, before.first_person : before.first_robot][:, : worlds.people.shape[1]]
    touching[:, worlds.first_person : worlds.first_person + known.shape[1]] = known
    touching[:, worlds.first_robot :] = before.touching[:, before.first_robot :]
    touching[rows] = False
    return worlds._replace(touching=touching, contacts=_widen_table(worlds.contacts, things * edges))


def _begin_team(rows: Rows, scenario: Scenario, people: int, obstacles: int) -> None:
    """Write the robots of a scenario at rest into their rows; those beyond its team are not in the world."""
    for member in range(len(rows)):
        row = rows[member : member + 1]
        if member < scenario.robots:
            _begin_robot(row, scenario.seen_by(member), people, obstacles)
        else:
            _begin_robot(row, scenario, people, obstacles)
            row["absent"], row["x"], row["y"] = 1, RobotBatch.FAR, RobotBatch.FAR


def _begin_robot(row: Rows, scenario: Scenario, people: int, obstacles: int) -> None:
    """Write the robot of a scenario at rest into its row, shape (1,)."""
    start = scenario.start
    row[...] = np.zeros(1, ROBOT)
    row["x"], row["y"], row["theta"] = start.x, start.y, start.theta
    row["speed_share"] = scenario.speed_share
    row["odometry_from_x"], row["odometry_from_y"], row["odometry_from_theta"] = start.x, start.y, start.theta
    row["people"], row["obstacles"], row["doors"] = people, obstacles, len(scenario.doors)
    row["odometry_key"] = stream_key(scenario.seed, scenario.name, "odometry")
    row["scan_key"] = stream_key(scenario.seed, scenario.name, "lidar")


def _table_people(crowd: Crowd) -> Rows:
    """Return the people of N worlds, who have nowhere to go yet, (N, P)."""
    table = np.zeros(crowd.ids.shape, PERSON)
    table["id"], table["radius"] = crowd.ids, crowd.radii
    table["x"], table["y"] = crowd.positions[..., 0], crowd.positions[..., 1]
    table["vx"], table["vy"] = crowd.velocities[..., 0], crowd.velocities[..., 1]
    return table


def check_starts(gaps: NDArray[np.float64], scenarios: Sequence[Scenario], slots: Slots) -> None:
    """Raise ImpossibleScenario if a robot in these slots starts outside its map or inside
    something, as the ``gaps`` (R, 4) of all robots tell.
    """
    team = len(gaps) // len(scenarios)
    for slot in slots.tolist():
        scenario = scenarios[slot]
        whose = "the robot's" if scenario.robots == 1 else "the first robot's"
        _check_start(scenario, scenario.start, whose, gaps[slot * team])
        for place, member in enumerate(scenario.team, slot * team + 1):
            _check_start(scenario, member.start, f"{member.name}'s", gaps[place])


def _check_start(scenario: Scenario, start: Pose, whose: str, gaps: NDArray[np.float64]) -> None:
    reasons = [f"overlaps {thing}" for thing, gap in zip(THINGS, gaps.tolist(), strict=True) if gap < -TOLERANCE]
    grid = scenario.world.grid
    if not grid.contains(grid.cells((start.x, start.y))):
        reasons = ["lies outside the map"]
    if reasons:
        raise ImpossibleScenario(f"{scenario.name}: {whose} start ({start.x:.2f}, {start.y:.2f}) {reasons[0]}")
