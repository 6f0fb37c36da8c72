"""Files of Arena-Bench's recorder as runs."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest

from arena_core.cli.main import main
from arena_core.commands import print_notice
from arena_core.records import read_record

HEADER = (
    "episode,time,laser_scan,robot_lin_vel_x,robot_lin_vel_y,robot_ang_vel,robot_orientation,"
    "robot_pos_x,robot_pos_y,action,model"
)


def line(episode: int, stamp: float, x: float, laser: float = 2.0) -> str:
    return f'{episode},{stamp:.3f},[{laser}],0.25,0.0,0.1,0.0,{x:.3f},1.0,"[0.3, 0.0, 0.1]",base_model'


@pytest.fixture
def recorded(tmp_path: Path) -> Path:
    """Two episodes of a robot that drives along x; in the second one it touches something twice."""
    first = [line(0, 10.0 + 0.401 * k, 0.1 * k) for k in range(50)]
    second = [line(1, 31.0 + 0.401 * k, 0.1 * k, 0.1 if k in (5, 6, 20) else 2.0) for k in range(30)]
    path = tmp_path / "teb_base_model--lab--22-08-05.csv"
    path.write_text("\n".join([HEADER, *first, *second]) + "\n")
    return path


def imported(*words: object) -> int:
    return main(["ros", "import", *map(str, words)])


def test_rows_are_kept_as_they_are(recorded: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    print_notice.cache_clear()
    assert imported(recorded, "--out", tmp_path / "out", "robot=turtlebot3", "planner=teb", "goal=5.48,1") == 0
    first, second = (read_record(tmp_path / "out" / "records" / f"{k:04d}.npz") for k in range(2))
    np.testing.assert_allclose(np.diff(first["stamp"])[:-1], 0.401, atol=1e-9)
    np.testing.assert_allclose(first["pose"][:-1, 0], 0.1 * np.arange(len(first["stamp"]) - 1), atol=1e-6)
    np.testing.assert_allclose(first["command"][:-1], np.tile([0.3, 0.0, 0.1], (len(first["stamp"]) - 1, 1)))
    assert (first.meta["outcome"], second.meta["outcome"]) == ("goal_reached", "error")
    assert first["pose"][-1, 0] == pytest.approx(4.5, abs=0.01)  # within a metre, as the original ended an episode
    assert "of each scan only the nearest range was recorded" in capsys.readouterr().err


def test_figures_are_those_of_the_release(recorded: Path, tmp_path: Path) -> None:
    assert imported(recorded, "--out", tmp_path / "out", "robot=turtlebot3", "planner=teb", "goal=5.48,1") == 0
    assert main(["evaluate", str(tmp_path / "out"), "metrics=[si,paper_legacy]"]) == 0
    with (tmp_path / "out" / "episodes.csv").open() as file:
        first, second = csv.DictReader(file)
    assert float(first["paper_legacy.time"]) == pytest.approx(0.401 * 45, abs=0.01)
    assert float(first["paper_legacy.path_length"]) == pytest.approx(4.5, abs=0.01)
    assert [float(row["paper_legacy.collision"]) for row in (first, second)] == [0.0, 2.0]
    assert [float(row["paper_legacy.success"]) for row in (first, second)] == [1.0, 0.0]
    assert first["collisions"] == first["clearance_min"] == ""


def test_rows_that_cannot_be_read_are_left_out_and_counted(
    recorded: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    print_notice.cache_clear()
    lines = recorded.read_text().splitlines()
    lines[5] = lines[5].replace("[2.0]", "None")
    lines.insert(10, lines[3])  # a time that was before
    lines.insert(20, "0,nothing")
    recorded.write_text("\n".join(lines))
    assert imported(recorded, "--out", tmp_path / "out", "robot=turtlebot3") == 0
    assert "3 rows are no numbers or do not go on in time; left out" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("content", "words", "said"),
    [
        ("a,b\n1,2\n", [], "has no column action; allowed: files of Arena-Bench's data recorder"),
        (HEADER + "\n", [], "holds no episode"),
        (HEADER + "\n", ["scan=/scan"], "has no topics and no scans"),
        (HEADER + "\n", ["goal=here"], "goal is here; allowed: X,Y or X,Y,THETA in m and rad"),
        ("\0\x89PNG\r\n", [], "allowed: files of"),
    ],
)
def test_what_is_no_such_file_is_one_line(
    tmp_path: Path, content: str, words: list[str], said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    print_notice.cache_clear()
    (tmp_path / "a.csv").write_text(content)
    assert imported(tmp_path / "a.csv", "--out", tmp_path / "out", "robot=jackal", *words) == 2
    assert said in capsys.readouterr().err.splitlines()[-1]
