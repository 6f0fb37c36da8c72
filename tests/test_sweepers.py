"""Hydra's optuna sweeper and joblib launcher."""

import csv
import subprocess
import sys
from pathlib import Path

import pytest
import yaml
from hydra.core.override_parser.overrides_parser import OverridesParser
from optuna import load_study
from optuna.distributions import CategoricalDistribution, FloatDistribution, IntDistribution

from arena_core import ConfigurationError
from arena_core.config.configuration import _missing_option
from hydra_plugins.arena.optuna_sweeper import OptunaSweeper, distribution_of

SMALL = (
    "robot=jackal",
    "world=empty",
    "world.width=8",
    "world.height=8",
    "task.pedestrians=0",
    "localizer=ground_truth",
    "executor=serial",
)


def mean(folder, column):
    with Path(folder, "episodes.csv").open(newline="") as file:
        values = [float(row[column]) for row in csv.DictReader(file)]
    return sum(values) / len(values)


@pytest.mark.slow
def test_optuna_looks_for_weights_by_the_mean_of_a_metric(arena):
    answer = arena(
        "run", "experiment=tune_dwa", *SMALL, "episodes=2", "hydra.sweeper.n_trials=2", "hydra.sweep.dir=sweep"
    )
    assert (answer.status, answer.errors) == (0, [])
    best = yaml.safe_load(Path("sweep/optimization_results.yaml").read_text())
    assert best["best_value"] == max(mean(f"sweep/{trial}", "spl") for trial in range(2))
    assert set(best["best_params"]) == {
        f"planner.{key}"
        for key in (
            "critics.path_distance_bias",
            "critics.goal_distance_bias",
            "critics.occdist_scale",
            "approach.scale",
        )
    }
    lines = answer.out.splitlines()
    assert f"trial 1: spl {mean('sweep/1', 'spl')}" in lines
    said = f"best of spl, {best['best_value']:.6g}: planner.critics.path_distance_bias="
    assert [line.startswith(said) for line in lines[-3:]] == [True, False, False]
    assert lines[-2] == "1 of the other 1 trials cannot be told apart from it by their episodes"
    assert lines[-1] == "written: sweep/optimization_results.yaml"


@pytest.mark.slow
def test_a_sweeper_may_weigh_several_metrics(arena):
    optuna = (
        "hydra/sweeper=optuna",
        "hydra.sweeper.n_trials=2",
        "hydra.sweeper.direction=[maximize,minimize]",
        "hydra.sweep.dir=sweep",
    )
    words = (*SMALL, "planner=pure_pursuit", "planner.gain=interval(1.0, 3.0)", "episodes=1", "report=false")
    answer = arena("run", "-m", *optuna, *words, "objective=[spl,time_to_goal]")
    assert (answer.status, answer.errors) == (0, [])
    assert "best of spl, time_to_goal: none is better in all" in answer.out


@pytest.mark.parametrize(
    ("word", "line"),
    [
        ("objective=sucess", "arena: objective is sucess; allowed: null, or out of success, "),
        ("objective=3", "arena: objective is 3; allowed: a list"),
        ("planner.critics.path_distance_bias=-1", "arena: planner.critics.path_distance_bias is -1"),
        ("world.regenerate=1", "arena: world has no key regenerate (possible: "),
    ],
)
def test_a_wrong_request_ends_the_sweep_before_anything_runs(arena, word, line):
    answer = arena("run", "experiment=tune_dwa", *SMALL, "episodes=1", word)
    assert answer.status == 2
    assert answer.line.startswith(line)
    assert not list(Path().rglob("records"))


def test_an_objective_that_no_episode_has_is_said(arena):
    words = ("planner=pure_pursuit", *SMALL, "episodes=1", "task.time_limit=1", "report=false", "hydra.run.dir=run")
    answer = arena("run", *words, "objective=time_to_goal")
    assert answer.status == 2
    assert answer.line.endswith("run; allowed: one that is")
    assert answer.line.startswith("arena: objective time_to_goal is not defined in any episode of ")


JOBLIB = (
    "-m",
    "hydra/launcher=joblib",
    "hydra.launcher.n_jobs=2",
    *SMALL,
    "planner=pure_pursuit",
    "episodes=1",
    "report=false",
)
JOBLIB += ("hydra.sweep.dir=sweep",)


@pytest.mark.slow
def test_joblib_runs_each_job_in_a_process_of_its_own(tmp_path):
    answer = arena_process(*JOBLIB, "planner.gain=1,2", cwd=tmp_path)
    said = answer.stderr.splitlines()
    assert (answer.returncode, said[0]) == (0, "arena: composing job 1 of 2")
    assert all(line.startswith("arena: ") for line in said), said  # how far it is, on a slow machine; no warning
    assert all((tmp_path / f"sweep/{job}/records/0000.npz").exists() for job in range(2))


@pytest.mark.long
def test_an_error_in_a_process_of_joblib_is_that_of_the_command(tmp_path):
    answer = arena_process(*JOBLIB, "planner.gain=1,-1", cwd=tmp_path)
    assert answer.returncode == 2
    assert answer.stderr.splitlines()[-1] == "arena: planner.gain is -1; allowed: > 0"


def arena_process(*words, **settings):
    words = [sys.executable, "-m", "arena_core.cli.main", "run", *words]
    return subprocess.run(words, capture_output=True, text=True, timeout=1800, **settings)


def test_an_extra_that_is_not_installed_is_named(monkeypatch):
    assert (
        _missing_option("hydra/launcher/joblib", [])
        == "hydra/launcher=joblib comes with the extra arena-core[joblib], which is not installed"
    )
    monkeypatch.setattr("arena_core.base.optional.find_spec", lambda name: None)
    sweeper = OptunaSweeper({}, None, 1, 1, direction="minimize")
    with pytest.raises(ConfigurationError, match=r"needs optuna; install the extra arena-core\[optuna\]"):
        sweeper.setup(hydra_context=None, task_function=None, config=None)


@pytest.mark.parametrize(
    ("word", "distribution"),
    [
        ("a=interval(0.5, 2)", FloatDistribution(0.5, 2.0)),
        ("a=tag(log, interval(1.0, 8.0))", FloatDistribution(1.0, 8.0, log=True)),
        ("a=int(interval(1, 8))", IntDistribution(1, 8)),
        ("a=tag(log, int(interval(1, 8)))", IntDistribution(1, 8, log=True)),
        ("a=range(2, 9, 3)", IntDistribution(2, 8, step=3)),
        ("a=1.5,x", CategoricalDistribution([1.5, "x"])),
    ],
)
def test_a_swept_word_is_a_range_of_values(word, distribution):
    (one,) = OverridesParser.create().parse_overrides([word])
    assert distribution_of(one) == distribution


@pytest.mark.slow
def test_a_study_on_disk_goes_on(arena):
    words = (*SMALL, "planner=pure_pursuit", "planner.gain=interval(1.0, 3.0)", "episodes=1", "report=false")
    kept = ("hydra.sweeper.storage=sqlite:///trials.db", "hydra.sweeper.study_name=gain", "hydra.sweeper.n_trials=1")
    for sweep in ("one", "two"):
        answer = arena("run", "-m", "hydra/sweeper=optuna", *kept, *words, "objective=spl", f"hydra.sweep.dir={sweep}")
        assert (answer.status, answer.errors) == (0, [])
    study = load_study(study_name="gain", storage="sqlite:///trials.db")
    assert [trial.state.name for trial in study.trials] == ["COMPLETE", "COMPLETE"]


def test_an_unknown_direction_is_refused(arena):
    answer = arena("run", "experiment=tune_dwa", *SMALL, "episodes=1", "hydra.sweeper.direction=up")
    assert (answer.status, answer.line.partition(";")[0]) == (2, "arena: hydra.sweeper.direction is up")
