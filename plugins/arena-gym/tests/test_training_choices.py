"""What a training decides by: levels, which weights are best, how sure scores are, and the
truth that a critic is shown.
"""

from __future__ import annotations

import json
import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from arena_core.cli.main import main
from arena_core.hosting import Staging
from arena_core.statistics import middle_half, over_seeds, wilson
from arena_gym.episodes import draw_stage
from arena_gym.training.ground_truth import GroundTruth
from arena_gym.training.levels import LevelMixture, Promotion
from arena_gym.training.selection import Choice, is_better, latest_choice
from arena_gym.training.settings import Mixture, TruthSettings, Validation
from arena_gym.vector_environment import NavigationVectorEnv
from arena_policies.card import PolicyCard, write_card

SMALL = ["world=empty", "world.width=8", "world.height=8", "environment.worlds=1", "environment.problems_per_world=4"]


def test_levels_whose_success_changes_are_met_most_and_none_is_lost():
    mixture = LevelMixture(3, Mixture(floor=0.3, window=20))
    assert mixture.level_shares() == pytest.approx([1 / 3] * 3)
    for _ in range(400):
        mixture.record_episode(0, None, success=True)
        mixture.record_episode(2, None, success=False)
    for _ in range(15):
        mixture.record_episode(1, None, success=True)
    shares = mixture.level_shares()
    assert sum(shares) == pytest.approx(1.0)
    assert shares[1] > 0.75, "it is being learned"
    assert shares[0] == pytest.approx(0.1, abs=0.01), "mastered long ago"
    assert shares[2] == pytest.approx(0.1, abs=0.01), "never reached"
    for _ in range(8):
        mixture.record_episode(0, None, success=False)
    assert mixture.level_shares()[0] > 0.3, "it is being forgotten"


def test_mixture_and_promotion_go_on_from_what_a_checkpoint_keeps():
    mixture, again = (LevelMixture(2, Mixture(0.2, 10)) for _ in range(2))
    for success in (True, False, True):
        mixture.record_episode(1, None, success=success)
    again.restore(json.loads(json.dumps(mixture.state())))
    assert again.level_shares() == mixture.level_shares()
    batch = SimpleNamespace(set_stage=lambda stage: None)
    rule = Staging(levels=3, start=0, block=2, promote=0.9, fall_back=0.1)
    promotion, later = Promotion(rule), Promotion(rule)
    for success in (True, True, True):
        promotion.record_episode(0, batch, success=success)
    later.restore(json.loads(json.dumps(promotion.state())))
    later.record_episode(1, batch, success=True)
    assert (promotion.mean, later.mean, later.may_end) == (1.0, 2.0, True)


def test_level_of_an_episode_follows_from_seed_number_and_weights():
    drawn = [draw_stage((0.5, 0.0, 0.5), 3, number) for number in range(400)]
    assert drawn == [draw_stage((0.5, 0.0, 0.5), 3, number) for number in range(400)]
    assert set(drawn) == {0, 2}
    assert 140 < drawn.count(0) < 260


def test_worlds_have_levels_of_their_own_in_a_mixture():
    env = NavigationVectorEnv(8, overrides=["task=staged", *SMALL])
    env.batch.mix_stages([1.0] * env.batch.parts.pool.staging.levels)
    infos = env.reset(seed=0)[1]
    assert len(set(infos["stage"].tolist())) > 2
    assert [key.stage for key in env.batch.keys] == infos["stage"].tolist()
    env.set_stage(1)
    assert set(env.reset(seed=0)[1]["stage"].tolist()) == {1}


def test_weights_are_chosen_by_means_of_several_validations():
    settings = Validation(every=1, episodes=10, seed=7, average=2, target=None)
    curve, best = [], None
    for steps, success in enumerate((1.0, 0.2, 0.9, 0.8, 0.9, 0.1), start=1):
        curve.append({"steps": steps, "success": success})
        found = latest_choice(curve, settings)
        best = found if is_better(found, best) else best
    assert best == Choice(5, 2, pytest.approx(0.85)), (
        "neither the luckiest, nor the first of two that are equal, nor the last"
    )


def test_interval_of_a_proportion_is_wilsons():
    assert wilson(0.5, 100) == pytest.approx((0.4038, 0.5962), abs=1e-4)  # Newcombe 1998's method 3
    assert wilson(81 / 263, 263) == pytest.approx((0.2553, 0.3662), abs=1e-4)  # his table I
    assert wilson(1.0, 20) == pytest.approx((0.8389, 1.0), abs=1e-4)
    assert wilson(0.0, 20)[0] == 0.0


def test_seeds_give_an_interquartile_mean_and_an_interval_within_them():
    assert middle_half(np.array([0.0, 0.4, 0.6, 1.0])) == pytest.approx(0.5)
    mean, low, high = over_seeds([[0.8, 0.9, 1.0]])
    assert mean == pytest.approx(0.9)
    assert 0.8 <= low < mean < high <= 1.0
    assert over_seeds([[0.8, 0.9, 1.0]]) == (mean, low, high)
    assert math.isnan(over_seeds([[0.9]])[1])
    assert over_seeds([[0.9, 0.9], [0.1, 0.1]]) == pytest.approx((0.5, 0.5, 0.5)), "seeds are drawn within a robot"


def test_critic_sees_the_nearest_people_from_the_robot():
    env = NavigationVectorEnv(2, overrides=["task.pedestrians=3", *SMALL])
    env.reset(seed=0)
    snapshot = env.batch.snapshot
    positions, velocities = snapshot.crowd.positions.copy(), snapshot.crowd.velocities.copy()
    positions[0] = [[2.0, 3.0], [2.0, 1.0], [30.0, 1.0]]
    velocities[0] = [[0.0, 0.5], [0.25, 0.0], [1.0, 1.0]]
    poses = snapshot.poses.copy()
    poses[0] = (1.0, 1.0, math.pi / 2)
    seen = replace(snapshot, poses=poses, crowd=replace(snapshot.crowd, positions=positions, velocities=velocities))
    truth = GroundTruth(TruthSettings(people=3, reach=4.0))
    columns = truth.truth_columns(seen, np.array([0]))
    assert columns.shape == (1, truth.size)
    assert columns[0, :2] == pytest.approx(
        np.array([snapshot.clearances[0], snapshot.clearances_people[0]]).clip(-4, 4) / 4.0
    )
    people = columns[0, 2:].reshape(3, 5)
    assert people[0] == pytest.approx([1.0, 0.0, -0.25, 0.0, -0.25], abs=1e-6), "1 m to the right, walking to the right"
    assert people[1] == pytest.approx([1.0, 0.5, -0.25, 0.5, 0.0], abs=1e-6)
    assert people[2] == pytest.approx([0.0] * 5), "out of reach"
    np.testing.assert_array_equal(truth.truth_columns(seen, np.array([1, 0]))[1:], columns)


def test_policy_of_a_critic_that_sees_the_truth_never_reads_it():
    torch = pytest.importorskip("torch", reason="training needs the extra arena-gym[train]")
    from arena_gym.training.export import Actor
    from arena_gym.training.learning import make_learner
    from arena_gym.training.sb3_vec_env import Sb3VecEnv
    from arena_gym.training.session import training_settings

    config = _composed("training.critic=truth", "training.optimization.minibatch=512")
    settings = training_settings(config)
    env = NavigationVectorEnv(2, overrides=["observation_encoder=rosnav_sectors", *SMALL])
    truth, layout = GroundTruth(settings.truth), env.batch.parts.encoder.layout()
    worlds = Sb3VecEnv(env, 0, truth)
    learner = make_learner(worlds, layout, settings, None)
    seen = torch.as_tensor(worlds.reset())
    width = sum(field.size for field in layout)
    assert seen.shape[1] == width + truth.size
    other = seen.clone()
    other[:, width:] += 1.0
    policy = learner.policy
    assert torch.equal(policy.get_distribution(seen).mode(), policy.get_distribution(other).mode())
    assert not torch.equal(policy.predict_values(seen), policy.predict_values(other))
    acted = Actor(policy).act(seen[:, :width].numpy())
    np.testing.assert_allclose(acted, policy.get_distribution(seen).mode().detach().clamp(-1, 1).numpy(), atol=1e-6)


def _composed(*overrides):
    from arena_gym.building import compose_environment

    return compose_environment(["recipe=rosnav", "robot=jackal", *overrides], primary="train")


def test_trainings_of_several_seeds_make_a_table(tmp_path, capsys):
    for robot, shares in (("jackal", (0.9, 0.92, 0.97)), ("robotino", (0.8, 0.84))):
        for seed, success in enumerate(shares):
            training = {
                "seed": seed,
                "choice": {"steps": 10**6 * (seed + 1)},
                "score": {"success": success, "collision": 1.0 - success, "time_out": 0.0, "episodes": 300},
            }
            folder = tmp_path / f"{robot}_{seed}"
            folder.mkdir()
            write_card(
                folder / "policy.json", PolicyCard("mine", robot, "differential", 0.1, {}, (), {}, {}, "", training)
            )
    folders = sorted(str(folder) for folder in tmp_path.iterdir())
    assert main(["trainings", *folders]) == 0
    rows = [
        [cell.strip() for cell in line.split("|")[1:-1]]
        for line in capsys.readouterr().out.splitlines()
        if line.startswith("| mine")
    ]
    assert [row[1] for row in rows] == ["jackal", "robotino", "all"]
    assert rows[0][2:4] == ["0, 1, 2", "0.900, 0.920, 0.970"]
    assert rows[0][4].startswith("0.930 (0.9")
    assert rows[0][7:] == ["300", "1.00 .. 3.00 million steps"]
    for words, said in (
        ([], "allowed"),
        ([str(tmp_path / "none")], "policy.json"),
        ([folders[0], folders[0]], "twice"),
    ):
        assert main(["trainings", *words]) == 2
        assert said in capsys.readouterr().err


LOOKING_BACK = [
    "observation_encoder=rosnav_sectors",
    "observation_encoder.lookback=[0.5]",
    "guide=navigator",
    "randomization.latency.high=2",
]
SWITCHED = ["switch=two", "observation_encoder=rosnav_sectors", "randomization.lidar_noise.high=0.02"]
TWO = """
defaults:
  - /planner@members.dwa: dwa
  - /planner@members.pure_pursuit: pure_pursuit
  - /local_map@local_map: rolling
  - /tracker@tracker: none
every: 2
held: 1
"""


@pytest.mark.slow
@pytest.mark.parametrize(
    "overrides", [LOOKING_BACK, SWITCHED], ids=["scans, paths and errors of before", "members that remember"]
)
def test_running_episodes_are_driven_again_bit_for_bit(tmp_path, monkeypatch, overrides):
    from arena_gym.training.running_episodes import ActionLog

    (tmp_path / "conf" / "switch").mkdir(parents=True)
    (tmp_path / "conf" / "switch" / "two.yaml").write_text(TWO.lstrip())
    monkeypatch.chdir(tmp_path)
    words = [
        *SMALL,
        *overrides,
        "task.pedestrians=2",
        "task.trip.min_distance=1.5",
        "task.trip.max_distance=3.0",
        "task.time_limit=6.0",
    ]
    env, again = (NavigationVectorEnv(3, overrides=words) for _ in range(2))
    random = np.random.default_rng(0)
    space = env.single_action_space
    drawn = [
        random.integers(2, size=3) if space.shape == () else random.uniform(-1, 1, (3, *space.shape)) for _ in range(45)
    ]
    env.reset(seed=5)
    log, ends = ActionLog(3), 0
    for actions in drawn:
        seen, _, terminated, truncated, _ = env.step(actions)
        log.add(actions, terminated | truncated)
        ends += int((terminated | truncated).sum())
    assert ends > 0, "episodes began at different times"
    running = log.running_episodes(env.batch.keys)
    assert running.lengths.max() == len(running.actions) > 0
    np.testing.assert_array_equal(running.replay_actions(again.batch), seen)
    for actions in drawn[:20]:
        for here, there in zip(env.step(actions)[:4], again.step(actions)[:4], strict=True):
            np.testing.assert_array_equal(here, there)
