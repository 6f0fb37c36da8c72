"""A switch: actions choose planners, each of which sees what it would see in a benchmark."""

from __future__ import annotations

import numpy as np
import pytest

from arena_core import ConfigurationError
from arena_gym.building import build_parts, compose_environment
from arena_gym.environment import NavigationEnv
from arena_gym.switched_batch import SwitchedBatch
from arena_gym.training.evaluation import unseen_worlds
from arena_gym.vector_environment import NavigationVectorEnv

SWITCH = """
defaults:
  - /planner@members.pure_pursuit: pure_pursuit
  - /planner@members.orca: orca
  - /local_map@local_map: rolling
  - /tracker@tracker: kalman
  - _self_
every: 3
held: 1
members: {}
"""
WORDS = (
    "switch=two",
    "robot=jackal",
    "world=indoor",
    "reward=rule_06",
    "observation_encoder=aio",
    "task.pedestrians=3",
    "environment.worlds=2",
    "environment.problems_per_world=4",
)


@pytest.fixture
def parts(tmp_path, monkeypatch):
    """Return a function that builds parts with a switch between pure pursuit and ORCA."""
    (tmp_path / "conf" / "switch").mkdir(parents=True)
    (tmp_path / "conf" / "switch" / "two.yaml").write_text(SWITCH.lstrip())
    monkeypatch.chdir(tmp_path)
    return lambda *words: build_parts(compose_environment([*WORDS, *words]))


def test_action_chooses_who_drives_for_three_control_steps(parts):
    ways = []
    for member in (0, 1):
        batch = SwitchedBatch(parts("task.pedestrians=6"), 1)
        batch.reset([3])
        for decisions in range(1, 7):  # before any of the two meets someone, which would end the episode
            step = batch.step(np.array([member]))
            assert not step.terminated.any()
            assert batch.steps.tolist() == [3 * decisions]
        ways.append(batch.seen.poses[0].copy())
    assert np.abs(ways[0] - ways[1]).max() > 1e-3, "two members drive two ways"


def test_action_holds_for_some_decisions_but_not_in_an_evaluation(parts):
    training = parts("switch.held=5")
    for batch, steps in ((SwitchedBatch(training, 1), 15), (unseen_worlds(training.config, 1, 7, "seed").batch, 3)):
        batch.reset([3])
        batch.step(np.array([1]))
        assert batch.steps.tolist() == [steps]


@pytest.mark.slow
def test_world_of_several_is_what_it_is_alone_bit_for_bit(parts):
    random = np.random.default_rng(0)
    actions = random.integers(0, 2, (30, 2))
    both = NavigationVectorEnv(2, parts=parts("task.time_limit=4.0"))
    seen = [both.reset(seed=5)[0]]
    told = []
    for action in actions:
        step = both.step(action)
        seen.append(step[0])
        told.append(step[1:4])
    for slot in range(2):
        alone = NavigationVectorEnv(1, parts=parts("task.time_limit=4.0"))
        assert (alone.reset(seed=5 + slot)[0][0] == seen[0][slot]).all()
        for k, action in enumerate(actions):
            observations, rewards, terminated, truncated, _ = alone.step(action[slot : slot + 1])
            assert (observations[0] == seen[k + 1][slot]).all(), k
            assert (rewards[0], terminated[0], truncated[0]) == tuple(values[slot] for values in told[k])


def test_decision_ends_with_the_episode(parts):
    env = NavigationVectorEnv(2, parts=parts("task.time_limit=0.4"))
    env.reset(seed=0)
    ends = [env.step(np.zeros(2, np.int64)) for _ in range(2)]
    assert not ends[0][3].any()
    assert ends[1][3].all()
    assert ends[1][4]["final_info"]["steps"].tolist() == [4, 4], "of which the second decision saw one"


def test_rewards_of_a_decision_add_up(parts):
    whole, single = SwitchedBatch(parts(), 1), SwitchedBatch(parts("switch.every=1"), 1)
    whole.reset([1])
    single.reset([1])
    for _ in range(5):
        together = whole.step(np.array([1])).rewards[0]
        assert together == pytest.approx(sum(single.step(np.array([1])).rewards[0] for _ in range(3)))


def test_single_environment_passes_gymnasiums_own_check(parts):
    from gymnasium.utils.env_checker import check_env

    parts()
    env = NavigationEnv(overrides=list(WORDS))
    assert env.action_space.n == 2
    check_env(env, skip_render_check=True)


def test_place_without_a_member_is_refused(parts):
    batch = SwitchedBatch(parts(), 1)
    batch.reset([0])
    with pytest.raises(ConfigurationError, match=r"allowed: 0 \.\. 1"):
        batch.step(np.array([2]))


def test_member_with_another_control_period_is_refused(parts):
    with pytest.raises(ConfigurationError, match=r"switch\.members\.orca\.control_period is 0\.2; allowed: 0\.1"):
        parts("+switch.members.orca.control_period=0.2")
