"""A switch that is trained with forks: what members cost, that forks leave the drive alone, and what it learns."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from arena_core import ConfigurationError
from arena_core.cli.main import main
from arena_core.hosting import compose, to_plain
from arena_gym.forks.collecting import Collector, block_words
from arena_gym.forks.costs import Outcomes, intrusions, outcome_terms, regrets, total_costs
from arena_gym.forks.scoring import describe_score, interval, score_choices
from arena_gym.forks.settings import CostSettings, DriveSettings
from arena_gym.seeds import FIRST_TRAINING_SEED
from arena_policies.learning_facts import learned_by

COSTS = CostSettings(horizon=2.0, collision=15.0, discomfort=5.0, near=0.3)
WORDS = ["world.width=20", "pedestrians=none", "localizer=ground_truth", "task.random.trip.min_distance=8.0"]
FULL, HALF = 2.0, 1.0  # m/s, the Jackal's maximum and half of it


def drives(**changes):
    settings = {
        "blocks": 2,
        "episodes": 1,
        "time_limit": 4.0,
        "held": 1.0,
        "apart": 1.5,
        "worlds": {"empty": 1.0},
        "densities": [0.0],
        "speeds": [1.0],
        "words": WORDS,
        "navigator": {"recoveries": {"behaviours": []}},
    }
    return DriveSettings(**{**settings, **changes})


def test_time_that_is_lost_is_what_full_speed_would_have_saved():
    outcomes = Outcomes(
        times=np.array((5.0, 5.0, 5.0, 2.0)),
        left=np.array((0.0, 10.0, 11.0, 6.0)),  # all of it driven, none, back, and arrived before the time was over
        collisions=np.array((0.0, 0.0, 2.0, 0.0)),
        discomforts=np.array((0.0, 0.4, 0.0, 0.0)),
    )
    terms = outcome_terms(outcomes, way=10.0, full_speed=2.0)
    np.testing.assert_allclose(terms[:, 0], (0.0, 5.0, 5.5, 0.0))
    np.testing.assert_allclose(total_costs(terms, COSTS), (0.0, 7.0, 35.5, 0.0))


def test_discomfort_is_how_much_nearer_than_allowed_for_how_long():
    np.testing.assert_allclose(intrusions(np.array((0.5, 0.3, 0.1, -0.1, np.inf)), 0.3, 0.1), (0, 0, 0.02, 0.04, 0))


def test_regret_is_what_the_best_member_of_the_same_state_would_have_saved():
    np.testing.assert_allclose(regrets(np.array(((3.0, 1.0), (2.0, 5.0)))), ((2.0, 0.0), (0.0, 3.0)))


def test_score_of_a_choice_lies_between_oracle_and_best_member():
    costs = np.array(((0.0, 4.0), (4.0, 0.0), (1.0, 3.0), (3.0, 1.0)))
    block = np.array((0, 0, 1, 1))
    score = score_choices(costs, np.array(((1.0, 0.0),) * 4) * 1.0, block, ("one", "two"))
    assert (score["alone"], score["random"], score["oracle"], score["learned"]) == ({"one": 2.0, "two": 2.0}, 2, 0.5, 2)
    assert score["learned_less_best"] == [0.0, 0.0, 0.0]
    assert score["oracle_less_best"][0] == -1.5
    assert score["chosen"] == {"one": 1.0, "two": 0.0}
    assert "learned less one +0.00" in describe_score(score)
    seen = score_choices(costs, -costs, block, ("one", "two"))
    assert seen["learned"] == seen["oracle"]


def test_interval_is_that_of_blocks_not_of_states():
    wide = interval(np.repeat((0.0, 1.0), 50), np.repeat((0, 1), 50))
    assert wide == [0.5, 0.0, 1.0], "two blocks say little, however many states they have"


def test_every_block_has_a_seed_that_no_benchmark_has():
    words = [block_words(drives(), seed, block) for seed in (0, 1) for block in range(50)]
    seeds = [int(each[0].removeprefix("seed=")) for each in words]
    assert min(seeds) >= FIRST_TRAINING_SEED
    assert len(set(seeds)) == len(seeds)


def test_drives_that_cannot_be_drawn_are_refused():
    with pytest.raises(ConfigurationError, match=r"worlds is .* allowed: names with weights"):
        drives(worlds={"empty": 0.0})
    with pytest.raises(ConfigurationError, match=r"densities is .* allowed: one or more"):
        drives(densities=[])


def config_of(*speeds):
    """Return what a collector reads: members that drive along the path at these speeds, as ``s0``, ``s1`` ..."""
    composed = to_plain(compose(["planner=pure_pursuit", "robot=jackal"]))
    encoder = to_plain(compose(["observation_encoder=rosnav_sectors"], "component"))["observation_encoder"]
    members = {f"s{k}": {**composed["planner"], "speed": speed} for k, speed in enumerate(speeds)}
    return {"robot": composed["robot"], "switch": {"members": members}, "observation_encoder": encoder}


@pytest.fixture(scope="module")
def collected(tmp_path_factory):
    """States of two members, one of which drives half as fast, on free ground; and where they are kept."""
    folder = tmp_path_factory.mktemp("states")
    return Collector(config_of(FULL, HALF), drives(), COSTS, 3).collect(folder), folder


def test_member_that_drives_half_as_fast_loses_a_second_more_in_two(collected):
    states, _ = collected
    assert len(states.numbers) >= 3
    assert np.isfinite(states.numbers).all()
    lost, collisions, discomforts = np.moveaxis(states.terms, 2, 0)
    assert not collisions.any()
    assert not discomforts.any()
    assert (lost > -0.05).all(), "no one is faster than at full speed"
    driving = states.member == 0  # at full speed already
    np.testing.assert_allclose((lost[driving, 1] - lost[driving, 0]), 1.0, atol=0.25)


def test_what_is_collected_is_not_driven_again_and_comes_out_alike(collected, tmp_path):
    states, folder = collected
    (tmp_path / "0000.npz").write_bytes((folder / "0000.npz").read_bytes())
    before = (tmp_path / "0000.npz").stat().st_mtime_ns
    again = Collector(config_of(FULL, HALF), drives(), COSTS, 3).collect(tmp_path)
    assert (tmp_path / "0000.npz").stat().st_mtime_ns == before
    for name in ("numbers", "terms", "member", "block", "episode"):
        np.testing.assert_array_equal(getattr(again, name), getattr(states, name))


def test_forks_leave_the_drive_as_it_would_be_without():
    collector = Collector(config_of(FULL, HALF), drives(apart=3.5), COSTS, 3)
    benchmark, switch = collector.make_benchmark(0)
    ((_, late),) = collector.drive(benchmark, switch, 0)
    early = Collector(config_of(FULL, HALF), drives(apart=0.5), COSTS, 3)
    last = early.drive(*early.make_benchmark(0), 0)[6][1]  # after six others
    np.testing.assert_array_equal(late.numbers, last.numbers)
    np.testing.assert_array_equal(late.terms, last.terms)


SWITCH = """
defaults:
  - /planner@members.pure_pursuit: pure_pursuit
  - /planner@members.dwa: dwa
  - /local_map@local_map: rolling
  - /tracker@tracker: kalman
  - _self_
every: 3
held: 1
members: {}
"""
TRAINER = {
    "name": "switch_forks",
    "drives": {
        "blocks": 2,
        "episodes": 1,
        "time_limit": 3.0,
        "held": 1.0,
        "apart": 1.0,
        "worlds": {"empty": 1.0},
        "densities": [0.0],
        "speeds": [1.0],
        "words": WORDS,
        "navigator": {"recoveries": {"behaviours": []}},
    },
    "costs": {"horizon": 1.0, "collision": 15.0, "discomfort": 5.0, "near": 0.3},
    "fit": {"folds": 2, "epochs": 2, "batch": 4, "rate": 0.001, "decay": 0.0, "delta": 15.0},
}


@pytest.mark.slow  # exports a network
def test_switch_is_trained_and_says_by_what(write_recipe, capsys):
    pytest.importorskip("torch", reason="training needs the extra arena-gym[train]")
    here = write_recipe("mine", trainer=TRAINER)
    (here / "conf" / "switch").mkdir()
    (here / "conf" / "switch" / "mine.yaml").write_text(SWITCH.lstrip())
    words = ["train", "planner=mine", "switch=mine", "robot=jackal", "out=trained"]
    assert main(words) == 0
    said = capsys.readouterr().out
    assert "forks: block 2 of 2" in said
    assert "learned less" in said
    card = json.loads(Path("trained/policy.json").read_text())
    assert list(card["members"]) == ["pure_pursuit", "dwa"]
    assert learned_by(card["training"]) == f"forks of {card['training']['forks']['states']} states, seed 0"
    made = Path("trained/policy.onnx").read_bytes()
    assert main([*words, "resume=true"]) == 0
    assert Path("trained/policy.onnx").read_bytes() == made, "the same seed, the same weights"
    assert main([*words, "resume=true", "trainer.fit.folds=3"]) == 2
    assert "another trainer.fit.folds" in capsys.readouterr().err
