"""Each term of GRING's reward alone, against figures worked out by hand: all other weights are 0."""

from dataclasses import replace

import numpy as np
import pytest

from arena_core.testing import robot, transition
from arena_gring.reward import GringReward

WITHOUT = dict.fromkeys(
    ("goal", "collision", "nearer", "farther", "waypoint", "people", "too_near", "standing", "turning"), 0.0
)
DISTANCES = {"spacing": 1.5, "wall_distance": 0.2, "people_distance": 0.85, "too_near_distance": 0.5}
TIMES = {"scale": 1.0, "straight_to_goal": False, "stopped_for": 0.8, "turning_from": 0.05}
GAP = 0.85 - 0.2  # m of clearance: people_distance less the sample robot's radius


def earned(before=None, after=None, arrived=False, collided=False, **weights):
    """Return what a step is worth; ``before`` and ``after`` say what is not far from everything and at rest."""
    sample = transition(1)
    far = dict.fromkeys(("clearances", "clearances_people", "nearest_ranges"), np.array((9.0,)))
    way = dict.fromkeys(("goal_distances", "path_lengths_left", "path_distances"), np.array((5.0,)))
    still = replace(sample.before, **far, **way, twists=np.zeros((1, 3)), standing_times=np.zeros(1))
    parts = [replace(still, **{k: np.array((v,)) for k, v in (of or {}).items()}) for of in (before, after)]
    given = replace(
        sample, before=parts[0], after=parts[1], arrived=np.array((arrived,)), collided=np.array((collided,))
    )
    return float(GringReward(robot(), **(WITHOUT | DISTANCES | TIMES | weights)).reward(given)[0])


def test_way_along_the_path_is_weighed_apart_from_way_back():
    assert earned(after={"path_lengths_left": 4.8}, nearer=4.5, farther=5.5) == pytest.approx(0.9)
    assert earned(after={"path_lengths_left": 5.2}, nearer=4.5, farther=5.5) == pytest.approx(-1.1)


def test_way_is_no_shorter_than_straight_to_the_goal_if_asked():
    past = {"before": {"goal_distances": 7.0}, "after": {"goal_distances": 6.4, "path_lengths_left": 4.0}}
    assert earned(**past, nearer=2.0, straight_to_goal=True) == pytest.approx(2.0 * 0.6)
    assert earned(**past, nearer=2.0) == pytest.approx(2.0 * 1.0)
    nearer = {"after": {"goal_distances": 1.0, "path_lengths_left": 4.0}}
    assert earned(**nearer, nearer=2.0, straight_to_goal=True) == pytest.approx(2.0 * 1.0)


@pytest.mark.parametrize(
    ("before", "after", "passed"), [(4.6, 4.4, 1), (4.4, 4.6, -1), (4.4, 4.2, 0), (6.1, 2.9, 3), (4.5, 4.4, 1)]
)
def test_each_waypoint_passed_counts_once_and_is_lost_again(before, after, passed):
    found = earned({"path_lengths_left": before}, {"path_lengths_left": after}, waypoint=0.8)
    assert found == pytest.approx(0.8 * passed)


@pytest.mark.parametrize(
    ("clearance", "people", "counts"),
    [(0.19, 9.0, False), (0.2, 9.0, True), (0.21, 9.0, True), (0.1, 0.1, True), (0.1, 0.11, False)],
)
def test_way_and_waypoints_count_nothing_close_to_a_wall(clearance, people, counts):
    after = {"path_lengths_left": 4.4, "clearances": clearance, "clearances_people": people}
    found = earned({"path_lengths_left": 4.6}, after, nearer=4.5, waypoint=0.8)
    assert found == pytest.approx(0.9 + 0.8 if counts else 0.0)


@pytest.mark.parametrize(
    ("stood", "turning", "cost"),
    [(0.0, 1.0, 0.0), (0.1, 0.0, 0.001), (0.1, 0.05, 0.001), (0.1, 0.06, 0.01), (0.1, -0.06, 0.01)],
)
def test_standing_costs_and_turning_on_the_spot_costs_otherwise(stood, turning, cost):
    after = {"standing_times": stood, "twists": (0.0, 0.0, turning)}
    assert earned(after=after, standing=0.001, turning=0.01) == -cost


@pytest.mark.parametrize(
    ("before", "after", "cost"),
    [
        ({}, {"clearances_people": GAP - 0.01}, 7.0),
        ({}, {"clearances_people": GAP + 0.01}, 0.0),
        ({"clearances_people": GAP - 0.01}, {"clearances_people": GAP - 0.02}, 0.0),
        ({}, {"clearances_people": GAP - 0.01, "standing_times": 0.8}, 0.0),
        ({}, {"clearances_people": GAP - 0.01, "standing_times": 0.79}, 7.0),
        ({"clearances_people": 0.3, "standing_times": 0.9}, {"clearances_people": 0.3}, 7.0),
    ],
)
def test_people_cost_once_when_they_come_near_a_robot_that_has_not_stopped(before, after, cost):
    assert earned(before, after, people=7.0) == -cost


@pytest.mark.parametrize(("people", "collision", "cost"), [(7.0, 15.0, 15.0), (15.0, 7.0, 15.0), (0.0, 15.0, 15.0)])
def test_the_dearer_of_people_and_collision_counts(people, collision, cost):
    assert earned(after={"clearances_people": 0.0}, collided=True, people=people, collision=collision) == -cost


@pytest.mark.parametrize(("clearance", "cost"), [(0.0, 0.4), (0.125, 0.3), (0.5, 0.0), (0.6, 0.0), (np.inf, 0.0)])
def test_people_nearby_go_on_costing_in_proportion_to_the_clearance_that_is_missing(clearance, cost):
    near = {"clearances_people": clearance}
    assert earned(near, near, too_near=0.4) == pytest.approx(-cost)


def test_goal_and_all_other_terms_are_added_and_scaled():
    after = {"path_lengths_left": 4.4, "clearances_people": 0.125, "standing_times": 0.1}
    weights = {"nearer": 4.5, "waypoint": 0.8, "standing": 0.001, "people": 7.0, "too_near": 0.4, "goal": 10.0}
    found = earned({"path_lengths_left": 4.6}, after, arrived=True, scale=0.1, **weights)
    assert found == pytest.approx(0.1 * (0.9 + 0.8 - 0.001 - 7.0 - 0.3 + 10.0))
