"""Each term of CADRL's reward, against figures worked out by hand."""

from dataclasses import replace

import numpy as np
import pytest

from arena_cadrl.reward import CadrlReward
from arena_core.testing import robot, transition

DISCOUNT, PERIOD = 0.85, 0.5
STEP = 1.0 - 0.85**0.5  # what full speed earns in half a second


def earned(left=(5.0, 5.0), people=9.0, speed=None, arrived=False, collided=False):
    """Return what a step is worth in which the way left went from one figure to the other, m."""
    sample = transition(1)
    before, after = (
        replace(sample.before, path_lengths_left=np.array((way,)), clearances_people=np.array((people,)))
        for way in left
    )
    given = replace(sample, before=before, after=after, period=PERIOD)
    given = replace(given, arrived=np.array((arrived,)), collided=np.array((collided,)))
    reward = CadrlReward(robot(), speed, DISCOUNT, collision=0.6, discomfort=0.8, comfort=0.4)
    return float(reward.reward(given)[0])


def test_a_step_without_progress_is_worth_nothing():
    assert earned() == 0.0


def test_progress_is_a_share_of_what_full_speed_gives():
    assert earned((5.0, 4.5)) == pytest.approx(STEP), "1 m/s, the robot's greatest speed"
    assert earned((5.0, 4.9)) == pytest.approx(0.2 * STEP)
    assert earned((5.0, 5.1)) == pytest.approx(-0.2 * STEP)


@pytest.mark.parametrize(("speed", "share"), [(0.5, 0.4), (1.0, 0.2), (3.0, 0.2)])
def test_full_speed_may_be_less_than_the_robots_and_never_more(speed, share):
    assert earned((5.0, 4.9), speed=speed) == pytest.approx(share * STEP)


def test_progress_of_a_new_path_counts_as_twice_full_speed_at_most():
    assert earned((5.0, 3.9)) == pytest.approx(2.0 * STEP)
    assert earned((3.9, 5.0)) == pytest.approx(-2.0 * STEP)


@pytest.mark.parametrize(("clearance", "missing"), [(-0.1, 1.0), (0.0, 1.0), (0.1, 0.75), (0.4, 0.0), (0.5, 0.0)])
def test_people_cost_in_proportion_to_the_comfort_that_is_missing(clearance, missing):
    assert earned(people=clearance) == pytest.approx(-0.8 * missing * STEP)


def test_goal_and_collision_take_the_place_of_all_else():
    assert earned((5.0, 4.9), 0.1, arrived=True) == 1.0
    assert earned((5.0, 4.9), 0.1, collided=True) == -0.6
    assert earned((5.0, 4.9), 0.1, arrived=True, collided=True) == -0.6
