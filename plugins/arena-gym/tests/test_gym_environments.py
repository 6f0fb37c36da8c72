import warnings
from dataclasses import replace

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import arena_gym.envs  # noqa: F401 - registers the environments
from arena_core import ConfigurationError, InvalidCommand
from arena_gym.environment import NavigationEnv
from arena_gym.vector_environment import NavigationVectorEnv

SMALL = [
    "world.width=8",
    "world.height=8",
    "environment.worlds=2",
    "environment.problems_per_world=3",
    "task.pedestrians=2",
]
SHORT = [*SMALL, "task.time_limit=2.0", "task.goal_radius=0.3"]
ALL = ["randomization.lidar_noise.high=0.1", "randomization.latency.high=2", "randomization.people={low: 0, high: 2}"]


def driven(env, seed, actions):
    """Return everything a single environment gives on these actions, reset at each end."""
    rows = [(env.reset(seed=seed)[0], 0.0, False, False)]
    for action in actions:
        observation, reward, terminated, truncated, _ = env.step(action)
        if terminated or truncated:
            observation = env.reset()[0]
        rows.append((observation, reward, terminated, truncated))
    return rows


@pytest.mark.parametrize("robot", ["jackal", "robotino", "jackal_ackermann"])
def test_gymnasium_finds_nothing_wrong(robot):
    env = gymnasium.make("arena/Navigation-v0", robot=robot, overrides=SMALL)
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "The environment .* is different from the unwrapped version")
        check_env(env.unwrapped)
    env.close()


@pytest.mark.parametrize("observation", ["rosnav", "rosnav_sectors", "gring"])
@pytest.mark.parametrize("reward", ["rule_05", "progress"])
def test_slot_of_a_batch_is_what_it_is_alone(observation, reward):
    choices = {"robot": "turtlebot3", "observation": observation, "reward": reward, "overrides": SHORT + ALL}
    envs, alone = NavigationVectorEnv(5, **choices), NavigationEnv(**choices)
    actions = np.random.default_rng(0).uniform(-1.0, 1.0, (45, 5, 2)).astype(np.float32)
    rows = [(envs.reset(seed=3)[0], np.zeros(5), np.zeros(5, bool), np.zeros(5, bool))] + [
        envs.step(a)[:4] for a in actions
    ]
    assert sum(row[3].sum() for row in rows) >= 10, "episodes end and begin again on the way"
    for slot in (0, 4):
        for together, single in zip(rows, driven(alone, 3 + slot, actions[:, slot]), strict=True):
            assert (together[0][slot] == single[0]).all()
            assert tuple(part[slot] for part in together[1:]) == single[1:]
    assert all(np.isfinite(row[0]).all() and np.isfinite(row[1]).all() for row in rows)


def test_same_seed_gives_the_same_trajectory_and_another_seed_another():
    actions = np.random.default_rng(1).uniform(-1.0, 1.0, (30, 2)).astype(np.float32)
    first, again, other = (driven(NavigationEnv(overrides=SHORT + ALL), seed, actions) for seed in (7, 7, 8))
    assert all((a[0] == b[0]).all() and a[1:] == b[1:] for a, b in zip(first, again, strict=True))
    assert any((a[0] != b[0]).any() for a, b in zip(first, other, strict=True))


def test_make_vec_gives_the_vectorised_environment_with_final_observations():
    envs = gymnasium.make_vec("arena/Navigation-v0", num_envs=3, overrides=SHORT, reward="progress")
    assert isinstance(envs.unwrapped, NavigationVectorEnv)
    envs.reset(seed=0)
    for _ in range(20):
        observations, _, terminated, truncated, infos = envs.step(np.full((3, 2), -1.0, np.float32))
    assert truncated.all()
    assert not terminated.any()
    assert infos["final_info"]["outcome"].tolist() == ["time_out"] * 3
    assert infos["final_info"]["steps"].tolist() == [20] * 3
    assert all(
        final.shape == observations[k].shape and (final != observations[k]).any()
        for k, final in enumerate(infos["final_obs"])
    )
    assert infos["_final_obs"].all()
    assert observations in envs.observation_space


@pytest.mark.parametrize(("to_end", "ends"), [(1, True), (2, False), (None, False)])
def test_so_many_collisions_end_an_episode(to_end, ends):
    env = NavigationEnv(
        overrides=[*SMALL, f"environment.collisions_to_end={'null' if to_end is None else to_end}"], reward="rule_00"
    )
    env.reset(seed=0)
    rewards = []
    for _ in range(60):
        _, reward, terminated, _, info = env.step(np.array((1.0, 0.0), np.float32))  # into a wall, and against it
        rewards.append(reward)
        if terminated:
            break
    assert terminated == ends
    assert min(rewards) < -9.0
    assert not ends or info["outcome"] == "collision"


def test_robot_that_leaves_a_wall_and_meets_it_again_has_collided_twice():
    env = NavigationEnv(overrides=[*SMALL, "environment.collisions_to_end=2", "action.vx_min=null"], reward="rule_00")
    env.reset(seed=0)
    terminated, steps = False, 0
    while not terminated and steps < 100:
        forwards = steps % 40 < 30
        _, _, terminated, _, info = env.step(np.array((1.0 if forwards else -1.0, 0.0), np.float32))
        steps += 1
    assert info["outcome"] == "collision"
    assert info["collisions"] == 2


def test_arrival_ends_an_episode_with_success():
    env = NavigationEnv(
        overrides=[
            *SMALL,
            "task.goal_radius=3.0",
            "task.trip.min_distance=3.05",
            "task.trip.max_distance=4.0",
            "task.pedestrians=0",
        ]
    )
    ends = []
    for seed in range(6):
        env.reset(seed=seed)
        for _ in range(30):
            _, reward, terminated, _, info = env.step(np.array((0.5, 0.0), np.float32))
            if terminated:
                ends.append((info["outcome"], info["success"], reward > 14.0))
                break
    assert ("goal_reached", True, True) in ends


def test_episodes_after_a_new_level_are_of_that_level():
    envs = NavigationVectorEnv(
        2, task="staged", overrides=[o for o in SMALL if "pedestrians" not in o] + ["task.random.time_limit=1.0"]
    )
    assert envs.reset(seed=0)[1]["stage"].tolist() == [0, 0]
    envs.set_stage(2)
    for _ in range(10):
        infos = envs.step(np.full((2, 2), -1.0, np.float32))[4]
    assert infos["final_info"]["stage"].tolist() == [0, 0]
    assert infos["stage"].tolist() == [2, 2]
    with pytest.raises(ConfigurationError, match=r"stage is 7; allowed: 0 \.\. 6"):
        envs.set_stage(7)


def test_people_who_come_later_leave_no_gap_in_observations_and_rewards():
    env = NavigationEnv(overrides=SMALL, reward="progress")
    pool = env.batch.parts.pool
    for index in range(pool.size):
        problem = pool.problem(index)
        people = tuple(replace(person, behaviour={"spawn_time": 0.5}) for person in problem.scenario.pedestrians)
        pool._problems[index] = replace(problem, scenario=replace(problem.scenario, pedestrians=people))
    observation, _ = env.reset(seed=0)
    there = []
    for _ in range(12):
        there.append(np.isfinite(env.batch.parts.simulator._crowd.positions).any())
        assert np.isfinite(observation).all()
        observation, reward, _, _, _ = env.step(np.array((-1.0, 0.0), np.float32))
        assert np.isfinite(reward)
    assert not there[0]


def test_action_that_is_not_finite_is_refused():
    env = NavigationEnv(overrides=SMALL)
    env.reset(seed=0)
    with pytest.raises(InvalidCommand, match="not finite"):
        env.step(np.array((np.nan, 0.0), np.float32))


@pytest.mark.parametrize(
    ("override", "message"),
    [
        ("action.vx_max=5.0", r"action.vx_max is 5; allowed: 0 .. 2"),
        ("randomization.latency={low: 3, high: 1}", "low is 3, above high, 1"),
        ("randomization.speed_share.low=0.0", "speed_share"),
        ("environment.worlds=0", "environment.worlds is 0"),
        ("reward=rule_99", "rule_99"),
        ("reward.gaol=3", "reward has no key gaol; did you mean goal"),
    ],
)
def test_bad_settings_are_refused_in_one_line(override, message):
    with pytest.raises(ConfigurationError, match=message) as error:
        NavigationEnv(overrides=[*SMALL, override])
    assert "\n" not in str(error.value)


def test_policy_that_drives_to_near_waypoints_arrives_and_earns_more_than_one_that_stands():
    near = [
        "waypoints.d_ahead=0.6",
        "waypoints.tolerance=0.2",
        "task.pedestrians=0",
        "environment.worlds=4",
        "environment.problems_per_world=4",
    ]
    envs = NavigationVectorEnv(16, robot="jackal", observation="rosnav_sectors", reward="progress", overrides=near)
    closeness = envs.batch.parts.encoder.layout()[0].size
    observation, _ = envs.reset(seed=0)
    outcomes, earned = [], np.zeros(16)
    for _ in range(400):
        bearing = np.arctan2(observation[:, closeness + 2], observation[:, closeness + 1])
        speed = 0.6 * np.clip(1.0 - np.abs(bearing) / 0.6, 0.0, 1.0)
        action = np.stack((2.0 * speed - 1.0, np.clip(bearing, -1.0, 1.0)), axis=1).astype(np.float32)
        observation, reward, _, _, infos = envs.step(action)
        earned += reward
        outcomes += infos["final_info"]["outcome"][infos["_final_info"]].tolist() if infos else []
    assert len(outcomes) > 30
    assert outcomes.count("goal_reached") > 0.9 * len(outcomes)
    assert earned.min() > 0.0


def test_final_observation_and_report_are_those_of_the_single_environment():
    envs, alone = NavigationVectorEnv(3, overrides=SHORT), NavigationEnv(overrides=SHORT)
    actions = np.random.default_rng(2).uniform(-1.0, 0.0, (20, 3, 2)).astype(np.float32)
    envs.reset(seed=5)
    alone.reset(seed=6)
    for action in actions:
        infos = envs.step(action)[4]
        observation, _, terminated, truncated, info = alone.step(action[1])
        assert bool(infos.get("_final_obs", np.zeros(3, bool))[1]) == (terminated or truncated)
        if terminated or truncated:
            break
    assert (infos["final_obs"][1] == observation).all()
    assert {key: infos["final_info"][key][1] for key in info} == info


def test_who_stands_for_too_long_is_out_of_time():
    env = NavigationEnv(overrides=[*SMALL, "task.pedestrians=0", "environment.standing_to_end=0.5"])
    env.reset(seed=0)
    standing = np.array((-1.0, 1.0), np.float32)  # turning on the spot is standing, too
    ends = [env.step(standing)[2:] for _ in range(5)]
    assert [end[:2] for end in ends] == [(False, False)] * 4 + [(False, True)]
    assert ends[-1][2]["outcome"] == "time_out"
    env.reset(seed=0)
    for k in range(12):
        _, _, terminated, truncated, _ = env.step(np.array((1.0 if k % 4 == 3 else -1.0, 0.0), np.float32))
        assert not terminated
        assert not truncated


def test_action_that_holds_for_three_control_steps_is_three_times_the_same_action():
    overrides = [*SHORT, *ALL, "task.time_limit=3.0"]
    holding, alone = (
        NavigationVectorEnv(4, reward="progress", overrides=[*overrides, f"environment.every={every}"])
        for every in (3, 1)
    )
    actions = np.random.default_rng(2).uniform(-1.0, 1.0, (10, 4, 2)).astype(np.float32)
    seen = [env.reset(seed=3)[0] for env in (holding, alone)]
    running = np.ones(4, bool)
    for action in actions:
        assert (seen[0] == seen[1])[running].all()
        once = holding.step(action)
        earned, ended = np.zeros(4), ~running
        for _ in range(3):
            thrice = alone.step(action)
            earned += np.where(ended, 0.0, thrice[1])
            ended |= thrice[2] | thrice[3]
        assert (once[1] == earned)[running].all()
        assert ((once[2] | once[3]) == ended)[running].all()
        seen, running = [once[0], thrice[0]], running & ~ended
    assert not running.all(), "episodes end on the way"
