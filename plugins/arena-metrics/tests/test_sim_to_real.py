from __future__ import annotations

import csv
import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from arena_core import ArenaError, EpisodeRecord
from arena_metrics.pages.sim_to_real import (
    METRICS,
    CompareRealCommand,
    RecordedDrive,
    difference_rows,
    pair_drives,
    problem_rows,
)


def drive(name: str, y: float, seconds: float, goal: float = 5.0) -> RecordedDrive:
    """Drive straight along x at a height of ``y`` m."""
    pose = np.zeros((51, 3))
    pose[:, 0], pose[:, 1] = np.linspace(0.0, 5.0, 51), y
    meta = {"scenario": {"name": name, "start": [0.0, 0.0, 0.0], "goal": [goal, 0.0, 0.0]}}
    return RecordedDrive(
        EpisodeRecord({"pose": pose}, meta),
        {**dict.fromkeys(METRICS, math.nan), "time_to_goal": seconds, "path_length": 5.0},
    )


def test_paths_beside_each_other_are_as_far_apart_as_they_are() -> None:
    (pair,) = pair_drives([drive("a", 0.0, 10.0)], [drive("a", 0.2, 12.0)])
    assert pair.frechet == pytest.approx(0.2)
    assert problem_rows([pair])[1][1] == "0.20"


def test_problems_of_other_names_are_paired_by_start_and_goal() -> None:
    pairs = pair_drives([drive("a", 0.0, 10.0, goal=8.0), drive("b", 0.0, 11.0)], [drive("driven_0000", 0.1, 12.0)])
    assert [pair.simulated.name for pair in pairs] == ["b"]


def test_differences_are_reality_less_simulation_with_an_interval() -> None:
    simulated = [drive(f"p{k}", 0.0, 10.0 + k) for k in range(8)]
    real = [drive(f"p{k}", 0.1, 12.0 + k + 0.1 * (-1) ** k) for k in range(8)]
    rows = {row[0]: row[1:] for row in difference_rows(pair_drives(simulated, real))}
    mean, low, high, n, p = rows["time_to_goal s"]
    assert float(mean) == pytest.approx(2.0, abs=0.01)
    assert float(low) < 2.0 < float(high)
    assert (n, float(p) < 0.05) == ("8", True)


def test_runs_without_a_common_problem_are_one_line() -> None:
    with pytest.raises(ArenaError, match="no problem is in both runs"):
        pair_drives([drive("a", 0.0, 10.0, goal=8.0)], [drive("a", 0.0, 10.0)])


def test_claims_are_judged_over_the_pairs(
    run_folder: Callable[..., Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """TEB takes 5 s longer and jerks more in reality; its paths are the same. ROSNAV was not driven."""
    columns = ("success", "path_length", "time_to_goal", "jerk", "collisions", "reverse_share", "goal_error")
    for name in ("simulated", "real"):
        run_folder(tmp_path / name, planner="teb", people=10, episodes=12, fails=[99], only=columns)
    table = tmp_path / "real" / "episodes.csv"
    rows = list(csv.DictReader(table.read_text().splitlines()))
    with table.open("w", newline="") as file:
        writer = csv.DictWriter(file, rows[0], lineterminator="\n")
        writer.writeheader()
        writer.writerows(
            {**row, "time_to_goal": 5.0 + float(row["time_to_goal"]), "jerk": 1.0 + 0.1 * i}
            for i, row in enumerate(rows)
        )
    out = tmp_path / "out"
    words = [str(tmp_path / "simulated"), str(tmp_path / "real"), "--claims", "reality", "--out", str(out)]
    assert CompareRealCommand().run(words) == 0
    verdicts = {
        row["claim"].partition(".")[0]: row for row in csv.DictReader((out / "claims.csv").read_text().splitlines())
    }
    assert {number: row["verdict"] for number, row in verdicts.items()} == {
        "18": "not tested",  # its last contrast needs ROSNAV
        "19": "cannot be decided (no difference is seen)",
        "20": "not tested",
        "21": "not tested",
        "22": "not reproduced",
    }
    assert (
        "path length of teb, reality: within 1 of simulation: +0 [+0, +0], p = 1, holds"
        in verdicts["18"]["what the episodes say"]
    )
    assert "time to goal of 10 people, reality: lower than simulation: +5" in capsys.readouterr().out


def test_another_planners_episode_is_no_pair(run_folder: Callable[..., Path], tmp_path: Path) -> None:
    for name, planner in (("simulated", "dwa"), ("real", "teb")):
        run_folder(tmp_path / name, planner=planner, episodes=2)
    with pytest.raises(ArenaError, match="no problem is in both runs"):
        CompareRealCommand().run([str(tmp_path / "simulated"), str(tmp_path / "real")])
