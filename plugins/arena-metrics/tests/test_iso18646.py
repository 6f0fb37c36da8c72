"""Accuracy, repeatability, deviation and passages: closed forms, and a run from start to table."""

import numpy as np
import pytest

from arena_core.cli.main import main
from arena_metrics.tables.iso18646 import Trial, narrowest_passage, pose_accuracy, pose_repeatability, trial_of


def trials(clean, count=5):
    return [Trial(np.zeros(2), 0.0, number < clean, 0.1, 0.4) for number in range(count)]


def test_accuracy_is_how_far_the_mean_is_off_and_repeatability_how_far_trials_are_off_the_mean():
    off = np.array(((0.3, 0.4), (0.5, 0.4), (0.4, 0.3), (0.4, 0.5)))
    assert pose_accuracy(off) == pytest.approx(np.hypot(0.4, 0.4))
    assert pose_repeatability(off) == pytest.approx(0.1)  # all 0.1 m from their mean: no spread
    spread = np.array(((0.0, 0.0), (0.2, 0.0), (0.1, 0.3)))  # 0.1414, 0.1414 and 0.2 m from their mean
    assert pose_repeatability(spread) == pytest.approx(0.1609 + 3 * 0.0338, abs=1e-3)
    assert np.isnan(pose_repeatability(off[:1]))


def test_narrowest_passage_is_the_last_before_a_trial_failed():
    passed = {"passage_050": trials(5), "passage_060": trials(4), "passage_080": trials(5), "passage_120": trials(5)}
    assert narrowest_passage(passed) == 0.8
    assert narrowest_passage({**passed, "passage_060": trials(5)}) == 0.5
    assert np.isnan(narrowest_passage({"passage_120": trials(0), "path_deviation": trials(5)}))


def test_a_drive_off_the_line_deviates_by_its_greatest_distance(record_of):
    poses = np.column_stack((np.linspace(0.0, 4.0, 41), 0.2 * np.sin(np.linspace(0.0, np.pi, 41)), np.zeros(41)))
    scenario = {"start": [0.0, 0.0, 0.0], "goal": [4.1, 0.0, 0.0], "goal_radius": 0.3, "time_limit": 100.0}
    trial = trial_of(record_of(poses, meta={"scenario": scenario}))
    assert trial.deviation == pytest.approx(0.2)
    assert trial.off == pytest.approx((-0.1, 0.0))


@pytest.mark.slow
def test_trials_become_a_row_a_planner(tmp_path, capsys):
    words = ["experiment=iso18646", "planner=pure_pursuit", "robot=jackal", "episodes=1", "executor=serial"]
    courses = "hydra.sweeper.params.scenario='iso18646/pose_accuracy,iso18646/path_deviation,iso18646/passage_120'"
    assert main(["run", *words, courses, "report=false", f"hydra.sweep.dir={tmp_path}"]) == 0
    capsys.readouterr()
    assert main(["iso18646", str(tmp_path)]) == 0
    head, row = capsys.readouterr().out.splitlines()
    assert row.split()[:4] == ["jackal", "pure_pursuit", "amcl", "3"]
    assert float(row.split()[4]) < 0.2
    assert row.split()[-2] == "1.20"
    assert "repeatability [m]" in head


def test_runs_of_something_else_are_one_line(tmp_path, capsys):
    words = [
        "planner=pure_pursuit",
        "robot=jackal",
        "world=empty",
        "episodes=1",
        "task.pedestrians=0",
        "executor=serial",
    ]
    assert main(["run", *words, "report=false", f"hydra.run.dir={tmp_path / 'run'}"]) == 0
    assert main(["iso18646", str(tmp_path)]) == 2
    assert "holds no trial; allowed: runs of experiment=iso18646" in capsys.readouterr().err
