"""Teams as parallel environments: PettingZoo's own tests, each robot as it is alone, and one policy for all."""

from __future__ import annotations

import numpy as np
import pytest

import arena_gym
from arena_core import ArenaError

pytest.importorskip("pettingzoo", reason="teams need the extra arena-gym[team]")

SMALL = ("environment.worlds=1", "environment.problems_per_world=3")
FORWARDS = np.array([1.0, 0.0], np.float32)
STANDING = np.array([-1.0, 0.0], np.float32)


@pytest.fixture(scope="module")
def team():
    """Give a team as it is without arguments."""
    return arena_gym.team_env()


def test_team_without_arguments_passes_the_tests_of_pettingzoo(team):
    from pettingzoo.test import parallel_api_test, parallel_seed_test

    parallel_api_test(team, num_cycles=60)
    parallel_seed_test(arena_gym.team_env, num_cycles=30)
    assert team.possible_agents == ["robot0", "robot1", "robot2", "robot3"]


def test_robots_that_touch_leave_and_those_who_stand_drive_on(team):
    agents = list(team.reset(seed=0)[0])
    driving, ends = agents[:2], {}
    while set(driving) & set(team.agents) and len(ends) < 2:
        actions = {agent: FORWARDS if agent in driving else STANDING for agent in team.agents}
        _, rewards, terminated, truncated, infos = team.step(actions)
        assert set(rewards) == set(terminated) == set(truncated) == set(infos)
        ends |= {agent: infos[agent] for agent in agents if terminated.get(agent)}
    assert set(ends) == set(driving)
    assert {end["outcome"] for end in ends.values()} == {"collision"}
    assert team.agents == agents[2:]
    standing = team.batch.snapshot.poses[:2].copy()
    for _ in range(20):
        team.step(dict.fromkeys(team.agents, STANDING))
    assert np.abs(team.batch.snapshot.poses[:2] - standing).max() < 0.5
    assert np.abs(team.batch.snapshot.twists[:2]).max() < 1e-6


def test_robot_out_of_sight_of_others_is_what_it_is_alone():
    words = [*SMALL, "task.radius=9", "task.jitter=0", "robot.lidar.range_max=3.0", "robot.lidar.noise_std=0"]
    mates = arena_gym.team_env(2, overrides=words)
    mates.reset(seed=1)
    first = mates.batch.episodes[0].problem
    assert mates.batch.episodes[1].problem.path is not first.path
    rewards = [mates.step(dict.fromkeys(mates.agents, FORWARDS))[1] for _ in range(5)]
    both = np.array([list(paid.values()) for paid in rewards])
    assert np.abs(both[:, 0] - both[:, 1]).max() < 1e-3  # ways and robots are alike but for the grid


def test_others_are_bodies_to_the_lidar_of_each(team):
    team.reset(seed=0)
    snapshot = team.batch.snapshot
    nearest = snapshot.ranges.min(axis=1)
    gaps = [np.hypot(*(np.delete(snapshot.poses, k, 0) - pose)[:, :2].T).min() for k, pose in enumerate(snapshot.poses)]
    assert (nearest < np.array(gaps)).all()


@pytest.mark.parametrize(
    ("robots", "words", "message"),
    [
        (1, {}, "task.team is 1"),
        (4, {"task": "random"}, "task has no key team"),
        (4, {"task": "patrol"}, "its robots run errands"),
        (4, {"overrides": ["task.teammates_robot=turtlebot3"]}, "teams of one type"),
        (4, {"overrides": ["privileged=true"]}, "privileged is true"),
        (4, {"colour": "red"}, "colour"),
    ],
)
def test_teams_that_cannot_be_are_refused_in_one_line(robots, words, message):
    with pytest.raises(ArenaError, match=message) as refusal:
        arena_gym.team_env(robots, **words).reset(seed=0)
    assert "\n" not in str(refusal.value)


def test_robot_without_an_action_is_named(team):
    team.reset(seed=0)
    with pytest.raises(ArenaError, match="robot3 has no action"):
        team.step(dict.fromkeys(team.agents[:3], FORWARDS))


def test_single_environment_refuses_the_problems_of_teams():
    import gymnasium

    import arena_gym.envs  # noqa: F401 - registers them

    env = gymnasium.make("arena/Navigation-v0", world="empty", task="antipodal", overrides=SMALL)
    with pytest.raises(ArenaError, match="has 4 robots; allowed here: 1"):
        env.reset(seed=0)


def test_one_policy_learns_from_all_robots_of_two_teams():
    pytest.importorskip("torch", reason="training needs the extra arena-gym[train]")
    from stable_baselines3 import PPO

    from arena_gym.training.team_vec_env import TeamVecEnv

    words = [*SMALL, "task.time_limit=4", "task.radius=2.5"]
    robots = TeamVecEnv([arena_gym.team_env(3, overrides=words) for _ in range(2)], 0)
    assert robots.num_envs == 6
    learner = PPO("MlpPolicy", robots, n_steps=48, batch_size=96, n_epochs=1, seed=0, device="cpu")
    before = [weight.detach().clone() for weight in learner.policy.parameters()]
    learner.learn(500)
    assert any((old != new).any() for old, new in zip(before, learner.policy.parameters(), strict=True))
    lengths = [episode["l"] for episode in learner.ep_info_buffer]
    assert len(lengths) >= 6
    assert max(lengths) <= 41


def test_robot_that_waits_for_its_team_sees_zeros_and_ends_with_it():
    pytest.importorskip("torch", reason="training needs the extra arena-gym[train]")
    from arena_gym.training.team_vec_env import TeamVecEnv

    robots = TeamVecEnv([arena_gym.team_env(3, overrides=[*SMALL, "task.time_limit=8"])], 0)
    robots.reset()
    actions = np.array([FORWARDS, FORWARDS, STANDING])
    for _ in range(200):
        observations, rewards, dones, infos = robots.step(actions)
        if dones.any():
            break
    assert dones.tolist() == [True, True, False]
    assert not observations[:2].any()
    assert {info["outcome"] for info in infos[:2]} == {"collision"}
    observations, rewards, dones, _ = robots.step(actions)
    assert not observations[:2].any()
    assert not rewards[:2].any()
    assert not dones.any()
    while not dones.any():
        observations, rewards, dones, infos = robots.step(actions)
    assert dones.all()
    assert infos[2]["TimeLimit.truncated"]
    assert "episode" not in infos[0]
    assert observations.any(axis=1).all()
