"""Random scenarios keep their promises, and are pure functions of seed and index."""

from dataclasses import replace
from functools import cache
from importlib.resources import files
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
    Scenario,
    World,
    WorldSource,
    testing,
)
from arena_core.hosting import Registry, compose, load_registry, to_plain
from arena_core.testing import check
from arena_kernels.shortest_path import ShortestPaths
from arena_tasks import config_package, register_task_modes
from arena_tasks.random.free_space import FreeSpace
from arena_tasks.random.random_task import RandomTask
from arena_tasks.random.route import find_route

EXACT = settings(derandomize=True, deadline=None, max_examples=25)


class Fixed(WorldSource):
    def __init__(self, grid: OccupancyGrid) -> None:
        self._world = World("fixed", grid)

    def world(self, seed: int, index: int) -> World:
        return self._world


def hall(size: float = 20.0, resolution: float = 0.1) -> OccupancyGrid:
    """Return a walled hall with six racks, its lower left corner at (-5, 3)."""
    n = round(size / resolution)
    data = np.zeros((n, n), np.int8)
    data[[0, -1]] = data[:, [0, -1]] = 100
    for x in (0.2, 0.5, 0.8):
        for y in (0.3, 0.7):
            data[int((y - 0.1) * n) : int((y + 0.1) * n), int((x - 0.025) * n) : int((x + 0.025) * n)] = 100
    return OccupancyGrid(data, resolution, Pose(-5.0, 3.0, 0.3))


HALL = hall()


@cache
def usual() -> tuple[Registry, Any]:
    return load_registry(), compose(["task=random"], "component")["task"]


def make(grid: OccupancyGrid = HALL, robot: Robot | None = None, **changes: object) -> RandomTask:
    registry, figures = usual()
    task: RandomTask = registry.build(
        "task", to_plain(OmegaConf.merge(figures, changes)), robot=robot or testing.robot(), world=Fixed(grid)
    )
    return task


def text(scenario: Scenario) -> str:
    people = [
        (p.id, p.position_xy.tolist(), p.waypoints_xy.tolist(), p.desired_speed, p.radius) for p in scenario.pedestrians
    ]
    return repr(
        (scenario.name, scenario.seed, scenario.start, scenario.goal, people, scenario.goal_radius, scenario.time_limit)
    )


def test_hooks_offer_what_the_yaml_files_name() -> None:
    registered: list[str] = []
    register_task_modes(lambda name, factory: registered.append(name))
    named = {OmegaConf.load(str(file))["name"] for file in (files(config_package()) / "task").iterdir()}
    assert sorted(registered) == sorted(named)


def test_it_holds_the_contract_of_a_task() -> None:
    assert check("task", make(), testing.robot())


def test_scenario_is_a_pure_function_of_seed_and_index() -> None:
    one, other = make(), make()
    wanted = text(one.scenario(7, 3))
    other.scenario(7, 2)
    assert text(other.scenario(7, 3)) == wanted
    assert len({text(one.scenario(seed, index)) for seed in (0, 1) for index in range(5)}) == 10
    assert one.scenario(7, 3).name == "random/0003"


@EXACT
@given(st.integers(0, 2**31), st.integers(0, 50), st.sampled_from(["along_route", "anywhere"]), st.floats(0.05, 0.35))
def test_every_promise_is_kept(seed: int, index: int, placement: str, radius: float) -> None:
    robot = replace(testing.robot(), footprint=Footprint.circle(radius))
    scenario = make(robot=robot, placement=placement, pedestrians=6).scenario(seed, index)
    space = HALL.derive(FreeSpace)
    ends = np.array([(p.x, p.y) for p in (scenario.start, scenario.goal)])
    assert space.has_room(ends, 2 * radius).all()
    assert 10.0 <= scenario.start.distance(scenario.goal) <= 20.0
    labels = space.regions(radius + 0.05)[tuple(HALL.cells(ends).T)]
    assert labels[0] == labels[1] > 0
    assert [p.id for p in scenario.pedestrians] == list(range(6))
    for person in scenario.pedestrians:
        assert (person.desired_speed, person.radius) == (0.3, 0.3)
        assert 2 <= len(person.waypoints_xy) <= 6  # four places, and two of them on the way back
        assert space.has_room(np.vstack((person.waypoints_xy, person.position_xy[None])), 0.35).all()
        assert len(HALL.derive(ShortestPaths).patrol_paths(person.waypoints_xy, 0.3)) == len(person.waypoints_xy)
        stops = np.vstack((person.waypoints_xy, person.position_xy[None]))
        assert np.hypot(*(stops[:, None] - ends).transpose(2, 0, 1)).min() >= 0.3 + 4 * radius
    positions = np.array([p.position_xy for p in scenario.pedestrians])
    apart = np.hypot(*(positions[:, None] - positions).transpose(2, 0, 1))
    assert apart[np.triu_indices(6, 1)].min() > 0.6


def test_people_start_on_the_way_to_their_first_waypoint() -> None:
    for person in make().scenario(1, 0).pedestrians:
        legs = HALL.derive(ShortestPaths).patrol_paths(person.waypoints_xy, person.radius)
        ends = zip(legs[0], legs[0][1:], strict=False)
        detours = [
            np.hypot(*(a - person.position_xy)) + np.hypot(*(b - person.position_xy)) - np.hypot(*(a - b))
            for a, b in ends
        ]
        assert min(detours) == pytest.approx(0.0, abs=1e-9)


def test_rounds_along_the_route_come_to_it_and_rounds_anywhere_may_not() -> None:
    def farthest(placement: str, **rounds: object) -> float:
        found = []
        for index in range(10):
            scenario = make(placement=placement, rounds={"crossing": 0.0, **rounds}).scenario(2, index)
            way = find_route(HALL, 0.16, *(np.array((end.x, end.y)) for end in (scenario.start, scenario.goal)))
            for person in scenario.pedestrians:
                round_way = np.vstack(HALL.derive(ShortestPaths).patrol_paths(person.waypoints_xy, 0.3))
                found.append(np.hypot(*(round_way[:, None] - way).transpose(2, 0, 1)).min())
        return float(np.max(found))

    assert farthest("along_route") < 1.0
    assert farthest("anywhere") > 2.0
    assert farthest("along_route", meeting=0.0) > 2.0


@pytest.mark.parametrize(("crossing", "wide"), [(0.0, False), (1.0, True)])
def test_crossing_people_walk_across_the_way_and_others_along_it(crossing: float, wide: bool) -> None:
    ratios = []
    for index in range(10):
        # a free hall: the route is a straight line, so along and across can be told apart
        scenario = make(testing.room(20.0), rounds={"crossing": crossing, "waypoints_max": 2, "leg_max": 6.0}).scenario(
            0, index
        )
        dx, dy = scenario.goal.x - scenario.start.x, scenario.goal.y - scenario.start.y
        for person in scenario.pedestrians:
            leg = person.waypoints_xy[1] - person.waypoints_xy[0]
            ratios.append(abs(leg @ (-dy, dx)) / max(abs(leg @ (dx, dy)), 1e-9))
    assert (np.median(ratios) > 1.0) == wide


def test_people_do_not_change_start_and_goal() -> None:
    few, many = make(pedestrians=0).scenario(4, 2), make(pedestrians=10).scenario(4, 2)
    assert (few.start, few.goal) == (many.start, many.goal)
    assert few.pedestrians == ()


def test_small_world_gets_shorter_trips_unless_that_is_forbidden() -> None:
    small = testing.room(6.0)
    assert (
        make(small, pedestrians=1).scenario(0, 0).start.distance(make(small, pedestrians=1).scenario(0, 0).goal) >= 2.5
    )
    with pytest.raises(
        ImpossibleScenario, match=r"random/0000 in world fixed: no goal 10 \.\. 20 m .* lower task\.trip\.min_distance"
    ):
        make(small, trip={"shrink_to_world": False}).scenario(0, 0)


def test_unreachable_goals_are_drawn_again() -> None:
    data = HALL.data.copy()
    data[:, 95:105] = 100  # the hall in two halves
    grid = OccupancyGrid(data, HALL.resolution, Pose(0.0, 0.0))
    for index in range(10):
        scenario = make(grid, trip={"min_distance": 3.0}).scenario(0, index)
        assert (scenario.start.x < 10.0) == (scenario.goal.x < 10.0)


def test_nobody_is_placed_on_unknown_cells() -> None:
    data = np.full((200, 200), -1, np.int8)
    data[60:140, 40:160] = 0
    grid = OccupancyGrid(data, 0.1, Pose(0.0, 0.0))
    for index in range(5):
        scenario = make(grid).scenario(0, index)
        points = np.vstack([(scenario.start.x, scenario.start.y), *(p.waypoints_xy for p in scenario.pedestrians)])
        assert (grid.data[tuple(grid.cells(points).T)] == 0).all()


@pytest.mark.parametrize(
    ("grid", "changes", "message"),
    [
        (OccupancyGrid(np.full((9, 9), 100), 0.1, Pose(0.0, 0.0)), {}, "no cell is free with 0.40 m around it"),
        (OccupancyGrid(np.full((9, 9), -1), 0.1, Pose(0.0, 0.0)), {}, "no cell is free"),
        (testing.room(4.0), {"pedestrians": 60}, r"person \d+ of 60 found no place .* lower task\.pedestrians"),
        (
            HALL,
            {"people": {"radius": 9.0}},
            r"no cell is free with 9\.05 m around it for people; lower task\.people\.radius",
        ),
    ],
)
@pytest.mark.parametrize("placement", ["along_route", "anywhere"])
def test_impossible_request_says_what_did_not_fit(
    grid: OccupancyGrid, changes: dict[str, Any], message: str, placement: str
) -> None:
    with pytest.raises(ImpossibleScenario, match=f"^random/0002 in world fixed: {message}") as caught:
        make(grid, placement=placement, tries=2, **changes).scenario(0, 2)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"rounds": {"waypoints_min": 1}}, r"task\.rounds\.waypoints_min is 1"),
        (
            {"rounds": {"waypoints_min": 6}},
            r"task\.rounds\.waypoints_min is 6 and waypoints_max 4; allowed: 2 <= waypoints_min <= waypoints_max",
        ),
        ({"rounds": {"leg_min": 11.0}}, r"task\.rounds\.leg_min is 11 and leg_max 10; allowed: leg_min <= leg_max"),
        ({"groups": {"size_min": 1}}, r"task\.groups\.size_min is 1 and size_max 3"),
        ({"obstacles": {"radius_min": 0.5}}, r"task\.obstacles\.radius_min is 0\.5 and radius_max 0\.3"),
        ({"people": {"speed_spread": 0.4}}, r"task\.people\.speed_spread is 0\.4; allowed: below 0\.4"),
        ({"trip": {"min_distance": 30.0}}, r"task\.trip\.min_distance is 30; allowed: up to max_distance, 20 m"),
    ],
)
def test_contradictions_are_refused_before_anything_runs(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(ConfigurationError, match=message):
        make(**changes)
