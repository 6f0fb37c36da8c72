"""How N worlds begin, all together or single ones anew."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from arena_core import Crowd, ImpossibleScenario, Robot, Scenario, stream_key
from arena_kernels.footprint import make_body
from arena_kernels.grids import stack_grids
from arena_sim2d.bodies import CONTACT, PERSON, ROBOT, Rows, Worlds
from arena_sim2d.contact import TOLERANCE
from arena_sim2d.obstacles import table_obstacles
from arena_sim2d.ticking import measure_gaps

Slots = NDArray[np.int64]

THINGS = ("a wall", "an obstacle", "a person")


def begin_all(robot: Robot, scenarios: Sequence[Scenario], crowd: Crowd, edges: int) -> Worlds:
    """Begin N worlds; a robot gains at most ``edges`` contacts with one thing between two looks at them."""
    total = len(scenarios)
    stack, grid_of = stack_grids([scenario.world.grid for scenario in scenarios])
    obstacles, sides = table_obstacles(scenarios)
    people = table_people(crowd)
    first_person = 1 + obstacles.shape[1]
    things = first_person + people.shape[1]
    worlds = Worlds(
        stack,
        grid_of,
        obstacles,
        sides,
        np.zeros(total, ROBOT),
        people,
        np.zeros((total, things), np.bool_),
        np.zeros((total, things * edges), CONTACT),
        first_person,
        make_body(robot.footprint.vertices_xy, robot.footprint.radius),
        make_body(np.empty((0, 2)), 1.0),
    )
    for row, scenario, count in zip(worlds.robots, scenarios, crowd.counts.tolist(), strict=True):
        _begin_robot(row, scenario, count)
    return worlds


def begin_some(robot: Robot, before: Worlds, scenarios: Sequence[Scenario], slots: Slots, crowd: Crowd, edges: int) -> Worlds:
    """Begin the ``scenarios`` of these ``slots`` anew; all other worlds go on as they are."""
    worlds = begin_all(robot, scenarios, crowd, edges)
    kept = np.setdiff1d(np.arange(len(scenarios)), slots)
    people = min(before.people.shape[1], worlds.people.shape[1])
    obstacles = min(before.first_person, worlds.first_person)
    worlds.robots[kept] = before.robots[kept]
    worlds.people[kept, :people] = before.people[kept, :people]
    worlds.touching[kept, :obstacles] = before.touching[kept, :obstacles]
    touched = before.touching[kept, before.first_person :][:, :people]
    worlds.touching[kept, worlds.first_person : worlds.first_person + people] = touched
    return worlds


def _begin_robot(row: np.void, scenario: Scenario, people: int) -> None:
    start = scenario.start
    row["x"], row["y"], row["theta"] = start.x, start.y, start.theta
    row["odometry_from_x"], row["odometry_from_y"], row["odometry_from_theta"] = start.x, start.y, start.theta
    row["people"], row["obstacles"] = people, len(scenario.obstacles)
    row["odometry_key"] = stream_key(scenario.seed, scenario.name, "odometry")
    row["scan_key"] = stream_key(scenario.seed, scenario.name, "lidar")


def table_people(crowd: Crowd) -> Rows:
    """Return the people of N worlds, standing still, (N, P)."""
    table = np.zeros(crowd.ids.shape, PERSON)
    table["id"], table["radius"] = crowd.ids, crowd.radii
    table["x"], table["y"] = crowd.positions[..., 0], crowd.positions[..., 1]
    table["vx"], table["vy"] = crowd.velocities[..., 0], crowd.velocities[..., 1]
    return table


def check_starts(worlds: Worlds, scenarios: Sequence[Scenario], slots: Slots) -> None:
    """Raise ImpossibleScenario if a robot in these slots starts outside its map or inside something."""
    gaps = np.empty((len(worlds.robots), 3))
    measure_gaps(worlds, gaps)
    for slot in slots.tolist():
        scenario = scenarios[slot]
        reasons = [f"overlaps {thing}" for thing, gap in zip(THINGS, gaps[slot].tolist(), strict=True) if gap < -TOLERANCE]
        grid, start = scenario.world.grid, scenario.start
        if not grid.contains(grid.cells((start.x, start.y))):
            reasons = ["lies outside the map"]
        if reasons:
            raise ImpossibleScenario(f"{scenario.name}: the robot's start ({start.x:.2f}, {start.y:.2f}) {reasons[0]}")
