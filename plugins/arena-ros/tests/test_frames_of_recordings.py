"""Places that are told in other frames than the map."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from arena_core import Pose
from arena_ros import conversions as to
from arena_ros.testing.synthetic_recording import (
    GOAL,
    LASER,
    ODOM,
    OWN,
    PERSON,
    RecordedMessage,
    assert_baseline,
    drive_messages,
    goal_message,
    import_recording,
    in_order,
    odometry_messages,
    people_messages,
    robot_pose,
    write_recording,
)

CLEARANCE = 0.587  # m, from the robot's footprint to the person as it passes
PERSON_BY_FRAME: dict[str, Callable[[float], Pose]] = {
    "map": lambda t: PERSON,
    "/map": lambda t: PERSON,
    "odom": lambda t: ODOM.relative(PERSON),
    "base_link": lambda t: robot_pose(t).relative(PERSON),
    "base_footprint": lambda t: robot_pose(t).relative(PERSON),
    "laser": lambda t: robot_pose(t).compose(LASER).relative(PERSON),
}


@pytest.mark.parametrize("frame", PERSON_BY_FRAME)
def test_people_are_where_they_were_in_any_frame(tmp_path: Path, frame: str) -> None:
    bag = write_recording(
        tmp_path / "a.mcap",
        in_order([*drive_messages(), *goal_message(), *people_messages(frame, PERSON_BY_FRAME[frame])]),
    )
    (record,) = import_recording(bag, tmp_path / "out")
    np.testing.assert_allclose(record["clearance_people"].min(), CLEARANCE, atol=0.01)
    np.testing.assert_allclose(record["pedestrian_positions"][5, 0], [PERSON.x, PERSON.y], atol=0.03)


@pytest.mark.parametrize(
    ("frame", "place", "reached"),
    [
        ("odom", ODOM.relative(GOAL), GOAL),
        ("base_link", Pose(5.0, 0.0), Pose(1.0, 7.025)),  # 5 m ahead of where the robot was then
        ("laser", LASER.relative(Pose(5.0, 0.0)), Pose(1.0, 7.025)),
        ("", GOAL, GOAL),
    ],
)
def test_goal_is_taken_to_the_map(tmp_path: Path, frame: str, place: Pose, reached: Pose) -> None:
    (record,) = import_recording(
        write_recording(tmp_path / "a.mcap", in_order([*drive_messages(), *goal_message(place, frame)])),
        tmp_path / "out",
    )
    np.testing.assert_allclose(record.meta["scenario"]["goal"][:2], [reached.x, reached.y], atol=0.02)
    assert_baseline(record)


@pytest.mark.parametrize(
    ("extra", "said"),
    [
        (goal_message(GOAL, "world"), "a goal is in the frame world, which nothing links to map; left out"),
        (
            [*goal_message(), *people_messages("camera", lambda t: PERSON)],
            "people are in the frame camera, which nothing links to map; left out",
        ),
        (
            [*goal_message(), *odometry_messages(robot_pose, "/ground_truth", "mocap")],
            "reference poses are in the frame mocap, which nothing links to map; left out",
        ),
    ],
)
def test_what_nothing_links_to_the_map_is_left_out_and_said(
    tmp_path: Path, extra: list[RecordedMessage], said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    (record,) = import_recording(
        write_recording(tmp_path / "a.mcap", in_order([*drive_messages(), *extra])), tmp_path / "out"
    )
    assert said in capsys.readouterr().err
    assert record.meta["truth"] == "estimated"


def test_frames_can_be_said_to_be_the_same(tmp_path: Path) -> None:
    bag = write_recording(
        tmp_path / "a.mcap",
        in_order(
            [*drive_messages(), *goal_message(GOAL, "world"), *odometry_messages(robot_pose, "/ground_truth", "world")]
        ),
    )
    (record,) = import_recording(bag, tmp_path / "out", "map_frame=map,world")
    assert record.meta["truth"] == "reference"
    assert_baseline(record)


def test_map_frame_that_is_not_there_is_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    from arena_core.cli.main import main

    bag = write_recording(tmp_path / "a.mcap", in_order([*drive_messages(), *goal_message()]))
    assert main(["ros", "import", str(bag), f"--out={tmp_path / 'out'}", "robot=turtlebot3", "map_frame=here"]) == 2
    assert (
        "map_frame is here, to which nothing links the robot; allowed: base_link, laser, map, odom"
        in capsys.readouterr().err
    )


def test_reference_in_odom_is_taken_to_the_map(tmp_path: Path) -> None:
    bag = write_recording(
        tmp_path / "a.mcap",
        in_order(
            [
                *drive_messages(),
                *goal_message(),
                *odometry_messages(lambda t: ODOM.relative(robot_pose(t)), "/ground_truth"),
            ]
        ),
    )
    (record,) = import_recording(bag, tmp_path / "out")
    assert record.meta["truth"] == "reference"
    assert_baseline(record)


def estimates(frame: str, place: Callable[[float], Pose]) -> list[RecordedMessage]:
    def make(ns: int, t: float) -> object:
        return to.pose_covariance_msg(OWN, place(t), np.eye(3) * 0.01, ns, frame)

    return [
        RecordedMessage(0.04 * k, "/amcl_pose", to.POSE_COVARIANCE, lambda ns, t=0.04 * k: make(ns, t))
        for k in range(0, 301, 5)
    ]


def test_amcl_pose_in_odom_is_taken_to_the_map(tmp_path: Path) -> None:
    told = [each for each in drive_messages() if each.topic != "/odom"]
    bag = write_recording(
        tmp_path / "a.mcap",
        in_order([*told, *goal_message(), *estimates("odom", lambda t: ODOM.relative(robot_pose(t)))]),
    )
    (record,) = import_recording(bag, tmp_path / "out")
    assert_baseline(record, 0.06)


def test_amcl_pose_stands_for_transforms_that_were_not_recorded(tmp_path: Path) -> None:
    told = [each for each in drive_messages() if each.topic != "/tf"]
    (record,) = import_recording(
        write_recording(tmp_path / "a.mcap", in_order([*told, *goal_message(), *estimates("map", robot_pose)])),
        tmp_path / "out",
    )
    assert_baseline(record)


def test_path_in_odom_is_taken_to_the_map(tmp_path: Path) -> None:
    poses = np.array([[0.0, 0.0, 0.0], [5.0, 0.0, 0.0]])
    plan = [RecordedMessage(2.0, "/plan", to.PATH, lambda ns: to.path_msg(OWN, poses, ns, "odom"))]
    (record,) = import_recording(
        write_recording(tmp_path / "a.mcap", in_order([*drive_messages(), *goal_message(), *plan])), tmp_path / "out"
    )
    np.testing.assert_allclose(record["path_poses"], [[1.0, 2.0, math.pi / 2], [1.0, 7.0, math.pi / 2]], atol=1e-5)


def test_transforms_alone_say_where_the_robot_was(tmp_path: Path) -> None:
    def chain(ns: int, t: float) -> object:
        return to.transforms_msg(OWN, [("odom", "base_footprint", Pose(0.5 * max(t - 0.5, 0.0), 0.0))], ns)

    told = [each for each in drive_messages() if each.topic != "/odom"]
    told += [RecordedMessage(0.04 * k, "/tf", to.TF, lambda ns, t=0.04 * k: chain(ns, t)) for k in range(301)]
    (record,) = import_recording(
        write_recording(tmp_path / "a.mcap", in_order([*told, *goal_message()])), tmp_path / "out"
    )
    assert_baseline(record)
