"""Critics of the user's own: one small class in Python changes the path, and a wrong one is named in one line."""

import re
import sys
import types
from importlib.metadata import EntryPoint
from pathlib import Path
from textwrap import dedent

import numpy as np
import pytest

from arena_core import ArenaError, ConfigurationError, Pose, Twist
from arena_mppi import own_critics

PAGE = Path(__file__).parents[3] / "docs" / "mppi.md"
AHEAD = [(0.1 * k, 0.0) for k in range(60)]


@pytest.fixture
def documented(monkeypatch):
    """Give the module that docs/mppi.md shows, as if it lay on the path."""
    (text,) = re.findall(r"```python\n(.*?)```", PAGE.read_text(), re.S)
    assert len(text.splitlines()) <= 15
    module = types.ModuleType("keep_right")
    monkeypatch.setitem(sys.modules, "keep_right", module)
    exec(text, module.__dict__)
    return module


@pytest.fixture
def critic(monkeypatch):
    """Give a function that makes a critic of this cost, as module:Class."""

    def make(cost):
        source = f"""
            from dataclasses import dataclass
            import numpy as np
            from arena_mppi.own_critics import Critic

            @dataclass(frozen=True)
            class Mine(Critic):
                def cost(self, rollouts, around):
                    return {cost}
        """
        module = types.ModuleType("mine")
        monkeypatch.setitem(sys.modules, "mine", module)
        exec(dedent(source), module.__dict__)
        return "critics=[{name: 'mine:Mine'}]"

    return make


def last_position(planner, observe, costmap, steps=25):
    pose, twist = Pose(0.0, 0.0), Twist(0.5)
    for k in range(steps):
        twist = planner.compute_velocity(observe(costmap(), pose, AHEAD, twist, 0.1 * k))
        pose = pose.compose(Pose(twist.vx * 0.1, 0.0, twist.wz * 0.1))
    return pose


def test_the_documented_critic_keeps_to_the_right_of_the_path(documented, build, observe, costmap):
    small = "batch_size=500"
    alone = last_position(build("jackal", "mppi", small), observe, costmap)
    right = last_position(
        build("jackal", "mppi", small, "critics=[{name: 'keep_right:KeepRight', weight: 20.0, aside: 0.4}]"),
        observe,
        costmap,
    )
    assert abs(alone.y) < 0.1
    assert -0.7 < right.y < -0.2
    assert right.x > 0.8 * alone.x


def test_a_critic_that_costs_nothing_changes_no_command(critic, build, observe, costmap):
    free = build("jackal", "mppi", critic("np.zeros(len(rollouts.poses))"))
    seen = observe(costmap((1.5, 1.7, -0.3, 0.3)), Pose(0.0, 0.0, 0.2), AHEAD, Twist(0.5))
    assert free.compute_velocity(seen) == build("jackal").compute_velocity(seen)


def test_critics_see_roll_outs_walls_and_people_in_the_map(critic, build, observe, costmap, people):
    planner = build("jackal", "mppi", critic("seen.update(r=rollouts, a=around) or np.zeros(len(rollouts.poses))"))
    seen = sys.modules["mine"].seen = {}
    here, tracks = Pose(0.4, -0.2, 0.3), people((2.0, 0.5, -1.0, 0.0))
    planner.compute_velocity(observe(costmap((1.5, 1.7, -0.3, 0.3)), here, AHEAD, Twist(0.5), tracks=tracks))
    rollouts, around = seen["r"], seen["a"]
    assert rollouts.poses.shape == rollouts.velocities.shape == (2000, 56, 3)
    assert np.abs(rollouts.poses[:, 0] - here.array()).max() < 0.15
    driven = np.hypot(*np.diff(rollouts.poses[..., :2], axis=1).transpose(2, 0, 1))
    speeds = 0.5 * (rollouts.velocities[:, 1:, 0] + rollouts.velocities[:, :-1, 0])
    np.testing.assert_allclose(driven, np.abs(speeds) * rollouts.dt, atol=1e-6)
    places = np.array([[1.6, 0.0], [1.2, 0.0], [50.0, 0.0]])
    assert around.clearances(places) == pytest.approx([0.0, 0.28, 1000.0], abs=0.06)
    assert around.people.shape == (56, 1, 3)
    assert around.people[19, 0, :2] == pytest.approx([1.0, 0.5], abs=1e-5)
    assert around.people[0, 0, 2] >= 0.3
    assert around.belief[0] > around.belief[-1] > 0.0
    assert around.observation.pose == here


def test_a_cost_of_a_million_counts_as_a_collision(critic, build, observe, costmap):
    planner = build("jackal", "mppi", critic("1e6 * (rollouts.poses[:, 10, 1] < 0.05)"))
    assert last_position(planner, observe, costmap, 15).y > 0.02


@pytest.mark.parametrize(
    ("cost", "said"),
    [
        ("np.zeros(3)", r"critics\[0\] mine:Mine returned costs of shape \(3,\); allowed: \(2000,\)"),
        ("np.full(len(rollouts.poses), np.nan)", r"mine:Mine returned costs that are not finite or negative"),
        ("-np.ones(len(rollouts.poses))", r"mine:Mine returned costs that are not finite or negative"),
        ("np.full(len(rollouts.poses), 'dear')", r"mine:Mine returned costs that are not finite or negative"),
        ("None", r"returned costs of shape \(\); allowed: \(2000,\)"),
    ],
)
def test_what_is_no_cost_is_said_in_one_line(cost, said, critic, build, observe, costmap):
    planner = build("jackal", "mppi", critic(cost))
    with pytest.raises(ArenaError, match=said):
        planner.compute_velocity(observe(costmap(), Pose(0.0, 0.0), AHEAD))


@pytest.mark.parametrize(
    ("node", "said"),
    [
        ("{name: nobody}", r"mppi: critics\[0\].name is 'nobody'; allowed: listed, module:Class"),
        ("{weight: 1}", r"critics\[0\].name is None; allowed: "),
        ("{name: 'no_module:Critic'}", r"critics\[0\].name is no_module:Critic, which cannot be imported"),
        ("{name: 'keep_right:Nobody'}", r"critics\[0\].name is keep_right:Nobody, which cannot be imported"),
        ("{name: 'math:cos'}", r"critics\[0\].name is math:cos; allowed: a frozen dataclass that is a Critic"),
        ("{name: 'keep_right:KeepRight', aside: 0.4}", r"critics\[0\] lacks weight"),
        ("{name: listed, weight: -1, aside: 0.4}", r"critics\[0\].weight is -1; allowed: >= 0"),
        ("{name: listed, weight: 1, aside: 0.4, gain: 2}", r"critics\[0\] has no parameter gain"),
    ],
)
def test_a_wrong_critic_is_refused_before_anything_runs(node, said, documented, monkeypatch, build):
    listed = EntryPoint("listed", "keep_right:KeepRight", own_critics.GROUP)
    monkeypatch.setattr(own_critics, "entry_points", lambda group: [listed])
    with pytest.raises(ConfigurationError, match=said):
        build("jackal", "mppi", f"critics=[{node}]")
