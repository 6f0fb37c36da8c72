"""Tasks with a person: where the robot is to be, when it is done, and a navigator whose goal moves."""

from dataclasses import replace

import numpy as np
import pytest

from arena_core import ConfigurationError, ImpossibleScenario, Pedestrians, Pose, Twist
from arena_core.loop.guide import GOAL_MOVED
from arena_core.loop.keeping_company import CompanyKeeper
from arena_core.loop.navigator import BRAKE
from arena_core.records import WorldState, is_success
from arena_core.tasks import Company
from arena_core.testing import record, scenario
from arena_core.testing.samples import person
from tests.brain import Window, at, drive, reasons


class AnyGoal(Window):
    """A window that plans to any goal."""

    def planning_grid(self, goal, all_marks):
        return self.grid


@pytest.fixture
def any_goal():
    """Return a navigator that plans to any goal."""
    navigator = drive()
    navigator.local_map = AnyGoal()
    return navigator


FOLLOW = Company("follow", 7, 1.0, 2.0)
ACCOMPANY = Company("accompany", 7, 0.8, 1.2)
NOBODY = Pedestrians(np.empty(0, np.int32), *(np.empty((0, 2)) for _ in range(2)), np.empty(0), np.empty(0, np.int8))
LEAD = Company("lead", 7, 1.0, 4.0)


def problem(company, goal=(3.0, 0.0)):
    """Return a person 1.5 m ahead of the robot at (-1.5, 0) who walks to the goal."""
    walks = person(7, 0.0, 0.0, goal)
    return replace(scenario(goal=Pose(*goal), people=[person(3, 4.0, 4.0), walks]), company=company)


def state(robot_xy, person_xy, velocity=(0.5, 0.0)):
    """Return a world in which the person of the company is the second one."""
    places = np.array(((4.0, 4.0), person_xy))
    people = Pedestrians(
        np.array((3, 7), np.int32), places, np.array(((0.0, 0.0), velocity)), np.full(2, 0.3), np.full(2, 2, np.int8)
    )
    return WorldState(0.0, Pose(*robot_xy), Twist(0.0), people, 1.0, 1.0, False, 0.0, ())


def where(company, robot_xy, *places, velocity=(0.5, 0.0)):
    """Return the goal, x and y, after the person has been at these places."""
    keeper = CompanyKeeper(company, problem(company))
    goals = [keeper.goal(state(robot_xy, place, velocity)) for place in places]
    return pytest.approx((goals[-1].x, goals[-1].y))


def test_who_follows_is_to_be_half_way_between_nearest_and_farthest_behind():
    assert where(FOLLOW, (-1.5, 0.0), (0.0, 0.0)) == (-1.5, 0.0)
    assert where(FOLLOW, (-1.5, 0.0), (0.0, 0.0), (1.0, 0.0)) == (-0.5, 0.0)


def test_who_follows_goes_where_the_person_went_round_a_corner():
    corner = [(0.1 * k, 0.0) for k in range(11)] + [(1.0, 0.1 * k) for k in range(1, 11)]
    assert where(FOLLOW, (0.0, 0.0), *corner, velocity=(0.0, 0.5)) == (0.5, 0.0)


def test_who_accompanies_is_to_be_at_the_side_where_it_is_a_second_ahead():
    assert where(ACCOMPANY, (0.0, 1.0), (0.0, 0.0)) == (0.5, 1.0)
    assert where(ACCOMPANY, (0.0, -1.0), (0.0, 0.0)) == (0.5, -1.0)


def test_who_accompanies_takes_the_other_side_at_a_wall_and_falls_behind_between_two():
    assert where(ACCOMPANY, (0.0, 4.9), (0.0, 4.2)) == (0.5, 3.2)
    wide = Company("accompany", 7, 9.0, 9.0)
    keeper = CompanyKeeper(wide, problem(wide))
    assert keeper.goal(state((0.0, 1.0), (0.0, 0.0))).y == 0.0


def test_who_leads_goes_to_the_goal_and_waits_until_the_person_is_near_again():
    keeper = CompanyKeeper(LEAD, problem(LEAD))
    assert keeper.goal(state((2.0, 0.0), (-1.0, 0.0))) == Pose(3.0, 0.0)
    assert keeper.goal(state((2.0, 0.0), (-2.1, 0.0))) == Pose(2.0, 0.0)
    assert keeper.goal(state((2.0, 0.0), (-1.9, 0.0))) == Pose(2.0, 0.0)  # 3.9 m off: nearer, but not near
    assert keeper.goal(state((2.0, 0.0), (-1.1, 0.0))) == Pose(3.0, 0.0)


def test_a_person_who_is_not_there_stands_where_they_were_last():
    keeper = CompanyKeeper(FOLLOW, problem(FOLLOW))
    keeper.goal(state((-1.5, 0.0), (1.0, 0.0)))
    goal = keeper.goal(state((-1.5, 0.0), (np.nan, np.nan), (np.nan, np.nan)))
    assert (goal.x, goal.y) == pytest.approx((-0.5, 0.0))


def test_people_without_the_person_are_one_line():
    other = Company("follow", 3, 1.0, 2.0)
    keeper = CompanyKeeper(other, problem(other))
    alone = replace(state((0.0, 0.0), (1.0, 0.0)), pedestrians=NOBODY)
    with pytest.raises(ImpossibleScenario, match=r"person 3, with whom the robot is to keep, is not among the people"):
        keeper.goal(alone)


@pytest.mark.parametrize(
    ("company", "robot_x", "person_x", "fulfilled"),
    [
        (FOLLOW, 1.0, 2.8, True),  # the person is there, the robot behind
        (FOLLOW, 0.0, 2.8, False),  # lost on the way
        (FOLLOW, 1.0, 2.0, False),  # together, but under way
        (LEAD, 3.0, 0.0, True),
        (LEAD, 3.0, -2.0, False),
        (LEAD, 2.0, 0.0, False),
    ],
)
def test_a_task_with_a_person_is_done_where_both_have_come_to_the_end(company, robot_x, person_x, fulfilled):
    keeper = CompanyKeeper(company, problem(company))
    assert keeper.is_fulfilled(state((robot_x, 0.0), (person_x, 0.0))) is fulfilled


def test_success_is_measured_from_where_the_person_ends():
    ended = record()  # ends at the goal (1.5, 0), of 0.3 m
    ended.meta["scenario"]["goal"] = [3.5, 0.0, 0.0]
    assert not is_success(ended)
    ended.meta["scenario"]["company"] = {"manner": "follow", "person": 1, "nearest": 1.0, "farthest": 2.0}
    assert is_success(ended)
    ended.meta["scenario"]["company"]["manner"] = "lead"
    assert not is_success(ended)


def test_nearest_above_farthest_is_refused():
    with pytest.raises(ConfigurationError, match=r"^nearest is 2; allowed: up to farthest, 1 m$"):
        Company("follow", 0, 2.0, 1.0)


def told(navigator, stamp, x, goal_x):
    """Return what a navigator at (x, 0) decides that is told its goal."""
    return navigator.decide(at(x, stamp, goal=Pose(goal_x, 0.0)))


def test_a_navigator_plans_again_when_its_goal_has_moved_off_the_path_s_end(any_goal):
    assert reasons(told(any_goal, 0.0, 0.0, 2.0)) == [("replan", "start")]
    assert reasons(told(any_goal, 0.1, 0.0, 2.1)) == []
    moved = told(any_goal, 0.2, 0.0, 2.2)
    assert reasons(moved) == [("replan", GOAL_MOVED)]
    assert moved.planned.poses[-1, 0] == pytest.approx(2.2)


def test_a_robot_at_a_goal_that_moves_waits_and_has_not_arrived(any_goal):
    waiting = told(any_goal, 0.0, 1.9, 2.0)
    assert (waiting.command, waiting.arrived) == (BRAKE, False)
    assert told(any_goal, 0.1, 1.9, 3.0).command != BRAKE
