from __future__ import annotations

import json
import tracemalloc
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from arena_core import ArenaError
from arena_core.cli.main import main
from arena_core.commands import print_notice
from arena_core.records import read_record
from arena_ros.bags.bag_readers import open_bags
from arena_ros.bags.scenarios import simplify_path
from arena_ros.codec import get_codec
from arena_ros.testing import write_site
from arena_ros.testing.recordings import import_apart, write_laboratory

Recording = Callable[..., Path]
ENDINGS = ["bag", "mcap", "db3"]


def imported(*words: object) -> int:
    return main(["ros", "import", *map(str, words)])


def episodes(folder: Path) -> list[dict[str, str]]:
    import csv

    with (folder / "episodes.csv").open() as file:
        return list(csv.DictReader(file))


@pytest.mark.parametrize("ending", ENDINGS)
def test_a_run_comes_back_value_for_value(finished_run: Path, tmp_path: Path, ending: str) -> None:
    bag, back = tmp_path / f"run.{ending}", tmp_path / "back"
    assert main(["ros", "export", str(finished_run), "--to", str(bag)]) == 0
    assert imported(bag, "--out", back, "scans=true") == 0
    for path in sorted((finished_run / "records").glob("*.npz")):
        before, after = read_record(path), read_record(back / "records" / path.name)
        assert before.meta == after.meta
        for name, array in before.arrays.items():
            np.testing.assert_array_equal(after[name], array, err_msg=name)
            assert after[name].dtype == array.dtype
    times = [name for name in episodes(finished_run)[0] if name.startswith("planning_")]
    for before_row, after_row in zip(episodes(finished_run), episodes(back), strict=True):
        assert {k: v for k, v in before_row.items() if k not in times} == {
            k: v for k, v in after_row.items() if k not in times
        }


def test_routes_of_an_export_are_its_peoples_or_refused_and_older_exports_have_none() -> None:
    from arena_ros.bags.records import _route_arrays

    assert _route_arrays({"ids": [1]}) == {}
    found = _route_arrays({"ids": [1, 2, 3], "routes": [[[1.0, 2.0], [3.0, 4.0]], [], [[5.0, 6.0]]]})
    assert (found["route_points"].tolist(), found["route_offsets"].tolist()) == (
        [[1.0, 2.0], [3.0, 4.0], [5.0, 6.0]],
        [0, 2, 2, 3],
    )
    assert _route_arrays({"ids": [], "routes": []})["route_offsets"].tolist() == [0]
    for routes in ([[]], [[[1.0, 2.0]], [[1e300, 0.0]]], [[[1.0]], []], [[[np.nan, 0.0]], []], [["x"], []], 3, None):
        with pytest.raises((ValueError, TypeError)):
            _route_arrays({"ids": [1, 2], "routes": routes})


@pytest.mark.parametrize("ending", ENDINGS)
def test_another_reader_opens_an_export(finished_run: Path, tmp_path: Path, ending: str) -> None:
    from rosbags.highlevel import AnyReader
    from rosbags.typesys import Stores, get_typestore

    bag = tmp_path / f"run.{ending}"
    assert main(["ros", "export", str(finished_run), f"--to={bag}", "episodes=0"]) == 0
    record = read_record(finished_run / "records" / "0000.npz")
    with AnyReader([bag], default_typestore=get_typestore(Stores.ROS2_HUMBLE)) as reader:
        assert {"/tf", "/scan", "/map", "/odom", "/people", "/people_markers", "/plan"} <= {
            c.topic for c in reader.connections
        }
        truth = [c for c in reader.connections if c.topic == "/ground_truth"]
        poses: list[Any] = [reader.deserialize(raw, c.msgtype) for c, _, raw in reader.messages(truth)]
        xs = [odometry.pose.pose.position.x for odometry in poses]
    np.testing.assert_array_equal(xs, record["pose"][:, 0])


@pytest.mark.parametrize("ending", ENDINGS)
def test_a_foreign_recording_gives_what_was_driven(
    write_recording: Recording, tmp_path: Path, ending: str, capsys: pytest.CaptureFixture[str]
) -> None:
    print_notice.cache_clear()
    bag = write_recording(tmp_path / f"lab.{ending}", [(1.0, 2.0, 0.0), (5.0, 4.0, 0.0)])
    assert imported(bag, "--out", tmp_path / "out", "robot=turtlebot3", "planner=move_base") == 0
    first, second = (read_record(tmp_path / "out" / "records" / f"{k:04d}.npz") for k in range(2))
    assert [first.meta["outcome"], second.meta["outcome"]] == ["goal_reached"] * 2
    assert first.meta["columns"]["planner"] == "move_base"
    # the goal came at 1 s; map -> odom is applied
    np.testing.assert_allclose(first["pose"][0], [0.5, 0.0, 0.0], atol=1e-6)
    np.testing.assert_allclose(first["pose"][-1, 0], 1.7, atol=0.051)  # 0.3 m before the goal
    np.testing.assert_allclose(first["scan_min"][0], 5.0 - 0.5 - 0.1, atol=1e-4)
    np.testing.assert_allclose(first["clearance_people"][0], np.hypot(1.5, 2.0) - 0.113 - 0.3, atol=1e-5)
    np.testing.assert_allclose(first["command"][:-1, 0], 0.5)
    row = episodes(tmp_path / "out")[0]
    assert float(row["path_length"]) == pytest.approx(1.2, abs=0.06)
    assert float(row["clearance_people_min"]) > 0.0
    assert row["collisions"] == row["success"] == row["localization_error"] == ""
    said = capsys.readouterr().err
    assert "nothing recorded contacts" in said
    assert "no reference pose" in said


def test_what_is_known_not_to_have_been_is_counted(write_recording: Recording, tmp_path: Path) -> None:
    bag = write_recording(tmp_path / "lab.bag", [(0.0, 3.0, 0.0)], people=False)
    assert imported(bag, "--out", tmp_path / "out", "robot=turtlebot3", "without=contacts,people") == 0
    record = read_record(tmp_path / "out" / "records" / "0000.npz")
    # from the disc to the wall, the laser's mount included
    np.testing.assert_allclose(record["clearance"][0], 5.0 - 0.113, atol=1e-3)
    row = episodes(tmp_path / "out")[0]
    assert (row["collisions"], row["success"], row["encounters"]) == ("0.0", "1.0", "0.0")


def test_map_and_goal_may_be_said(write_recording: Recording, tmp_path: Path) -> None:
    site, bag = write_site(tmp_path), write_recording(tmp_path / "lab.bag", [])
    assert imported(bag, "--out", tmp_path / "out", "robot=turtlebot3", f"map={site}/map.yaml", "goal=3,0") == 0
    record = read_record(tmp_path / "out" / "records" / "0000.npz")
    assert (record.meta["world"]["known"], record.meta["scenario"]["goal"]) == (True, [3.0, 0.0, 0.0])
    assert record["pose"][-1, 0] == pytest.approx(2.7, abs=0.051)


def test_a_goal_that_is_not_reached_is_an_error_with_its_reason(write_recording: Recording, tmp_path: Path) -> None:
    bag = write_recording(tmp_path / "lab.mcap", [(0.0, 50.0, 0.0), (2.0, 60.0, 0.0), (4.0, 60.0, 0.0)])
    assert imported(bag, "--out", tmp_path / "out", "robot=jackal", "time_limit=7") == 0
    rows = episodes(tmp_path / "out")
    assert [row["outcome"] for row in rows] == ["error", "time_out"]  # a goal that is sent again is no new one
    assert "another goal came" in rows[0]["error"]


@pytest.mark.parametrize("ending", ["bag", "mcap"])
def test_a_recording_that_was_cut_off_gives_what_came_before(
    write_recording: Recording, tmp_path: Path, ending: str, capsys: pytest.CaptureFixture[str]
) -> None:
    whole = write_recording(tmp_path / f"lab.{ending}", [(0.0, 50.0, 0.0)], seconds=60.0).read_bytes()
    kept = []
    for share in (0.2, 0.55, 0.9, 0.999):
        cut = tmp_path / f"cut_{share}.{ending}"
        cut.write_bytes(whole[: int(len(whole) * share)])
        out = tmp_path / f"out_{share}"
        status = imported(cut, "--out", out, "robot=jackal")
        said = capsys.readouterr().err
        assert status in (0, 2)
        # in the last part of a file there is only its index
        assert status == 2 or share > 0.99 or "what came before is kept" in said
        kept.append(len(read_record(out / "records" / "0000.npz")["stamp"]) if status == 0 else 0)
    assert kept == sorted(kept)
    assert kept[-1] > 500


@pytest.mark.parametrize("ending", ENDINGS)
def test_no_spoilt_recording_brings_a_traceback(write_recording: Recording, tmp_path: Path, ending: str) -> None:
    whole = bytearray(write_recording(tmp_path / f"lab.{ending}", [(0.0, 2.0, 0.0)], seconds=3.0).read_bytes())
    random = np.random.default_rng(0)
    for _ in range(60):
        spoilt = whole.copy()
        for place in random.integers(0, len(spoilt), 20):
            spoilt[place] = random.integers(256)
        path = tmp_path / f"spoilt.{ending}"
        path.write_bytes(spoilt)
        try:
            with open_bags([path]) as (bag,):
                bag.channels()
                for _ in bag.messages(()):
                    pass
        except ArenaError:  # a line; all else is a fault of ours
            continue


def test_memory_does_not_grow_with_a_recording(tmp_path: Path) -> None:
    from rosbags.rosbag1 import Writer

    own = get_codec(1)
    picture = own.encode(own.make("std_msgs/msg/String", data="x" * 300_000), "std_msgs/msg/String")
    with Writer(tmp_path / "long.bag") as writer:
        channel = writer.add_connection("/camera", "std_msgs/msg/String", typestore=own.store)
        for k in range(300):
            writer.write(channel, k * 10**7, picture)
    assert (tmp_path / "long.bag").stat().st_size > 80e6
    tracemalloc.start()
    with open_bags([tmp_path / "long.bag"]) as (bag,):
        count = sum(1 for _ in bag.messages({"/camera"}))
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert count == 300
    assert peak < 10e6


@pytest.mark.slow
@pytest.mark.parametrize("ending", ["bag", "mcap"])
def test_memory_of_an_import_does_not_grow_with_the_recording(tmp_path: Path, ending: str) -> None:
    peaks = []
    for seconds in (5, 50):  # 10 and 100 MB
        bag = write_laboratory(tmp_path / f"{seconds}.{ending}", seconds, 200_000)
        peaks.append(import_apart(bag, tmp_path / f"out_{seconds}").megabytes)
        assert bag.stat().st_size > 1.9e6 * seconds
        bag.unlink()
    assert peaks[1] - peaks[0] < 20.0


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["scan=/nothing"], "scan is /nothing, which is not recorded; allowed: /scan, or none"),
        (
            ["scan=/odom"],
            "scan is /odom, which is a nav_msgs/msg/Odometry; allowed: a topic of sensor_msgs/msg/LaserScan",
        ),
        (["odometry=none"], "nothing says where the robot was"),
        (["without=walls"], "without has walls; allowed: people, contacts"),
        (["robot=nobody"], "robot"),
    ],
)
def test_wrong_words_are_one_line(
    write_recording: Recording, tmp_path: Path, words: list[str], said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    bag = write_recording(tmp_path / "lab.bag", [(0.0, 2.0, 0.0)], seconds=1.0)
    assert imported(bag, "--out", tmp_path / "out", *words) == 2
    lines = capsys.readouterr().err.splitlines()
    assert said in lines[-1]


def test_a_file_that_is_no_recording_is_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for name in ("a.bag", "a.mcap", "a.db3", "a.txt"):
        (tmp_path / name).write_bytes(b"no recording")
        assert imported(tmp_path / name, "--out", tmp_path / "out") == 2
        assert capsys.readouterr().err.count("\n") == 1


def test_a_recording_becomes_a_scenario_that_can_be_run(write_recording: Recording, tmp_path: Path) -> None:
    bag = write_recording(tmp_path / "lab.mcap", [(0.0, 4.0, 0.0)])
    target = tmp_path / "lab.json"
    assert main(["ros", "scenario-from", str(bag), "--out", str(target), "robot=jackal"]) == 0
    (problem,) = json.loads(target.read_text())["scenarios"]
    assert problem["start"][:2] == [0.0, 0.0]
    assert problem["goal"] == [4.0, 0.0, 0.0]
    assert problem["pedestrians"] == [{"position": [2.0, 2.0], "radius": 0.3, "waypoints": []}]
    room = ["world=empty", "world.width=20", "world.height=20", "robot=jackal"]
    assert main(["scenario", "show", str(target)]) == 0
    assert main(["scenario", "check", str(target), *room]) in (0, 1)


def test_a_way_is_kept_by_its_corners() -> None:
    way = np.concatenate(
        (np.stack((np.linspace(0, 4, 50), np.zeros(50)), 1), np.stack((np.full(50, 4.0), np.linspace(0, 3, 50)), 1))
    )
    np.testing.assert_allclose(way[simplify_path(way, 0.3)], [[0, 0], [4, 0], [4, 3]], atol=0.1)
