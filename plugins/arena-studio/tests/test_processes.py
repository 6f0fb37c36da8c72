"""Processes of the studio: what runs, and what has ended with which status."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from arena_studio.experiments.processes import Process, log_tail, start_process


@pytest.mark.parametrize(("words", "status"), [(["--version"], 0), (["nothing_of_this_name"], 2)])
def test_process_runs_until_its_status_is_known(words: list[str], status: int, tmp_path: Path) -> None:
    process = start_process(words, tmp_path, tmp_path / "log")
    assert process.status() is None
    while process.is_alive():
        pass  # without a rest: one that is ending has no command line for a moment, and no status
    assert process.status() == status
    assert log_tail(tmp_path / "log")


def test_process_of_the_same_number_is_another_one(tmp_path: Path) -> None:
    process = start_process(["--version"], tmp_path, tmp_path / "log")
    other = replace(process, created=process.created - 100.0)
    assert not other.is_alive()
    assert other.status() is None
    while process.is_alive():
        pass
    assert Process(process.pid, process.created).status() == 0
