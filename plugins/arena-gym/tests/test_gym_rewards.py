from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from arena_core.testing import check, component, robot, transition

RULES = [f"rule_0{k}" for k in range(6)]


def step(**changes):
    """Return a step of one robot on a free way that neither came nearer nor commanded anything.

    ``after_...`` changes a part of after, ``both_...`` of before too.
    """
    sample = transition(1)
    still = replace(
        sample.before,
        goal_distances=np.array((5.0,)),
        path_lengths_left=np.array((6.0,)),
        path_distances=np.array((0.2,)),
        clearances=np.array((2.0,)),
        clearances_people=np.array((3.0,)),
        nearest_ranges=np.array((2.5,)),
        standing_times=np.zeros(1),
        twists=np.zeros((1, 3)),
    )
    still = replace(
        still, **{n.removeprefix("both_"): np.array((value,)) for n, value in changes.items() if n.startswith("both_")}
    )
    after = replace(
        still,
        **{n.removeprefix("after_"): np.array((value,)) for n, value in changes.items() if n.startswith("after_")},
    )
    no = np.zeros(1, bool)
    quiet = {
        "commands": np.zeros((1, 3)),
        "last_commands": np.zeros((1, 3)),
        "arrived": no,
        "collided": no,
        "timed_out": no,
    }
    given = {name: np.array((value,)) for name, value in changes.items() if not name.startswith(("after_", "both_"))}
    return replace(sample, before=still, after=after, **(quiet | given))


@cache
def built(preset, drive, *overrides):
    return component("reward", preset, overrides, robot=robot(drive))


def earned(preset, drive="differential", *overrides, **changes):
    return float(built(preset, drive, *overrides).reward(step(**changes))[0])


@pytest.mark.parametrize("preset", [*RULES, "progress", "normalized_progress", "gring", "rule_06", "rule_07"])
@pytest.mark.parametrize("drive", ["differential", "omnidirectional", "ackermann"])
def test_rewards_hold_their_contract(preset, drive):
    assert check("reward", component("reward", preset, robot=robot(drive)), robot(drive))


@pytest.mark.parametrize("rule", RULES)
def test_every_rule_has_the_base_terms(rule):
    assert earned(rule) == 0.0
    assert earned(rule, after_goal_distances=4.0) == pytest.approx(0.3)
    assert earned(rule, after_goal_distances=6.0) == pytest.approx(-0.4)
    assert earned(rule, collided=True, after_nearest_ranges=0.0) == pytest.approx(-10.25)
    assert earned(rule, after_nearest_ranges=1.61 * robot().footprint.radius) == 0.0
    assert earned(rule, after_nearest_ranges=1.59 * robot().footprint.radius) == -0.25


@pytest.mark.parametrize("rule", RULES)
def test_reaching_the_goal_takes_the_place_of_the_terms_before_it(rule):
    assert earned(rule, arrived=True, commands=(1.0, 0.0, 1.0), after_goal_distances=4.0) == pytest.approx(15.3)


def test_energy_counts_in_rules_01_and_02():
    energy = [
        earned(rule, commands=(1.0, 0.0, 2.0), last_commands=(1.0, 0.0, 2.0), after_path_distances=0.6)
        for rule in RULES
    ]
    base = [earned(rule, commands=(0.0, 0.0, 0.0), after_path_distances=0.6) for rule in RULES]
    assert np.subtract(energy, base) == pytest.approx([0.0, -0.0075 * 1.002, -0.0075 * 1.002, 0.0, 0.0, 0.0])


def test_driving_on_the_path_earns_from_rule_03_on():
    on_path = [earned(rule, commands=(1.0, 0.0, 0.0), last_commands=(1.0, 0.0, 0.0)) for rule in RULES[3:]]
    assert on_path == pytest.approx([0.1] * 3)


def test_coming_nearer_to_the_path_counts_from_rule_02_on_where_nothing_is_near():
    assert [earned(rule, after_path_distances=0.1) for rule in RULES] == pytest.approx(
        [0.0, 0.0, 0.02, 0.02, 0.02, 0.02]
    )
    assert [earned(rule, after_path_distances=0.3) for rule in RULES] == pytest.approx(
        [0.0, 0.0, -0.03, -0.03, -0.03, -0.03]
    )
    assert earned("rule_05", after_path_distances=0.1, after_nearest_ranges=0.1) == pytest.approx(-0.25)


def test_sudden_changes_and_reversing_cost_in_rule_05():
    jump = earned("rule_05", commands=(1.0, 0.0, 1.0), after_path_distances=0.2)
    assert jump == pytest.approx(0.1 - (3.0 + 2.0) / 100.0)
    assert earned("rule_05", commands=(-1e-3, 0.0, 0.0)) == pytest.approx(-1e-4 - 1e-6, rel=1e-3)
    assert earned("rule_05", "omnidirectional", commands=(0.0, 1.0, 0.0)) == pytest.approx(-0.03)


def test_progress_counts_the_way_left_and_undoes_what_is_lost():
    forth, back = earned("progress", after_path_lengths_left=5.5), earned("progress", after_path_lengths_left=6.5)
    assert forth == pytest.approx(0.2 * (0.5 - 0.02))
    assert forth + back == pytest.approx(-0.2 * 2 * 0.02), "to and fro earns nothing but the cost of time"
    assert earned("progress", collided=True) == pytest.approx(-0.2 * 15.02)
    assert earned("progress", arrived=True) == pytest.approx(0.2 * 14.98)
    assert earned("progress", after_clearances=0.5 * robot().footprint.radius) == pytest.approx(-0.2 * 0.17)


def test_progress_may_make_each_metre_cost():
    there = {"both_poses": (0.0, 0.0, 0.0), "after_poses": (0.3, 0.4, 0.0)}
    assert earned("progress", "differential", "reward.way=0.3", **there) == pytest.approx(
        earned("progress", **there) - 0.2 * 0.3 * 0.5
    )


def test_progress_counts_people_nearby_in_proportion():
    caring = "progress", "differential", "reward.near_people=0.15"
    near = [earned(*caring, after_clearances_people=clearance) for clearance in (0.0, 0.25, 0.5, np.inf)]
    assert near == pytest.approx([-0.2 * (0.02 + cost) for cost in (0.15, 0.075, 0.0, 0.0)])


NEAR_PEOPLE = 0.85 - 0.2 - 0.01  # m of clearance: 0.85 m from the centre of a robot of 0.2 m radius, less a little


def test_gring_earns_the_way_and_each_waypoint_on_it_once():
    forth, back = (
        earned("gring", after_path_lengths_left=5.8),
        earned("gring", both_path_lengths_left=5.8, after_path_lengths_left=6.0),
    )
    assert forth == pytest.approx(0.1 * (4.5 * 0.2 + 0.8)), "the waypoint 6 m before the goal is passed"
    assert back == pytest.approx(-0.1 * (5.5 * 0.2 + 0.8))
    assert earned("gring", both_path_lengths_left=5.8, after_path_lengths_left=5.6) == pytest.approx(0.1 * 4.5 * 0.2)
    assert earned("gring", arrived=True) == pytest.approx(1.0)


def test_gring_may_count_the_way_straight_to_the_goal_where_it_is_longer():
    straight = "gring", "differential", "reward.straight_to_goal=true"
    past = {"both_path_lengths_left": 0.0, "both_goal_distances": 2.0, "after_goal_distances": 1.5}
    assert earned("gring", **past) == 0.0
    assert earned(*straight, **past) == pytest.approx(0.1 * 4.5 * 0.5)
    assert earned(*straight, after_path_lengths_left=5.8) == earned("gring", after_path_lengths_left=5.8)


def test_gring_earns_no_way_close_to_a_wall_but_among_people():
    close = {"after_path_lengths_left": 5.8, "after_clearances": 0.1}
    assert earned("gring", **close) == 0.0
    assert earned("gring", **close, both_clearances_people=0.1, both_standing_times=1.0) == pytest.approx(
        0.1 * (0.9 + 0.8 - 0.001)
    )


def test_gring_pays_once_for_people_it_has_not_stopped_for():
    assert earned("gring", after_clearances_people=NEAR_PEOPLE) == pytest.approx(-0.7)
    assert earned("gring", both_clearances_people=NEAR_PEOPLE) == 0.0, "it was near before"
    assert earned("gring", after_clearances_people=NEAR_PEOPLE + 0.02) == 0.0
    stopped = earned("gring", both_standing_times=0.9, after_clearances_people=NEAR_PEOPLE)
    assert stopped == pytest.approx(-0.0001)
    driven_on = earned("gring", both_standing_times=0.9, both_clearances_people=NEAR_PEOPLE, after_standing_times=0.0)
    assert driven_on == pytest.approx(-0.7), "who drives on among people pays"


def test_gring_may_go_on_paying_for_people_nearby():
    careful = "gring", "differential", "reward.too_near=0.15"
    near = [earned(*careful, both_clearances_people=clearance) for clearance in (0.0, 0.25, 0.5, np.inf)]
    assert near == pytest.approx([-0.1 * cost for cost in (0.15, 0.075, 0.0, 0.0)])


def test_gring_pays_the_worse_of_people_and_collision():
    assert earned("gring", collided=True) == pytest.approx(-1.5)
    assert earned("gring", collided=True, after_clearances_people=0.0) == pytest.approx(-1.5)


def test_gring_pays_more_for_turning_on_the_spot_than_for_standing():
    assert earned("gring", after_standing_times=0.1) == pytest.approx(-0.0001)
    assert earned("gring", after_standing_times=0.1, after_twists=(0.0, 0.0, -1.0)) == pytest.approx(-0.001)
    assert earned("gring", after_twists=(0.5, 0.0, 1.0)) == 0.0


def test_rule_06_has_the_base_terms_with_weights_of_its_own():
    assert earned("rule_06", after_goal_distances=4.0) == pytest.approx(0.05)
    assert earned("rule_06", after_goal_distances=6.0) == pytest.approx(-0.1)
    assert earned("rule_06", collided=True, after_nearest_ranges=0.0) == pytest.approx(-2.02)
    assert earned("rule_06", arrived=True) == pytest.approx(3.0)


def test_rule_07_forgives_detours_and_standing_near_people_alone():
    near = {"after_clearances_people": 1.1}
    assert earned("rule_07", after_goal_distances=6.0) == pytest.approx(-0.5)
    assert earned("rule_07", after_goal_distances=6.0, **near) == 0.0
    assert earned("rule_07", after_standing_times=0.1) == pytest.approx(-0.005)
    assert earned("rule_07", after_standing_times=0.1, **near) == 0.0
    assert (
        earned("rule_07", after_goal_distances=4.0, **near)
        == earned("rule_07", after_goal_distances=4.0)
        == pytest.approx(0.1)
    )
    assert earned("rule_07", after_nearest_ranges=0.1) == 0.0
    assert earned("rule_07", after_nearest_ranges=0.1, **near) == pytest.approx(-0.03)
    assert earned("rule_07", collided=True) == pytest.approx(-3.0)
    assert earned("rule_07", arrived=True) == pytest.approx(3.0)
