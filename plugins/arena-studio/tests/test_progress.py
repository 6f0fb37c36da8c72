"""How long experiments may take still, as the core's pace says it."""

from __future__ import annotations

import json
import os
from collections.abc import Callable
from pathlib import Path
from time import time
from typing import Any

import pytest

from arena_studio.experiments.progress import Progress
from arena_viewer.live import LiveRuns

WriteRun = Callable[..., Path]


def begin(run: Path, config: object, episodes: int, ago: float) -> None:
    """Have a run begin so long ago."""
    (run / "provenance.json").write_text(json.dumps({"episodes": episodes, "config": config}))
    os.utime(run / "provenance.json", (time() - ago,) * 2)


def end(run: Path, ago: dict[int, float]) -> None:
    """Have records written so long ago."""
    (run / "records").mkdir(exist_ok=True)
    for episode, age in ago.items():
        path = run / "records" / f"{episode:04d}.npz"
        path.touch()
        os.utime(path, (time() - age,) * 2)


def left(*runs: Path, episodes: int = 20) -> int | None:
    progress = Progress(runs, episodes)
    progress.refresh()
    return progress.left()


CONFIG = {"executor": {"name": "processes", "workers": 1}}


def test_time_left_is_that_of_the_core_and_known_at_the_first_look(write_run: WriteRun) -> None:
    run = write_run("run", *({} for _ in range(8)))
    begin(run, CONFIG, 20, 120.0)
    end(run, {episode: 28.0 - 4.0 * episode for episode in range(8)})  # the first took 92 s, with compiling
    found = left(run)
    assert found is not None
    assert 44 <= found <= 48
    assert json.loads(LiveRuns(run).state({})[1])["left"] == pytest.approx(found, abs=1.0)


def test_episodes_of_an_earlier_start_are_no_ground_for_a_guess(write_run: WriteRun) -> None:
    run = write_run("run", *({} for _ in range(8)))
    begin(run, CONFIG, 20, 1.0)
    end(run, {episode: 280.0 - 4.0 * episode for episode in range(8)})
    assert left(run) is None


def test_job_of_another_kind_that_has_not_begun_is_no_guess(write_run: WriteRun, folder: Path) -> None:
    run = write_run("0", *({} for _ in range(8)))
    begin(run, CONFIG, 20, 120.0)
    end(run, {episode: 28.0 - 4.0 * episode for episode in range(8)})
    assert left(run, folder / "1", episodes=40) is None


ODD: tuple[Any, ...] = (None, [], "x", {"executor": "x"}, {"executor": {"workers": "x"}}, {"executor": {"workers": -1}})


@pytest.mark.parametrize("config", ODD)
def test_odd_configuration_of_a_run_harms_nobody(write_run: WriteRun, config: object) -> None:
    run = write_run("run", *({"episode": number} for number in ("0", "x", "9" * 5000)))
    begin(run, config, 20, 120.0)
    end(run, {0: 3.0})
    assert left(run) is None
    assert json.loads(LiveRuns(run).state({})[1])["left"] in (None, 0.0)
