"""BARN's task: the same way through every world, with the length of its reference path."""

import math
from importlib.resources import files

import numpy as np
import pytest
import yaml

from arena_core import (
    ConfigurationError,
    ImpossibleScenario,
    OccupancyGrid,
    PedestrianSpec,
    Pose,
    World,
    WorldSource,
    testing,
)
from arena_tasks.random.barn_task import BarnTask

GRID = OccupancyGrid(np.zeros((120, 60), np.int8), 0.15, Pose(-5.0, 0.0))


class Fields(WorldSource):
    def world(self, seed: int, index: int) -> World:
        return World(f"barn/world_{index}", GRID, False, np.array(((-2.0, 5.0), (1.0, 9.0))) if index else None)


def task(**keys: object) -> BarnTask:
    preset = yaml.safe_load((files("arena_tasks.conf") / "task" / "barn.yaml").read_text())
    values = {**preset, **keys, "robot": testing.robot(), "world": Fields()}
    values |= {key: Pose(**values[key]) for key in ("start", "goal")}
    return BarnTask(**{key: value for key, value in values.items() if key != "name"})


def test_scenario_goes_ten_metres_straight_ahead() -> None:
    scenario = task().scenario(5, 1)
    assert scenario.start == Pose(-2.0, 3.0, math.pi / 2)
    assert scenario.start.compose(Pose(10.0, 0.0)).distance(scenario.goal) < 1e-9
    assert (scenario.goal_radius, scenario.time_limit, scenario.seed) == (1.0, 100.0, 5)
    assert not scenario.world.known


def test_every_repetition_has_a_name_and_so_random_streams_of_its_own() -> None:
    assert [task().scenario(0, k).name for k in (1, 2)] == ["barn/world_1/0001", "barn/world_2/0002"]


def test_reference_length_is_that_of_start_path_and_goal() -> None:
    assert task().scenario(0, 1).reference_length == pytest.approx(2.0 + 5.0 + 5.0)


def test_world_without_reference_path_gives_no_reference_length() -> None:
    assert task().scenario(0, 0).reference_length is None


def test_goal_within_its_radius_of_the_start_is_refused() -> None:
    with pytest.raises(ConfigurationError, match=r"task\.goal_radius is 11"):
        task(goal_radius=11.0)


def test_world_that_does_not_hold_the_way_is_said_with_one_that_does() -> None:
    with pytest.raises(
        ImpossibleScenario, match=r"task\.goal is \(-2, 40\), beyond the map of barn/world_0; allowed: .* world=barn"
    ):
        task(goal={"x": -2.0, "y": 40.0, "theta": 0.0}).scenario(0, 0)


def test_dynabarn_goes_twenty_metres_among_those_who_belong_to_the_world() -> None:
    preset = yaml.safe_load((files("arena_tasks.conf") / "task" / "dynabarn.yaml").read_text())
    mover = PedestrianSpec(0, np.zeros(2), np.array(((0.0, 0.0), (1.0, 0.0))), 1.0, 0.5, stamps=np.array((0.0, 1.0)))
    field = OccupancyGrid(np.zeros((530, 530), np.int8), 0.05, Pose(-13.25, -13.25))

    class Crossed(WorldSource):
        def world(self, seed: int, index: int) -> World:
            return World(f"dynabarn/world_{index}", field, False, movers=(mover,))

    values = {**preset, "robot": testing.robot(), "world": Crossed()} | {
        key: Pose(**preset[key]) for key in ("start", "goal")
    }
    scenario = BarnTask(**{key: value for key, value in values.items() if key != "name"}).scenario(0, 3)
    assert scenario.pedestrians == (mover,)
    assert scenario.start.compose(Pose(20.0, 0.0)).distance(scenario.goal) < 1e-9
    assert (scenario.goal_radius, scenario.time_limit, scenario.reference_length) == (1.0, 100.0, None)
    assert task().scenario(0, 1).pedestrians == ()
