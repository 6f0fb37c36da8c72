"""Replays of a report's episodes."""

import base64

import pytest

from arena_metrics.pages import replays
from arena_metrics.pages.replays import total_size, write_replays
from arena_metrics.pooling.cells import cells_of
from arena_metrics.pooling.runs import pool_episodes, read_runs


@pytest.fixture
def cells(run_folder, tmp_path):
    """Return two cells of four episodes each, of which odd ones failed and the last of the second left no record."""
    run_folder(tmp_path / "runs" / "a", planner="dwa", people=0, episodes=4)
    run_folder(tmp_path / "runs" / "b", planner="teb", people=0, episodes=4, errors=[3])
    return cells_of(pool_episodes(read_runs([tmp_path / "runs"]))[0])


def test_failures_of_all_cells_come_first_and_have_pictures(cells, tmp_path, capsys):
    found = write_replays(cells, tmp_path, 4)
    assert [name.rpartition("-")[2] for name in found] == ["1", "1", "3", "0"]
    assert [replay.picture is not None for replay in found.values()] == [True, True, True, False]
    assert all((tmp_path / replay.page).stat().st_size == replay.size for replay in found.values())
    assert base64.b64decode(next(iter(found.values())).picture).startswith(b"\x89PNG")
    assert total_size(found).endswith(" MB")
    assert capsys.readouterr().err == ""


def test_episodes_without_a_record_have_none(cells, tmp_path):
    assert len(write_replays(cells, tmp_path, 99)) == 7


def test_none_are_written_where_none_are_wanted_or_nobody_makes_them(cells, tmp_path, monkeypatch):
    assert write_replays(cells, tmp_path, 0) == {}
    monkeypatch.setattr(replays, "_replay_command", lambda: None)
    assert write_replays(cells, tmp_path, 9) == {}
    assert not (tmp_path / "replays").exists()
