"""Obstacles that are on no map stand where the robot still gets through, and change nothing where there are none."""

from dataclasses import replace
from functools import cache
from hashlib import blake2b
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from omegaconf import OmegaConf

from arena_core import (
    ConfigurationError,
    Footprint,
    ImpossibleScenario,
    OccupancyGrid,
    Pose,
    Robot,
    World,
    WorldSource,
    testing,
)
from arena_core.hosting import Registry, compose, load_registry, to_plain
from arena_core.scenes import add_obstacles
from arena_tasks.random.free_space import FreeSpace
from arena_tasks.random.random_task import RandomTask

EXACT = settings(derandomize=True, deadline=None, max_examples=20)
GOLDEN = "7ab0fcd3321f1b3e"  # of three scenarios without obstacles


class Fixed(WorldSource):
    def __init__(self, grid: OccupancyGrid) -> None:
        self._world = World("fixed", grid)

    def world(self, seed: int, index: int) -> World:
        return self._world


def corridors(width: float = 2.0, resolution: float = 0.1) -> OccupancyGrid:
    """Return three halls, joined by corridors of this width."""
    data = np.full((160, 240), 100, np.int8)
    half = round(width / resolution / 2)
    for column in (10, 100, 190):
        data[20:140, column : column + 40] = 0
    data[80 - half : 80 + half, 10:230] = 0
    return OccupancyGrid(data, resolution, Pose(-4.0, 1.0, 0.2))


CORRIDORS = corridors()


@cache
def usual() -> tuple[Registry, Any]:
    return load_registry(), compose(["task=random"], "component")["task"]


def make(grid: OccupancyGrid = CORRIDORS, robot: Robot | None = None, **changes: object) -> RandomTask:
    registry, figures = usual()
    task: RandomTask = registry.build(
        "task", to_plain(OmegaConf.merge(figures, changes)), robot=robot or testing.robot(), world=Fixed(grid)
    )
    return task


@EXACT
@given(st.integers(0, 2**31), st.integers(0, 50), st.sampled_from(["along_route", "anywhere"]), st.floats(0.1, 0.35))
def test_every_promise_is_kept(seed: int, index: int, placement: str, radius: float) -> None:
    robot = replace(testing.robot(), footprint=Footprint.circle(radius))
    scenario = make(robot=robot, placement=placement, obstacles={"count": 6}, pedestrians=2).scenario(seed, index)
    assert len(scenario.obstacles) == 6
    ends = np.array([(p.x, p.y) for p in (scenario.start, scenario.goal)])
    centres = np.array([o.vertices_xy[0] if o.radius else o.vertices_xy.mean(axis=0) for o in scenario.obstacles])
    for obstacle in scenario.obstacles:
        assert obstacle.radius == 0.0 or 0.1 <= obstacle.radius <= 0.3
        off = np.hypot(*(obstacle.vertices_xy[:, None] - ends).transpose(2, 0, 1)) - obstacle.radius
        assert off.min() >= 4 * radius
    among = add_obstacles(CORRIDORS, scenario.obstacles).derive(FreeSpace)
    labels = among.regions(radius + 0.05)[tuple(CORRIDORS.cells(ends).T)]
    assert labels[0] == labels[1] > 0
    for person in scenario.pedestrians:
        assert among.has_room(np.vstack((person.waypoints_xy, person.position_xy)), 0.3).all()
    assert CORRIDORS.derive(FreeSpace).has_room(centres, 0.0).all()


def test_obstacles_are_discs_and_simple_polygons_of_the_asked_size() -> None:
    def drawn(share: float) -> list[Any]:
        task = make(obstacles={"polygons": share, "count": 5}, pedestrians=0)
        return [o for index in range(5) for o in task.scenario(0, index).obstacles]

    assert all(o.radius > 0.0 for o in drawn(0.0))
    for polygon in drawn(1.0):
        assert polygon.radius == 0.0
        assert 3 <= len(polygon.vertices_xy) <= 6
        sides = np.roll(polygon.vertices_xy, -1, axis=0) - polygon.vertices_xy
        after = np.roll(sides, -1, axis=0)
        assert (sides[:, 0] * after[:, 1] > sides[:, 1] * after[:, 0]).all()  # convex, so simple
        assert np.hypot(*np.ptp(polygon.vertices_xy, axis=0)) <= 2 * 0.3 * 2**0.5


def test_obstacles_along_the_route_stand_in_the_robots_way() -> None:
    def nearest(placement: str) -> float:
        found = []
        for index in range(8):
            scenario = make(testing.room(24.0), placement=placement, obstacles={"count": 3}, pedestrians=0).scenario(
                1, index
            )
            line = np.linspace((scenario.start.x, scenario.start.y), (scenario.goal.x, scenario.goal.y), 200)
            found += [np.hypot(*(line - o.vertices_xy.mean(axis=0)).T).min() for o in scenario.obstacles]
        return float(np.mean(found))

    assert nearest("along_route") < 0.5 * nearest("anywhere")


def test_without_obstacles_scenarios_are_what_they_were() -> None:
    random = np.random.default_rng(0)
    data = np.where(random.random((60, 60)) < 0.05, 100, 0)
    task = make(OccupancyGrid(data, 0.25, Pose(0.0, 0.0)), pedestrians=3)
    said = ""
    for index in range(3):
        scenario = task.scenario(5, index)
        people = [(p.position_xy.tolist(), p.waypoints_xy.tolist(), p.behaviour) for p in scenario.pedestrians]
        said += repr((scenario.start, scenario.goal, people, scenario.obstacles))
    assert blake2b(said.encode(), digest_size=8).hexdigest() == GOLDEN


def test_obstacles_change_neither_start_nor_goal() -> None:
    few, many = (make(obstacles={"count": count}).scenario(4, 2) for count in (0, 5))
    assert (few.start, few.goal) == (many.start, many.goal)


def test_more_obstacles_are_the_same_ones_and_others() -> None:
    few, many = (make(obstacles={"count": count}, pedestrians=0).scenario(4, 2) for count in (2, 5))
    assert [o.vertices_xy.tolist() for o in few.obstacles] == [o.vertices_xy.tolist() for o in many.obstacles[:2]]


def test_only_people_who_come_again_say_so() -> None:
    assert [p.behaviour for p in make(people={"respawn": True}, pedestrians=2).scenario(0, 0).pedestrians] == [
        {"respawn": "random"}
    ] * 2
    assert [p.behaviour for p in make(pedestrians=1).scenario(0, 0).pedestrians] == [{}]


def test_shares_of_the_people_are_children_and_elders_and_all_else_is_as_without() -> None:
    shares: list[dict[str, float]] = [{}, {"children": 0.3, "elders": 0.2}]
    usual_people, mixed = (make(testing.room(24.0), pedestrians=40, people=people).scenario(0, 0) for people in shares)
    types = [p.behaviour.get("type") for p in mixed.pedestrians]
    assert (0.1 < types.count("child") / 40 < 0.5, 0.05 < types.count("elder") / 40 < 0.4, types.count(None) > 10) == (
        True,
    ) * 3
    assert [p.position_xy.tolist() for p in usual_people.pedestrians] == [
        p.position_xy.tolist() for p in mixed.pedestrians
    ]
    with pytest.raises(ConfigurationError, match=r"task\.people\.elders is 0\.5; allowed: up to 0\.4"):
        make(people={"children": 0.6, "elders": 0.5})


def test_too_many_obstacles_say_what_to_lower() -> None:
    with pytest.raises(
        ImpossibleScenario, match=r"obstacle \d+ of 90 found no place in 100 tries; lower task\.obstacles\.count or"
    ):
        make(testing.room(4.0), obstacles={"count": 90}, tries=1).scenario(0, 0)


def test_radii_that_contradict_each_other_are_refused() -> None:
    with pytest.raises(
        ConfigurationError,
        match=r"task\.obstacles\.radius_min is 0\.5 and radius_max 0\.3; allowed",
    ):
        make(obstacles={"radius_min": 0.5})
