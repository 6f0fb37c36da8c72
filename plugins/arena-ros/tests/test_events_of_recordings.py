"""Counters of resets and collisions, robots that are set elsewhere, numbers that are none,
coordinates far from their origin.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from arena_core import OccupancyGrid, Pose, Twist
from arena_core.cli.main import main
from arena_ros import conversions as to
from arena_ros.testing.synthetic_recording import (
    GOAL,
    OWN,
    PERSON,
    RecordedMessage,
    assert_baseline,
    count_topic,
    drive_messages,
    driven_distance,
    goal_message,
    import_recording,
    in_order,
    odometry_messages,
    path_length,
    people_messages,
    robot_pose,
    write_recording,
)

NAN = float("nan")
JUMPS = (8.0, 16.0, 24.0)  # s


def place(seconds: float) -> Pose:
    """Return where a robot is that is set 28 m away every 8 s."""
    jumps = sum(seconds >= each for each in JUMPS)
    since = seconds - max((each for each in JUMPS if seconds >= each), default=0.0)
    return Pose(28.0 * (jumps % 2) + 0.5 * since, 3.0 * jumps)


def jumping() -> list[RecordedMessage]:
    told = []
    for k in range(800):
        t = 0.04 * k
        told.append(
            RecordedMessage(
                t,
                "/odom",
                to.ODOMETRY,
                lambda ns, t=t: to.odometry_msg(OWN, place(t), Twist(0.5), to.Header(ns, "odom"), "base_link"),
            )
        )
        told.append(
            RecordedMessage(t, "/tf", to.TF, lambda ns: to.transforms_msg(OWN, [("map", "odom", Pose(0.0, 0.0))], ns))
        )
    return told


def steadily(value: Any) -> list[tuple[float, Any]]:
    return [(0.1 * k, value(0.1 * k)) for k in range(320)]


RESETS: dict[str, list[RecordedMessage]] = {
    "no topic": [],
    "Int16 at each": list(count_topic("/scenario_reset", "Int16", [(t + 0.05, k + 1) for k, t in enumerate(JUMPS)])),
    "Int16 all the time": list(
        count_topic("/scenario_reset", "Int16", steadily(lambda t: sum(t >= each for each in JUMPS)))
    ),
    "Int16 that was 7 before": list(
        count_topic("/scenario_reset", "Int16", steadily(lambda t: 7 + sum(t >= each for each in JUMPS)))
    ),
    "Bool": list(count_topic("/reset", "Bool", steadily(lambda t: any(0.0 <= t - each < 0.3 for each in JUMPS)))),
    "Empty, before": list(count_topic("/reset", "Empty", [(t - 0.1, None) for t in JUMPS])),
    "Empty, after": list(count_topic("/reset", "Empty", [(t + 0.3, None) for t in JUMPS])),
}


@pytest.mark.parametrize("reset", RESETS)
def test_robot_that_is_set_elsewhere_begins_a_new_episode(tmp_path: Path, reset: str) -> None:
    records = import_recording(
        write_recording(tmp_path / "a.mcap", in_order([*jumping(), *RESETS[reset]])), tmp_path / "out"
    )
    assert len(records) == 4
    for record in records:
        assert path_length(record) == pytest.approx(0.5 * record["stamp"][-1], abs=0.01)  # no jump counts as path


@pytest.mark.parametrize("delay", [0.3, -0.2])
def test_goals_and_jumps_that_come_together_are_one_beginning(tmp_path: Path, delay: float) -> None:
    goals = [
        each
        for t in (0.0, *JUMPS)
        for each in goal_message(Pose(place(t + 0.01).x + 3.0, place(t + 0.01).y), "map", max(t + delay, 0.1))
    ]
    records = import_recording(write_recording(tmp_path / "a.mcap", in_order([*jumping(), *goals])), tmp_path / "out")
    assert [record.meta["outcome"] for record in records] == ["goal_reached"] * 4
    assert max(path_length(record) for record in records) < 2.8


@pytest.mark.parametrize("delay", [0.2, -0.2])
def test_goals_and_resets_that_come_together_are_one_beginning(tmp_path: Path, delay: float) -> None:
    goals = [
        each
        for t in (0.0, *JUMPS)
        for each in goal_message(Pose(place(t + 0.01).x + 3.0, place(t + 0.01).y), "map", t + 0.3)
    ]
    resets = count_topic(
        "/scenario_reset", "Int16", [(t + 0.3 + delay, k) for k, t in enumerate((0.0, *JUMPS, 30.0), 1)]
    )
    records = import_recording(
        write_recording(tmp_path / "a.mcap", in_order([*jumping(), *goals, *resets])), tmp_path / "out"
    )
    assert [record.meta["outcome"] for record in records] == ["goal_reached"] * 4


def test_jump_ends_the_drive_to_a_goal_as_an_error(tmp_path: Path) -> None:
    first, *_, last = import_recording(
        write_recording(tmp_path / "a.mcap", in_order([*jumping(), *goal_message(Pose(30.0, 9.0))])), tmp_path / "out"
    )
    assert (first.meta["outcome"], last.meta["outcome"]) == ("error", "goal_reached")
    assert "the robot jumped by 24.2 m, and the robot was not at its goal" in first.meta["error"]


@pytest.mark.parametrize(
    ("name", "values", "expected"),
    [
        ("Int16", [(0.1 * k, sum(0.1 * k >= each for each in (3, 5, 7))) for k in range(120)], 3),
        ("Int16", [(3.0, 1), (5.0, 2), (7.0, 4)], 4),
        ("UInt8", [(0.1 * k, 4) for k in range(120)], 0),
        ("Int32", [(0.0, 9), (3.0, 0), (5.0, 1)], 1),
        ("Bool", [(0.1 * k, any(0.0 <= 0.1 * k - each < 0.3 for each in (3, 5, 7))) for k in range(120)], 3),
        ("Empty", [(3.0, None), (5.0, None)], 2),
    ],
)
def test_collisions_are_counted(tmp_path: Path, name: str, values: list[tuple[float, Any]], expected: int) -> None:
    bag = write_recording(
        tmp_path / "a.mcap", in_order([*drive_messages(), *goal_message(), *count_topic("/collision", name, values)])
    )
    (record,) = import_recording(bag, tmp_path / "out")
    assert len(record["contact_stamp"]) == record["in_contact"].any() * expected == expected
    row = (tmp_path / "out" / "episodes.csv").read_text().splitlines()
    assert dict(zip(row[0].split(","), row[1].split(","), strict=True))["collisions"] == str(float(expected))


def between(told: list[RecordedMessage], topic: str, make: Any) -> list[RecordedMessage]:
    """Return messages with another one after every tenth of a topic."""
    own = [each for each in told if each.topic == topic]
    return in_order([*told, *(RecordedMessage(each.seconds + 0.001, topic, each.type, make) for each in own[::10])])


def scan_of_nan(stamp: int) -> Any:
    scan = to.LaserScan(0.0, 0.0, math.pi / 4, 0.1, 30.0, np.full(8, np.nan, np.float32), Pose(0.0, 0.0))
    message = to.scan_msg(OWN, scan, stamp, "laser", 0.1)
    message.angle_min = NAN
    return message


NOTHING = OccupancyGrid(np.zeros((4, 4), np.int8), 0.05, Pose(NAN, 0.0))
NO_NUMBERS: dict[str, tuple[list[RecordedMessage], str]] = {
    "odometry": (
        between(
            drive_messages(),
            "/odom",
            lambda ns: to.odometry_msg(OWN, Pose(NAN, math.inf), Twist(0.0), to.Header(ns, "odom"), "base_link"),
        ),
        "odometry that is no number; left out",
    ),
    "twist": (
        between(
            drive_messages(),
            "/odom",
            lambda ns: to.odometry_msg(OWN, Pose(0.0, 0.0), Twist(NAN), to.Header(ns, "odom"), "base_link"),
        ),
        "odometry that is no number; left out",
    ),
    "transform": (
        between(drive_messages(), "/tf", lambda ns: to.transforms_msg(OWN, [("map", "odom", Pose(NAN, 0.0, NAN))], ns)),
        "a transform that is no number; left out",
    ),
    "command": (
        between(drive_messages(), "/cmd_vel", lambda ns: to.twist_msg(OWN, Twist(NAN))),
        "a command that is no number; left out",
    ),
    "people": (
        [*drive_messages(), *people_messages("map", lambda t: Pose(NAN, 1.0))],
        "people whose place is no number; left out",
    ),
    "reference": (
        [
            *drive_messages(),
            *odometry_messages(lambda t: Pose(NAN, 0.0) if int(25 * t) % 3 else robot_pose(t), "/ground_truth", "map"),
        ],
        "a reference pose that is no number; left out",
    ),
    "estimate": (
        [
            *drive_messages(),
            RecordedMessage(
                1.0,
                "/amcl_pose",
                to.POSE_COVARIANCE,
                lambda ns: to.pose_covariance_msg(OWN, Pose(NAN, 0.0), np.eye(3), ns, "map"),
            ),
        ],
        "an estimate that is no number; left out",
    ),
    "path": (
        [
            *drive_messages(),
            RecordedMessage(
                1.0,
                "/plan",
                to.PATH,
                lambda ns: to.path_msg(OWN, np.array([[0.0, 0.0, 0.0], [NAN, 0.0, 0.0]]), ns, "map"),
            ),
        ],
        "poses of a path that are no numbers; left out",
    ),
    "scan": (
        [*drive_messages(), RecordedMessage(1.0, "/scan", to.SCAN, scan_of_nan)],
        "a scan whose angles or ranges are no numbers; left out",
    ),
    "map": (
        [*drive_messages(), RecordedMessage(0.1, "/map", to.GRID, lambda ns: to.grid_msg(OWN, NOTHING, ns, "map"))],
        "a map whose place is no number",
    ),
    "goal": ([*drive_messages(), *goal_message(Pose(NAN, 0.0), seconds=0.3)], "a goal that is no number; left out"),
}


@pytest.mark.parametrize("kind", NO_NUMBERS)
def test_what_is_no_number_is_left_out_and_said(tmp_path: Path, kind: str, capsys: pytest.CaptureFixture[str]) -> None:
    told, said = NO_NUMBERS[kind]
    (record,) = import_recording(
        write_recording(tmp_path / "a.mcap", in_order([*told, *goal_message()])), tmp_path / "out"
    )
    assert_baseline(record)
    assert said in capsys.readouterr().err


def test_utm_coordinates_are_shifted_and_said(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    odom = Pose(500_123.4, 5_400_987.6, math.pi / 2.0)
    far = odom.compose(Pose(5.0, 0.0))
    told = [
        *drive_messages(odom),
        *goal_message(far),
        *people_messages("map", lambda t: Pose(odom.x + 1.0, odom.y + 3.0)),
    ]
    (record,) = import_recording(write_recording(tmp_path / "a.mcap", in_order(told)), tmp_path / "out")
    assert "places lie far from the origin of map; shifted by -500000, -5401000 m" in capsys.readouterr().err
    assert record.meta["shift"] == [500_000.0, 5_401_000.0]
    np.testing.assert_allclose(record.meta["scenario"]["goal"][:2], [far.x - 500_000.0, far.y - 5_401_000.0], atol=1e-3)
    np.testing.assert_allclose(record["clearance_people"].min(), 0.587, atol=0.01)
    assert_baseline(record, 1e7)


@pytest.mark.parametrize(
    "when", [lambda t: abs(t - 5.0) < 0.01, lambda t: t < 0.01, lambda t: t > 11.0], ids=["once", "first", "last"]
)
def test_odometry_far_off_takes_no_memory(tmp_path: Path, when: Any) -> None:
    told = [each for each in drive_messages() if each.topic != "/odom"]
    told += odometry_messages(lambda t: Pose(1e6, 1e6) if when(t) else Pose(driven_distance(t), 0.0))
    (record,) = import_recording(
        write_recording(tmp_path / "a.mcap", in_order([*told, *goal_message()])), tmp_path / "out"
    )
    assert_baseline(record)


def test_goal_that_no_robot_drives_to_is_left_out(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (record,) = import_recording(
        write_recording(tmp_path / "a.mcap", in_order([*drive_messages(), *goal_message(Pose(6e6, 0.0))])),
        tmp_path / "out",
    )
    assert "a goal that is 6000 km away; left out" in capsys.readouterr().err
    assert abs(record.meta["scenario"]["goal"][0]) < 10.0


def test_scenario_of_a_recording_has_its_goal_and_people_in_the_map(tmp_path: Path) -> None:
    import json

    told = [
        *drive_messages(),
        *goal_message(Pose(5.0, 0.0), "odom"),
        *people_messages("base_link", lambda t: robot_pose(t).relative(PERSON)),
    ]
    bag, target = write_recording(tmp_path / "a.mcap", in_order(told)), tmp_path / "lab.json"
    assert main(["ros", "scenario-from", str(bag), f"--out={target}", "robot=turtlebot3"]) == 0
    (problem,) = json.loads(target.read_text())["scenarios"]
    np.testing.assert_allclose(problem["goal"][:2], [GOAL.x, GOAL.y], atol=1e-3)
    np.testing.assert_allclose(problem["pedestrians"][0]["position"], [PERSON.x, PERSON.y], atol=0.03)
