"""People among several robots: each person reacts to every robot."""

import numpy as np
import pytest

from arena_core import RobotBatch
from arena_core.testing import component
from arena_pedsim.state_ids import APPROACHING_ROBOT

FAR = (RobotBatch.FAR, RobotBatch.FAR, 0.0)
CROWDS = [
    ("social_force", ["pedestrians.reaction=yield"]),
    ("social_force", ["pedestrians.reaction=scared"]),
    ("social_force_lively", ["pedestrians.reaction=yield"]),
    ("orca", ["pedestrians.reaction=yield"]),
]


def team(*poses, radius=0.2):
    """Return one world with robots that stand at these poses; ``radius`` may be one of each."""
    return RobotBatch(np.array([poses], float), np.zeros((1, len(poses), 2)), radius)


def walk(stage, model, problem, robots, seconds=12.0):
    return np.array([crowd.positions[0] for crowd in stage.walk(model, [problem], seconds, robots)])


def across(stage):
    """Return a hall that two people cross, one from either end."""
    people = [
        stage.person(0, (2.0, 5.0), (14.0, 5.0), (2.0, 5.0)),
        stage.person(1, (14.0, 4.2), (2.0, 4.2), (14.0, 4.2)),
    ]
    return stage.scenario(stage.hall(16, 9), people)


@pytest.mark.parametrize(("name", "overrides"), CROWDS)
def test_people_do_beside_a_team_what_they_do_beside_the_one_that_is_near(stage, name, overrides):
    near = (8.0, 4.8, 0.3)
    model = component("pedestrians", name, overrides)
    alone = walk(stage, model, across(stage), stage.robots(near))
    nobody = walk(stage, model, across(stage), None)
    assert not np.array_equal(alone, nobody)
    for poses in ((near, FAR), (FAR, near), (FAR, FAR, near)):
        assert np.array_equal(walk(stage, model, across(stage), team(*poses)), alone)


@pytest.mark.parametrize(("name", "overrides"), [CROWDS[0], CROWDS[3]])
def test_people_touch_none_of_the_robots_that_stand_in_their_way(stage, name, overrides):
    model = component("pedestrians", name, overrides)
    robots = team((6.0, 4.9, 0.0), (9.5, 4.4, 0.0), (8.0, 3.3, 0.0), radius=np.array([[0.2, 0.35, 0.3]]))
    track = walk(stage, model, across(stage), robots, 30.0)
    away = np.hypot(*(track[:, :, None] - robots.poses[0, :, :2]).transpose(3, 0, 1, 2))
    assert (away.min(axis=(0, 1)) > robots.radius[0] + 0.3).all()
    assert track[:, 0, 0].max() > 13.0  # and still come through


def test_a_larger_robot_is_given_a_wider_berth(stage):
    model = component("pedestrians", "social_force", ["pedestrians.reaction=yield"])
    at = (8.0, 4.8, 0.0)
    narrow, wide = (
        np.hypot(*(walk(stage, model, across(stage), team(at, FAR, radius=np.array([[radius, 0.2]])))[:, 0] - at[:2]).T)
        for radius in (0.2, 0.6)
    )
    assert wide.min() > narrow.min() + 0.2


def test_the_curious_go_to_the_nearest_robot_they_see_and_stay_with_it(stage):
    model = component("pedestrians", "social_force", ["pedestrians.reaction=curious"])
    problem = stage.scenario(stage.hall(16, 9), [stage.person(0, (1.0, 6.5), (15.0, 6.5), (1.0, 6.5))])
    near, other = (6.0, 4.0, 0.0), (11.0, 4.0, 0.0)
    crowds = list(stage.walk(model, [problem], 25.0, team(other, near)))
    assert crowds[-1].states[0, 0] == APPROACHING_ROBOT
    assert np.hypot(*(crowds[-1].positions[0, 0] - near[:2])) <= 1.5 + 1e-3


@pytest.mark.parametrize("name", ["social_force", "orca"])
def test_worlds_of_teams_side_by_side_are_what_they_are_alone(stage, name):
    model = component("pedestrians", name, ["pedestrians.reaction=yield"])
    poses = np.array([[(8.0, 4.8, 0.0), (5.0, 4.5, 1.0)], [(6.0, 4.2, 0.0), FAR]])
    both = RobotBatch(poses, np.zeros((2, 2, 2)), 0.2)
    crowds = list(stage.walk(model, [across(stage), across(stage)], 8.0, both))
    for world in range(2):
        own = walk(stage, model, across(stage), team(*poses[world]), 8.0)
        assert np.array_equal(np.array([crowd.positions[world] for crowd in crowds]), own)
