"""Recordings of Rerun: its own tool finds them whole, with a row for each of the record."""

import os
import re
import subprocess
import sys

import numpy as np
import pytest

import arena_core as arena
from arena_core.records import read_record, record_path
from arena_export.command import ExportCommand
from arena_export.rerun import wall_mesh


def test_a_wall_is_an_upright_rectangle_of_two_triangles():
    corners, triangles = wall_mesh(np.array([[0.0, 0.0, 2.0, 0.0], [2.0, 0.0, 2.0, 1.0]]))
    assert corners[:4].tolist() == [[0, 0, 0], [2, 0, 0], [0, 0, 1], [2, 0, 1]]
    assert triangles[[0, 2]].tolist() == [[0, 1, 2], [1, 3, 2]]
    assert triangles[[1, 3]].tolist() == [[4, 5, 6], [5, 7, 6]]


def stats(path, home):
    """Return what Rerun's tool counts in a file."""
    tool = [sys.executable, "-m", "rerun", "rrd"]
    quiet = {**os.environ, "HOME": str(home)}
    subprocess.run([*tool, "verify", path], env=quiet, check=True, capture_output=True)
    said = subprocess.run([*tool, "stats", path], env=quiet, check=True, capture_output=True, text=True).stdout
    return said, set(re.findall(r"^/([\w/]+): \d+$", said, re.M))


@pytest.mark.pictures
def test_an_episode_is_whole_for_rerun_itself(tmp_path):
    words = ["planner=pure_pursuit", "robot=jackal", "world=empty", "world.width=8", "world.height=8", "episodes=2"]
    more = ["task.pedestrians=2", "recording.scans=true", "executor=serial", "localizer=ground_truth", "report=false"]
    arena.run([*words, *more], tmp_path / "run")
    assert ExportCommand().run([str(tmp_path / "run"), "to=rerun"]) == 0
    files = sorted((tmp_path / "run" / "exports" / "rerun").iterdir())
    assert [file.name for file in files] == ["0000.rrd", "0001.rrd"]
    said, entities = stats(files[0], tmp_path)
    moving = {"world/robot", "world/people", "world/robot/scan", "world/path", "figures/speed", "figures/clearance"}
    assert moving | {"world/walls", "world/goal"} <= entities
    record = read_record(record_path(tmp_path / "run", 0))
    assert f"num_rows_max = {len(record['stamp'])}" in said


def test_without_rerun_it_says_what_to_install(tmp_path, monkeypatch, capsys):
    from arena_core import ConfigurationError
    from arena_export.rerun import RerunExport

    monkeypatch.setitem(sys.modules, "rerun", None)
    with pytest.raises(ConfigurationError, match=r"arena-viewer\[rerun\]"):
        RerunExport().write(tmp_path, tmp_path / "there", [0])
    assert not (tmp_path / "there").exists()
