"""Each term of each reward alone, against figures worked out by hand: all other weights are 0."""

from dataclasses import replace

import numpy as np
import pytest

from arena_core import VelocityLimits
from arena_core.testing import robot, transition
from arena_gym.normalized_progress_reward import NormalizedProgressReward
from arena_gym.progress_reward import ProgressReward
from arena_gym.release_reward import ReleaseReward
from arena_gym.reward_terms import (
    AmongPeople,
    ChangeOfCommand,
    ClearanceCosts,
    Consumption,
    Effort,
    Ending,
    Following,
    GoalProgress,
    Nearness,
    NearnessToPeople,
    Pace,
    PathProgress,
    Smoothness,
)
from arena_gym.switch_reward import SwitchReward

LIMITS = VelocityLimits(-0.5, 2.0, 0.8, 4.0, 2.0, 2.0, 4.0)  # no two alike, none 1
BACKWARDS = VelocityLimits(-2.0, 0.5, 0.8, 4.0, 2.0, 2.0, 4.0)
RADIUS = 0.2  # m, of the sample robot


def body(drive="omnidirectional", limits=LIMITS):
    return replace(robot(drive), limits=limits)


def step(before=None, after=None, **changes):
    """Return a step of one robot that stays where it is, with nothing near; ``before`` and ``after`` change a part."""
    sample, no = transition(1), np.zeros(1, bool)
    far = dict.fromkeys(("clearances", "clearances_people", "nearest_ranges"), np.array((9.0,)))
    way = dict.fromkeys(("goal_distances", "path_lengths_left", "path_distances"), np.array((5.0,)))
    still = {"poses": np.zeros((1, 3)), "twists": np.zeros((1, 3)), "standing_times": np.zeros(1)}
    situation = replace(sample.before, **far, **way, **still)
    parts = [
        replace(situation, **{name: np.array((value,)) for name, value in (of or {}).items()}) for of in (before, after)
    ]
    quiet = {"commands": np.zeros((1, 3)), "last_commands": np.zeros((1, 3)), "arrived": no, "collided": no}
    given = {name: np.array((value,)) for name, value in changes.items()}
    return replace(sample, before=parts[0], after=parts[1], timed_out=no, **(quiet | given))


def grouped(kinds, weights):
    """Return the groups of a reward's numbers by name; what is not given is 0, and a distance 1."""
    distances = {"safe_distance": 1.0, "people_distance": 1.0, "following_within": 1.0}
    return {
        name: kind(**{field: weights.get(field, distances.get(field, 0.0)) for field in kind.__dataclass_fields__})
        for name, kind in kinds.items()
    }


PROGRESS = {"ending": Ending, "path": PathProgress, "nearness": Nearness, "people": NearnessToPeople, "effort": Effort}
NORMALIZED = {"pace": Pace, "space": ClearanceCosts, "smoothness": ChangeOfCommand}
RELEASE = {
    "ending": Ending,
    "nearness": Nearness,
    "gain": GoalProgress,
    "effort": Consumption,
    "following": Following,
    "smoothness": Smoothness,
}
SWITCH = {"ending": Ending, "among": AmongPeople, "nearness": Nearness, "gain": GoalProgress}


def progress(given, scale=1.0, who=None, **weights):
    reward = ProgressReward(who or body(), scale, **grouped(PROGRESS, weights))
    return float(reward.reward(given)[0])


def normalized(given, scale=1.0, who=None, **weights):
    reward = NormalizedProgressReward(who or body(), **grouped(NORMALIZED, {"scale": scale, **weights}))
    return float(reward.reward(given)[0])


def release(given, who=None, **weights):
    return float(ReleaseReward(who or body(), **grouped(RELEASE, weights)).reward(given)[0])


def switch(given, standing=0.0, **weights):
    return float(SwitchReward(body(), **grouped(SWITCH, weights), standing=standing).reward(given)[0])


@pytest.mark.parametrize("earned", [progress, normalized, release, switch])
def test_a_step_without_weights_is_worth_nothing(earned):
    given = step(
        {"path_lengths_left": 6.0, "goal_distances": 7.0, "path_distances": 0.5},
        {"clearances": 0.0, "clearances_people": 0.0, "nearest_ranges": 0.0, "standing_times": 2.0},
        commands=(-0.3, 0.2, 1.0),
        collided=True,
    )
    assert earned(given) == 0.0


def test_progress_pays_for_each_metre_less_of_the_path():
    assert progress(step({"path_lengths_left": 5.0}, {"path_lengths_left": 4.7}), progress=2.0) == pytest.approx(0.6)


def test_progress_pays_for_each_metre_nearer_to_the_path():
    assert progress(step({"path_distances": 0.5}, {"path_distances": 0.8}), beside=0.7) == pytest.approx(-0.21)


def test_progress_costs_each_metre_driven_whatever_the_heading():
    given = step({"poses": (1.0, 2.0, 3.0)}, {"poses": (1.3, 1.6, -3.0)})
    assert progress(given, way=0.3) == pytest.approx(-0.3 * 0.5)


@pytest.mark.parametrize(("clearance", "cost"), [(0.39, 0.9), (0.4, 0.0), (0.41, 0.0)])
def test_progress_costs_a_step_within_safe_distance_less_one_radius(clearance, cost):
    given = step(after={"clearances": clearance})
    # written as the reward rounds it
    assert progress(step(after={"clearances": 2.0 * RADIUS}), safe_distance=3.0, near=0.9) == 0.0
    assert progress(given, safe_distance=3.0, near=0.9) == pytest.approx(-cost)


@pytest.mark.parametrize(("clearance", "cost"), [(0.0, 1.6), (0.2, 1.2), (0.8, 0.0), (1.0, 0.0), (np.inf, 0.0)])
def test_progress_costs_people_in_proportion_to_the_clearance_that_is_missing(clearance, cost):
    given = step(after={"clearances_people": clearance})
    assert progress(given, people_distance=0.8, near_people=1.6) == pytest.approx(-cost)


def test_progress_costs_time_in_each_step():
    assert progress(step(), time=0.05) == -0.05


@pytest.mark.parametrize("limits", [LIMITS, BACKWARDS])
def test_progress_costs_changes_of_the_command_as_squared_shares_of_the_greatest_speeds(limits):
    given = step(commands=(0.5, 0.0, 0.0), last_commands=(-0.5, 0.0, 0.0))
    assert progress(given, who=body(limits=limits), change_of_speed=0.4) == pytest.approx(-0.4 * (1.0 / 2.0) ** 2)
    sideways = step(commands=(0.0, 0.4, 0.0))
    assert progress(sideways, who=body(limits=limits), change_of_speed=0.4) == pytest.approx(-0.4 * (0.4 / 0.8) ** 2)
    assert progress(sideways, who=body("differential", limits), change_of_speed=0.4) == 0.0
    turned = step(commands=(0.0, 0.0, 1.0), last_commands=(0.0, 0.0, -2.0))
    assert progress(turned, who=body(limits=limits), change_of_turning=0.6) == pytest.approx(-0.6 * (3.0 / 4.0) ** 2)


def test_progress_pays_for_the_goal_and_costs_a_collision():
    assert progress(step(arrived=True), goal=20.0, collision=12.0) == 20.0
    assert progress(step(collided=True), goal=20.0, collision=12.0) == -12.0


def test_progress_adds_its_terms_and_scales_the_sum():
    given = step(
        {"path_lengths_left": 5.0, "path_distances": 0.5},
        {
            "path_lengths_left": 4.7,
            "path_distances": 0.8,
            "poses": (0.3, 0.4, 0.0),
            "clearances": 0.1,
            "clearances_people": 0.2,
        },
        commands=(1.0, 0.4, -2.0),
        arrived=True,
    )
    weights = {"goal": 20.0, "progress": 2.0, "beside": 0.7, "way": 0.3, "safe_distance": 3.0, "near": 0.9}
    weights |= {"people_distance": 0.8, "near_people": 1.6, "time": 0.05}
    weights |= {"change_of_speed": 0.4, "change_of_turning": 0.6}
    by_hand = 0.6 - 0.21 - 0.15 - 0.9 - 0.05 - 1.2 - 0.4 * 0.25 - 0.4 * 0.25 - 0.6 * 0.25 + 20.0
    assert progress(given, 0.5, **weights) == pytest.approx(0.5 * by_hand)


def test_release_weighs_progress_and_regress_apart():
    assert release(step({"goal_distances": 5.0}, {"goal_distances": 4.5}), progress=0.3, regress=0.4) == pytest.approx(
        0.15
    )
    assert release(step({"goal_distances": 5.0}, {"goal_distances": 5.5}), progress=0.3, regress=0.4) == pytest.approx(
        -0.2
    )


@pytest.mark.parametrize(("nearest", "cost"), [(0.31, 0.25), (0.33, 0.0)])
def test_release_costs_a_range_within_safe_distance_in_radii(nearest, cost):
    assert release(step(after={"nearest_ranges": nearest}), safe_distance=1.6, near=0.25) == -cost


def test_release_costs_at_the_safe_distance_itself_nothing():
    assert release(step(after={"nearest_ranges": 2.0 * RADIUS}), safe_distance=2.0, near=0.25) == 0.0


def test_release_costs_speed_and_turning_as_energy():
    given = step(commands=(0.5, 0.7, 2.0), last_commands=(0.5, 0.7, 2.0))
    assert release(given, consumption=0.02, consumption_of_turning=0.1) == pytest.approx(-0.02 * (0.5 + 0.1 * 2.0))


@pytest.mark.parametrize(("beside", "earned"), [(0.4, 0.05), (0.5, 0.05), (0.6, 0.0)])
def test_release_pays_speed_within_a_distance_of_the_path(beside, earned):
    given = step({"path_distances": beside}, {"path_distances": beside}, commands=(0.5, 0.0, 0.0))
    assert release(given, following=0.1, following_within=0.5) == pytest.approx(earned)


def test_release_weighs_coming_nearer_to_the_path_and_leaving_it_apart():
    weights = {"nearer_to_path": 0.2, "farther_from_path": 0.3}
    assert release(step({"path_distances": 0.5}, {"path_distances": 0.2}), **weights) == pytest.approx(0.06)
    assert release(step({"path_distances": 0.2}, {"path_distances": 0.5}), **weights) == pytest.approx(-0.09)


SMOOTH_FROM = 1.5 * RADIUS + 0.4  # m: safe distance and what lies beyond it


@pytest.mark.parametrize("when", ["before", "after"])
@pytest.mark.parametrize(("nearest", "counts"), [(SMOOTH_FROM + 0.01, True), (SMOOTH_FROM - 0.01, False)])
def test_release_pays_the_path_only_where_nothing_is_near_before_or_after(when, nearest, counts):
    beside = {"before": {"path_distances": 0.5}, "after": {"path_distances": 0.2}}
    beside[when]["nearest_ranges"] = nearest
    found = release(step(**beside), safe_distance=1.5, smooth_beyond=0.4, nearer_to_path=0.2)
    assert found == pytest.approx(0.06 if counts else 0.0)


def test_release_costs_fourth_powers_of_changes():
    weights = {"change_of_vx": 3.0, "change_of_vy": 5.0, "change_of_wz": 7.0}
    given = step(commands=(1.0, 0.0, 0.0), last_commands=(-1.0, 0.0, 0.0))
    assert release(given, **weights) == pytest.approx(-3.0 * 16.0 / 100.0)
    sideways = step(commands=(0.0, 2.0, 0.0))
    assert release(sideways, **weights) == pytest.approx(-5.0 * 16.0 / 100.0)
    assert release(sideways, body("differential"), **weights) == 0.0
    assert release(step(commands=(0.0, 0.0, -2.0)), **weights) == pytest.approx(-7.0 * 16.0 / 100.0)


@pytest.mark.parametrize(("vx", "cost"), [(-0.001, 0.01), (0.0, 0.0), (0.001, 0.0)])
def test_release_costs_driving_backwards(vx, cost):
    assert release(step(commands=(vx, 0.0, 0.0), last_commands=(vx, 0.0, 0.0)), reverse=0.01) == -cost


@pytest.mark.parametrize(("nearest", "counts"), [(SMOOTH_FROM + 0.01, True), (SMOOTH_FROM - 0.01, False)])
def test_release_costs_changes_only_where_nothing_is_near(nearest, counts):
    given = step(after={"nearest_ranges": nearest}, commands=(-2.0, 0.0, 0.0))
    found = release(given, safe_distance=1.5, smooth_beyond=0.4, change_of_vx=3.0, reverse=0.01)
    assert found == pytest.approx(-0.49 if counts else 0.0)


def test_release_puts_the_goal_in_the_place_of_driving_and_adds_nearness_collision_and_gain():
    given = step(
        {"goal_distances": 5.0},
        {"goal_distances": 4.5, "nearest_ranges": 0.1},
        commands=(0.5, 0.0, 0.0),
        arrived=True,
        collided=True,
    )
    weights = {"goal": 15.0, "collision": 10.0, "safe_distance": 1.6, "near": 0.25, "progress": 0.3}
    assert release(given, consumption=1.0, **weights) == pytest.approx(15.0 - 10.0 - 0.25 + 0.15)


def test_release_adds_its_terms():
    given = step(
        {"goal_distances": 5.0, "path_distances": 0.5},
        {"goal_distances": 4.5, "path_distances": 0.2},
        commands=(-2.0, 0.0, 0.0),
    )
    weights = {"progress": 0.3, "consumption": 0.02, "nearer_to_path": 0.2, "following": 0.1, "change_of_vx": 3.0}
    assert release(given, reverse=0.01, **weights) == pytest.approx(0.15 + 0.04 + 0.06 - 0.2 - 0.48 - 0.01)


AMONG = {"people_distance": 1.4, "progress_near_people": 0.1, "regress_near_people": 0.2}
NEAR_PEOPLE, AWAY = 1.4 - RADIUS - 0.01, 1.4 - RADIUS + 0.01  # m of clearance


@pytest.mark.parametrize(
    ("clearance", "goal_distance", "earned"),
    [(NEAR_PEOPLE, 4.0, 0.1), (NEAR_PEOPLE, 6.0, -0.2), (AWAY, 4.0, 0.3), (AWAY, 6.0, -0.5)],
)
def test_switch_weighs_progress_otherwise_among_people(clearance, goal_distance, earned):
    given = step(after={"clearances_people": clearance, "goal_distances": goal_distance})
    assert switch(given, progress=0.3, regress=0.5, **AMONG) == pytest.approx(earned)


@pytest.mark.parametrize(
    ("clearance", "nearest", "cost"), [(NEAR_PEOPLE, 0.31, 0.03), (NEAR_PEOPLE, 0.33, 0.0), (AWAY, 0.31, 0.0)]
)
def test_switch_costs_nearness_among_people_alone(clearance, nearest, cost):
    given = step(after={"clearances_people": clearance, "nearest_ranges": nearest})
    assert switch(given, near=0.03, safe_distance=1.6, people_distance=1.4) == -cost


def test_switch_costs_at_the_safe_distance_and_at_the_people_distance_themselves_nothing():
    at_both = step(after={"clearances_people": 1.0, "nearest_ranges": 2.0 * RADIUS})
    assert switch(at_both, near=0.03, safe_distance=2.0, people_distance=2.0) == 0.0
    gap = step(after={"clearances_people": 1.4 - RADIUS, "goal_distances": 4.0})
    assert switch(gap, progress=0.3, **AMONG) == pytest.approx(0.3)


@pytest.mark.parametrize(
    ("clearance", "stood", "cost"), [(NEAR_PEOPLE, 0.1, 0.0), (AWAY, 0.1, 0.005), (AWAY, 0.0, 0.0)]
)
def test_switch_costs_standing_away_from_people_alone(clearance, stood, cost):
    given = step(after={"clearances_people": clearance, "standing_times": stood})
    assert switch(given, 0.005, people_distance=1.4) == -cost


def test_switch_pays_for_the_goal_and_costs_a_collision_beside_progress():
    given = step(after={"goal_distances": 4.0}, arrived=True, collided=True)
    assert switch(given, progress=0.3, goal=7.0, collision=2.0) == pytest.approx(0.3 + 7.0 - 2.0)


def second(before=None, after=None, period=0.25, **changes):
    """Return a step of ``period`` s, as ``step`` does."""
    return replace(step(before, after, **changes), period=period)


@pytest.mark.parametrize("limits", [LIMITS, BACKWARDS])
def test_normalized_progress_pays_a_metre_by_the_time_it_takes_at_full_speed(limits):
    given = second({"path_lengths_left": 5.0}, {"path_lengths_left": 4.7})
    assert normalized(given, who=body(limits=limits), progress=3.0) == pytest.approx(3.0 * 0.3 / 2.0)
    back = second({"path_lengths_left": 4.7}, {"path_lengths_left": 5.0})
    assert normalized(back, who=body(limits=limits), progress=3.0) == pytest.approx(-3.0 * 0.3 / 2.0)


@pytest.mark.parametrize("speed", [0.22, 2.0, 2.78])
@pytest.mark.parametrize("period", [0.1, 0.4])
def test_normalized_progress_pays_a_second_at_full_speed_alike_for_all_robots_and_periods(speed, period):
    fast = body(limits=replace(LIMITS, vx_min=-0.1, vx_max=speed))
    given = second({"path_lengths_left": 5.0}, {"path_lengths_left": 5.0 - speed * period}, period)
    assert normalized(given, who=fast, progress=1.0, time=0.2) == pytest.approx(0.8 * period)


def test_normalized_progress_costs_time_by_the_second():
    assert normalized(second(period=0.25), time=0.2) == pytest.approx(-0.05)


@pytest.mark.parametrize(("clearance", "cost"), [(0.39, 0.9), (0.4, 0.0), (0.41, 0.0)])
def test_normalized_progress_costs_the_time_within_safe_distance_less_one_radius(clearance, cost):
    given = second(after={"clearances": clearance})
    assert normalized(given, safe_distance=3.0, near=0.9) == pytest.approx(-0.25 * cost)


@pytest.mark.parametrize(("clearance", "cost"), [(0.0, 1.6), (0.2, 1.2), (0.8, 0.0), (np.inf, 0.0)])
def test_normalized_progress_costs_the_time_in_a_person_s_space(clearance, cost):
    given = second(after={"clearances_people": clearance})
    assert normalized(given, people_distance=0.8, near_people=1.6) == pytest.approx(-0.25 * cost)


def test_normalized_progress_costs_changes_of_the_command_however_long_a_step_is():
    for period in (0.1, 0.4):
        given = second(period=period, commands=(0.5, 0.0, 0.0), last_commands=(-0.5, 0.0, 0.0))
        assert normalized(given, change_of_speed=0.4) == pytest.approx(-0.4 * (1.0 / 2.0) ** 2)
        sideways = second(period=period, commands=(0.0, 0.4, 0.0))
        assert normalized(sideways, change_of_speed=0.4) == pytest.approx(-0.4 * (0.4 / 0.8) ** 2)
        assert normalized(sideways, who=body("differential"), change_of_speed=0.4) == 0.0
        turned = second(period=period, commands=(0.0, 0.0, 1.0), last_commands=(0.0, 0.0, -2.0))
        assert normalized(turned, change_of_turning=0.6) == pytest.approx(-0.6 * (3.0 / 4.0) ** 2)


def test_normalized_progress_adds_its_terms_and_scales_the_sum():
    given = second(
        {"path_lengths_left": 5.0},
        {"path_lengths_left": 4.7, "clearances": 0.1, "clearances_people": 0.2},
        commands=(1.0, 0.0, -2.0),
        arrived=True,
        collided=True,
    )
    weights = {"goal": 20.0, "collision": 12.0, "progress": 2.0, "time": 0.2, "safe_distance": 3.0, "near": 0.9}
    weights |= {"people_distance": 0.8, "near_people": 1.6, "change_of_speed": 0.4, "change_of_turning": 0.6}
    by_hand = 0.3 - 0.25 * (0.2 + 0.9 + 1.2) - 0.4 * 0.25 - 0.6 * 0.25 + 20.0 - 12.0
    assert normalized(given, 0.5, **weights) == pytest.approx(0.5 * by_hand)
