"""``arena cost`` on runs that are really driven."""

from __future__ import annotations

import math
import shutil
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest

from arena_core import ArenaError, ConfigurationError, Run, run
from arena_core.hosting import load_registry
from arena_core.records import read_findings
from arena_reference.cost_command import CostCommand
from arena_reference.costing import AS_RECORDED, NO_PEOPLE, cost_of_run

WORDS = ["planner=pure_pursuit", "robot=jackal", "world=empty", "world.width=9", "world.height=7"]
FEW = ["episodes=2", "seed=3", "executor=serial", "report=false", "localizer=ground_truth"]


@pytest.fixture(scope="module")
def among_yielding(tmp_path_factory) -> Path:
    """Return the folder of a run among people who make way."""
    folder = tmp_path_factory.mktemp("yielding") / "run"
    run([*WORDS, *FEW, "task.pedestrians=6", "pedestrians.reaction=yield"], folder)
    return folder


def found_about(folder: Path) -> Mapping[int, Mapping[str, float | str]]:
    """Return what is found about the costs of a run."""
    return next(kind.rows for kind in read_findings(folder) if kind.kind == "cost")


def test_a_run_among_people_who_make_way_costs_them_something(among_yielding: Path, capsys) -> None:
    assert CostCommand().run([str(among_yielding)]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].split()[:4] == ["run", "planner", "n", "people_delay"]
    assert lines[1].split()[1:3] == ["pure_pursuit", "2"]
    for row in found_about(among_yielding).values():
        assert row["note"] == ""
        assert float(row["people_displacement"]) > 0.0
        assert float(row["people_compared"]) + float(row["people_left_out"]) <= 6.0
        assert float(row["people_delay_floor"]) >= 0.0


def test_the_same_run_costs_the_same_again(among_yielding: Path, tmp_path: Path) -> None:
    for name in ("one", "other"):
        shutil.copytree(among_yielding, tmp_path / name)
        cost_of_run(Run(tmp_path / name), load_registry())
    first, second = ((tmp_path / name / "findings/cost.json").read_bytes() for name in ("one", "other"))
    assert first == second


def test_an_episode_of_other_commands_has_empty_cells_and_a_reason(among_yielding: Path, tmp_path: Path) -> None:
    shutil.copytree(among_yielding, tmp_path / "run")
    place = tmp_path / "run/records/0001.npz"
    arrays = dict(np.load(place))
    arrays["command"] = 0.5 * arrays["command"]
    np.savez(place, **arrays)
    rows = cost_of_run(Run(tmp_path / "run"), load_registry()).rows
    assert rows[0]["note"] == ""
    assert "does not come out as recorded" in str(rows[1]["note"])
    assert math.isnan(float(rows[1]["people_delay"]))


def test_an_episode_without_record_has_empty_cells_and_a_reason(among_yielding: Path, tmp_path: Path) -> None:
    shutil.copytree(among_yielding, tmp_path / "run")
    (tmp_path / "run/records/0001.npz").unlink()
    assert str(cost_of_run(Run(tmp_path / "run"), load_registry()).rows[1]["note"]).startswith("no record")


@pytest.mark.parametrize(
    ("words", "note", "delay"),
    [
        (["pedestrians=replay"], AS_RECORDED, 0.0),
        (["task.pedestrians=0"], NO_PEOPLE, math.nan),
    ],
)
def test_nobody_to_cost_and_people_as_recorded_are_told(tmp_path: Path, words, note: str, delay: float) -> None:
    run([*WORDS, "episodes=1", *FEW[1:], *words], tmp_path / "run")
    (row,) = cost_of_run(Run(tmp_path / "run"), load_registry()).rows.values()
    assert row["note"] == note
    assert float(row["people_delay"]) == pytest.approx(delay, nan_ok=True)


def test_words_that_are_no_folders_are_refused(capsys) -> None:
    with pytest.raises(ConfigurationError, match="DIR"):
        CostCommand().run([])
    with pytest.raises(ArenaError):
        CostCommand().run(["nowhere"])
    assert CostCommand().run(["--help"]) == 0
    assert capsys.readouterr().out == "usage: arena cost DIR...\n"
