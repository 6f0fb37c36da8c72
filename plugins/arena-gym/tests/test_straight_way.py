"""What a straight way pays: sums by hand."""

import math

import numpy as np
import pytest

from arena_core import ConfigurationError, Reward
from arena_core.testing import component, robot
from arena_gym.straight_way import WAY, straight_way


class PerMetre(Reward):
    """Pays ``metre`` for each metre less of the way, and takes ``step`` for each step."""

    def __init__(self, metre, step, goal=0.0):
        self.metre, self.step, self.goal = metre, step, goal

    def reward(self, transition):
        driven = transition.before.path_lengths_left - transition.after.path_lengths_left
        return self.metre * driven - self.step + self.goal * transition.arrived


def test_a_way_pays_its_metres_less_its_steps_and_the_goal():
    body = robot()
    steps = math.ceil(WAY / (body.limits.vx_max * body.control_period))
    way = straight_way(PerMetre(2.0, 0.1, 5.0), body, 1.0)
    assert way.pays == pytest.approx(2.0 * WAY - 0.1 * steps + 5.0)
    assert way.discounted == pytest.approx(way.pays)
    assert way.standing == pytest.approx(-0.1 * steps)
    assert way.time == pytest.approx(steps * body.control_period)


def test_later_rewards_are_discounted_by_decision():
    body = robot()
    steps = math.ceil(WAY / (body.limits.vx_max * body.control_period))
    way = straight_way(PerMetre(0.0, -1.0), body, 0.9, every=2)
    assert way.discounted == pytest.approx(sum(0.9 ** (step // 2) for step in range(steps)))
    assert way.sight == pytest.approx(body.limits.vx_max * body.control_period * 2 / -math.log(0.9))


def test_a_recipe_that_pays_nobody_is_one_line():
    with pytest.raises(ConfigurationError, match="allowed: rewards that pay for driving") as refused:
        straight_way(PerMetre(0.0, 0.1), robot(), 0.99).check()
    assert "\n" not in str(refused.value)
    straight_way(PerMetre(0.1, 0.1), robot(), 0.99).check()


@pytest.mark.parametrize("name", ["progress", "arrival", "smooth_driving"])
def test_the_suite_s_rewards_pay_for_driving(name):
    body = robot()
    way = straight_way(component("reward", name, robot=body), body, 0.99)
    way.check()
    assert np.isfinite([way.pays, way.standing]).all()
