from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from arena_core.testing import check, component, robot, transition

RULES = [f"rule_0{k}" for k in range(6)]


def step(**changes):
    """Return a step of one robot on a free way that neither came nearer nor commanded anything; ``after_...`` changes a part of after."""
    sample = transition(1)
    still = replace(
        sample.before,
        goal_distances=np.array((5.0,)),
        path_lengths_left=np.array((6.0,)),
        path_distances=np.array((0.2,)),
        clearances=np.array((2.0,)),
        clearances_people=np.array((3.0,)),
        nearest_ranges=np.array((2.5,)),
    )
    after = replace(
        still, **{name.removeprefix("after_"): np.array((value,)) for name, value in changes.items() if name.startswith("after_")}
    )
    no = np.zeros(1, bool)
    quiet = {"commands": np.zeros((1, 3)), "last_commands": np.zeros((1, 3)), "arrived": no, "collided": no, "timed_out": no}
    given = {name: np.array((value,)) for name, value in changes.items() if not name.startswith("after_")}
    return replace(sample, before=still, after=after, **(quiet | given))


@cache
def built(preset, drive, *overrides):
    return component("reward", preset, overrides, robot=robot(drive))


def earned(preset, drive="differential", *overrides, **changes):
    return float(built(preset, drive, *overrides).reward(step(**changes))[0])


@pytest.mark.parametrize("preset", [*RULES, "progress"])
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
    energy = [earned(rule, commands=(1.0, 0.0, 2.0), last_commands=(1.0, 0.0, 2.0), after_path_distances=0.6) for rule in RULES]
    base = [earned(rule, commands=(0.0, 0.0, 0.0), after_path_distances=0.6) for rule in RULES]
    assert np.subtract(energy, base) == pytest.approx([0.0, -0.0075 * 1.002, -0.0075 * 1.002, 0.0, 0.0, 0.0])


def test_driving_on_the_path_earns_from_rule_03_on():
    on_path = [earned(rule, commands=(1.0, 0.0, 0.0), last_commands=(1.0, 0.0, 0.0)) for rule in RULES[3:]]
    assert on_path == pytest.approx([0.1] * 3)


def test_coming_nearer_to_the_path_counts_from_rule_02_on_where_nothing_is_near():
    assert [earned(rule, after_path_distances=0.1) for rule in RULES] == pytest.approx([0.0, 0.0, 0.02, 0.02, 0.02, 0.02])
    assert [earned(rule, after_path_distances=0.3) for rule in RULES] == pytest.approx([0.0, 0.0, -0.03, -0.03, -0.03, -0.03])
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


def test_progress_counts_people_nearby_in_proportion():
    caring = "progress", "differential", "reward.near_people=0.15"
    near = [earned(*caring, after_clearances_people=clearance) for clearance in (0.0, 0.25, 0.5, np.inf)]
    assert near == pytest.approx([-0.2 * (0.02 + cost) for cost in (0.15, 0.075, 0.0, 0.0)])
