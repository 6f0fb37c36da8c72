"""People of a recording without a topic for them: our tracker over its scans."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from arena_core import LaserScan, Pose, Twist
from arena_core.cli.main import main
from arena_core.commands import print_notice
from arena_core.records import read_grid, read_record
from arena_ros import conversions as to
from arena_ros.bags.exporting import open_writer
from arena_ros.codec import get_codec

NEAR = 3.0  # m, within which a person is in plain sight most of the time


@pytest.fixture(scope="module")
def foreign(finished_run: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The first episode of a run as another laboratory might have recorded it: odometry, transforms, scans, a map."""
    record, own = read_record(finished_run / "records" / "0000.npz"), get_codec(1)
    lidar = record.meta["config"]["robot"]["lidar"]
    path, begin = tmp_path_factory.mktemp("foreign") / "lab.bag", 1000 * 10**9
    grid, mount = (
        read_grid(finished_run / record.meta["world"]["grid"]),
        Pose(*(lidar["mount"][key] for key in ("x", "y", "theta"))),
    )
    with open_writer(path, own) as write:
        write("/map", to.GRID, begin, to.grid_msg(own, grid, begin, "map"))
        write("/tf_static", to.TF, begin, to.transforms_msg(own, [("base_link", "laser", mount)], begin))
        for row, ranges in enumerate(record["scan_ranges"]):
            stamp = begin + round(record["stamp"][row] * 1e9)
            pose, twist = Pose.of(record["pose"][row]), Twist.of(record["twist"][row])
            write("/tf", to.TF, stamp, to.transforms_msg(own, [("map", "odom", Pose(0.0, 0.0))], stamp))
            write("/odom", to.ODOMETRY, stamp, to.odometry_msg(own, pose, twist, to.Header(stamp, "odom"), "base_link"))
            figures = (float(lidar[key]) for key in ("angle_min", "angle_increment", "range_min", "range_max"))
            write(
                "/scan", to.SCAN, stamp, to.scan_msg(own, LaserScan(0.0, *figures, ranges, mount), stamp, "laser", 0.1)
            )
    return path


def test_people_are_seen_where_they_were(
    foreign: Path, finished_run: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    print_notice.cache_clear()
    assert main(["ros", "import", str(foreign), f"--out={tmp_path / 'out'}", "robot=jackal", "people=tracker"]) == 0
    before, after = (read_record(folder / "records" / "0000.npz") for folder in (finished_run, tmp_path / "out"))
    truth, seen = before["pedestrian_positions"][: len(after["stamp"])], after["pedestrian_positions"]
    distances = np.hypot(*np.moveaxis(truth - before["pose"][: len(truth), None, :2], -1, 0))
    gaps = np.hypot(*np.moveaxis(truth[:, :, None] - seen[:, None], -1, 0))
    nearest = np.nanmin(np.where(np.isfinite(gaps), gaps, np.inf), axis=2, initial=np.inf)
    shown = (distances < NEAR) & (np.arange(len(truth))[:, None] > 10)
    assert shown.sum() > 20
    assert (nearest[shown] < 0.4).mean() > 0.6
    assert after.meta["columns"]["pedestrian_model"] == "tracked"
    assert "pedestrian_positions" not in after.meta["unknown"]
    assert "people are those whom our tracker saw in the scans" in capsys.readouterr().err


def test_without_scans_nobody_can_be_seen(foreign: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["ros", "import", str(foreign), f"--out={tmp_path / 'out'}", "people=tracker", "scan=none"]) == 2
    assert "people is tracker, but no scan was recorded" in capsys.readouterr().err


@pytest.mark.slow
def test_an_export_keeps_its_own_people(finished_run: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    print_notice.cache_clear()
    assert main(["ros", "export", str(finished_run), "--to", str(tmp_path / "run.bag")]) == 0
    assert main(["ros", "import", str(tmp_path / "run.bag"), f"--out={tmp_path / 'out'}", "people=/people"]) == 0
    assert main(["ros", "import", str(tmp_path / "run.bag"), f"--out={tmp_path / 'again'}", "people=tracker"]) == 0
    first, second = (read_record(tmp_path / name / "records" / "0000.npz") for name in ("out", "again"))
    np.testing.assert_array_equal(first["pedestrian_positions"], second["pedestrian_positions"])
    assert "an export of ours has its people itself" in capsys.readouterr().err
