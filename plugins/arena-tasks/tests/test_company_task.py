"""Tasks with people: who goes ahead of whom, who has room, and the same problems for every planner."""

from functools import cache

import numpy as np
import pytest

from arena_core import ConfigurationError, ImpossibleScenario, OccupancyGrid, Pose, World, WorldSource
from arena_core.testing import component, robot

BODY = robot()  # 1 m/s


class Hall(WorldSource):
    """A walled hall with a rack."""

    def __init__(self, size=20.0):
        data = np.zeros((round(size * 10),) * 2, np.int8)
        data[[0, -1]] = data[:, [0, -1]] = 100
        data[60:120, 80:90] = 100
        self._world = World("hall", OccupancyGrid(data, 0.1, Pose(0.0, 0.0)))

    def world(self, seed, index):
        return self._world


@cache
def task(name, *words, size=20.0):
    return component("task", name, ["task.random.pedestrians=4", *words], robot=BODY, world=Hall(size))


@pytest.mark.parametrize("name", ["follow", "accompany", "lead"])
def test_robot_and_person_start_together_on_their_way_apart_from_others(name):
    for index in range(3):
        drawn = task(name).scenario(5, index)
        assert drawn.name == f"{name}/{index:04d}"
        assert drawn.company.manner == name
        (person,) = [each for each in drawn.pedestrians if each.id == drawn.company.person]
        assert person.waypoints_xy.tolist() == [[drawn.goal.x, drawn.goal.y]]
        assert person.desired_speed == pytest.approx(0.7)
        away = np.hypot(*(person.position_xy - (drawn.start.x, drawn.start.y)))
        assert away <= drawn.company.distance + 1e-6
        assert away > 0.8 * drawn.company.distance
        others = [each for each in drawn.pedestrians if each is not person]
        assert min(np.hypot(*(each.position_xy - person.position_xy)) for each in others) >= 0.9
        assert len(others) == 4


def test_who_follows_starts_behind_and_who_leads_ahead():
    for name, robot_is_ahead in (("follow", False), ("accompany", False), ("lead", True)):
        drawn = task(name).scenario(1, 0)
        person = drawn.pedestrians[-1].position_xy
        facing = (person[0] - drawn.start.x) * np.cos(drawn.start.theta) + (person[1] - drawn.start.y) * np.sin(
            drawn.start.theta
        )
        assert bool(facing < 0.0) == robot_is_ahead


def test_only_who_is_led_asks_the_robot_to_lead():
    asks = {name: task(name).scenario(0, 0).pedestrians[-1].behaviour for name in ("follow", "accompany", "lead")}
    assert asks["follow"] == asks["accompany"] == {}
    assert asks["lead"]["requesting_guide_probability"] == 1.0


def test_problems_are_functions_of_seed_and_number():
    first, again, other = (task("follow").scenario(seed, 2) for seed in (3, 3, 4))
    assert first.start == again.start
    assert first.start != other.start


def test_the_place_in_the_group_is_free_and_faces_the_middle():
    drawn = task("join_group").scenario(2, 1)
    members = np.array([each.position_xy for each in drawn.pedestrians if each.behaviour.get("group") == "talk"])
    assert len(members) == 3
    circle = np.vstack((members, (drawn.goal.x, drawn.goal.y)))
    middle = circle.mean(axis=0)
    radii = np.hypot(*(circle - middle).T)
    assert radii == pytest.approx(np.full(4, 1.5 * 4 / (2.0 * np.pi)))
    facing = middle - circle[-1]
    assert np.arctan2(facing[1], facing[0]) == pytest.approx(drawn.goal.theta)
    nearest = np.hypot(*(circle - (drawn.start.x, drawn.start.y)).T)
    assert nearest.argmin() == 3  # the robot comes to its place from outside
    others = np.array([each.position_xy for each in drawn.pedestrians if "group" not in each.behaviour])
    assert np.hypot(*(others - middle).T).min() >= radii[0] + 0.3 + 0.3


@pytest.mark.parametrize(
    ("name", "words", "message"),
    [
        ("follow", "task.company.nearest=3", "task.company.nearest is 3; allowed: up to farthest, 2 m"),
        ("lead", "task.random.name=scenario", "task.random"),
        ("join_group", "task.group.members=0", "task.group.members is 0"),
    ],
)
def test_values_that_cannot_be_are_one_line(name, words, message):
    with pytest.raises(ConfigurationError, match=message):
        task(name, words)


def test_a_world_without_room_is_impossible_and_says_so():
    with pytest.raises(ImpossibleScenario, match="no room for its people was found in 60 problems"):
        task("join_group", "task.group.spacing=20").scenario(0, 0)
