"""What a straight way pays: sums by hand."""

import math

import numpy as np
import pytest

from arena_core import ConfigurationError, Reward
from arena_core.testing import component, robot
from arena_gym.straight_way import WAY, Decisions, straight_way


class PerMetre(Reward):
    """Pays ``metre`` for each metre less of the way, and takes ``step`` for each step and ``collision`` for one."""

    def __init__(self, metre, step, goal=0.0, collision=0.0):
        self.metre, self.step, self.goal, self.collision = metre, step, goal, collision

    def reward(self, transition):
        driven = transition.before.path_lengths_left - transition.after.path_lengths_left
        ends = self.goal * transition.arrived - self.collision * transition.collided
        return self.metre * driven - self.step + ends


def steps_of(body):
    return math.ceil(WAY / (body.limits.vx_max * body.control_period))


def test_a_way_pays_its_metres_less_its_steps_and_the_goal():
    body = robot()
    steps, metre = steps_of(body), body.limits.vx_max * body.control_period
    way = straight_way(PerMetre(2.0, 0.1, 5.0, 7.0), body, Decisions(1.0, every=3))
    assert way.driving.in_all == pytest.approx(2.0 * WAY - 0.1 * steps + 5.0)
    assert way.driving.discounted == pytest.approx(way.driving.in_all)
    assert way.decision == pytest.approx(3.0 * (2.0 * metre - 0.1))
    assert way.standing.in_all == pytest.approx(-0.1 * steps)
    assert way.collision == pytest.approx(2.0 * metre - 0.1 - 7.0)
    assert way.time == way.stood == pytest.approx(steps * body.control_period)


def test_standing_lasts_as_long_as_a_recipe_lets_a_robot_stand():
    body = robot()
    way = straight_way(PerMetre(2.0, 0.1), body, Decisions(1.0, standing_to_end=3 * body.control_period))
    assert way.standing.in_all == pytest.approx(-0.3)
    assert way.stood == pytest.approx(3 * body.control_period)


def test_later_rewards_are_discounted_by_decision():
    body = robot()
    way = straight_way(PerMetre(0.0, -1.0), body, Decisions(0.9, every=2))
    assert way.driving.discounted == pytest.approx(sum(0.9 ** (step // 2) for step in range(steps_of(body))))
    assert way.sight == pytest.approx(body.limits.vx_max * body.control_period * 2 / -math.log(0.9))


@pytest.mark.parametrize(
    ("reward", "decisions", "better"),
    [
        (PerMetre(0.0, 0.1), Decisions(0.99), "standing"),
        (PerMetre(0.1, 0.1), Decisions(0.99, standing_to_end=0.1), "standing"),
        (PerMetre(0.1, 0.1, goal=1000.0), Decisions(0.5, standing_to_end=0.1), "standing, discounted"),
        (PerMetre(0.1, 0.1, collision=-1000.0), Decisions(0.99), "a collision"),
    ],
)
def test_a_recipe_that_pays_nobody_is_one_line(reward, decisions, better):
    with pytest.raises(ConfigurationError, match=rf"pays nobody: driving earns no more than {better} \(") as refused:
        straight_way(reward, robot(), decisions).check()
    assert "allowed: rewards that pay for driving" in str(refused.value)
    assert "\n" not in str(refused.value)


def test_a_recipe_that_pays_is_allowed():
    straight_way(PerMetre(0.1, 0.1, collision=10.0), robot(), Decisions(0.99)).check()


@pytest.mark.parametrize("name", ["progress", "normalized_progress", "arrival", "smooth_driving"])
def test_the_suite_s_rewards_pay_for_driving(name):
    body = robot()
    way = straight_way(component("reward", name, robot=body), body, Decisions(0.99))
    way.check()
    assert np.isfinite([way.driving.in_all, way.standing.in_all]).all()


@pytest.mark.parametrize("name", ["turtlebot3", "jackal", "robotino"])
def test_normalized_progress_pays_a_tenth_of_a_second_for_each_second_and_the_goal(name):
    body = component("robot", name)
    reward = component("reward", "normalized_progress", ["reward.change_of_speed=0"], robot=body)
    way = straight_way(reward, body, Decisions(1.0))
    assert way.driving.in_all == pytest.approx(0.1 * (WAY / body.limits.vx_max - 0.9 * way.time + 10.0))
    assert way.standing.in_all == pytest.approx(-0.09 * way.time)


def test_arriving_and_driving_on_are_worth_what_they_pay():
    body = robot()
    metre = body.limits.vx_max * body.control_period
    way = straight_way(PerMetre(2.0, 0.1, 5.0), body, Decisions(0.9, every=2))
    assert way.driving_on == pytest.approx(2.0 * (2.0 * metre - 0.1) / (1.0 - 0.9))
    last = WAY - (steps_of(body) - 1) * metre
    assert way.arriving == pytest.approx(2.0 * last - 0.1 + 5.0)


@pytest.mark.parametrize("name", ["turtlebot3", "jackal", "robotino"])
def test_normalized_progress_pays_more_for_arriving_than_for_driving_on(name):
    """Else a robot goes round: where its path is new, the way that it lost is no loss."""
    body = component("robot", name)
    gamma = math.exp(-body.control_period / 60.0)
    way = straight_way(component("reward", "normalized_progress", robot=body), body, Decisions(gamma))
    assert way.arriving > way.driving_on
