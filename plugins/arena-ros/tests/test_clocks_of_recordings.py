"""Recordings whose stamps are of other clocks than the recorder's, and whose messages are in
another order than that of time.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from arena_core import Pose, Twist
from arena_ros import conversions as to
from arena_ros.testing.synthetic_recording import (
    BEGIN,
    GOAL,
    OWN,
    SECOND,
    RecordedMessage,
    assert_baseline,
    drive_messages,
    equal_clocks,
    goal_message,
    import_recording,
    in_order,
    odometry_messages,
    robot_pose,
    write_recording,
)


def shifted(by: float, *topics: str, rate: float = 1.0) -> Callable[[float, str], int]:
    """Return stamps of these topics, of all where there are none, by another clock."""
    return lambda t, topic: equal_clocks(rate * t + by if not topics or topic in topics else t, topic)


def clock() -> list[RecordedMessage]:
    return [
        RecordedMessage(0.01 * k, "/clock", to.CLOCK, lambda ns: OWN.make(to.CLOCK, clock=OWN.time(ns)))
        for k in range(1200)
    ]


@pytest.mark.parametrize("topics", [(), ("/odom",), ("/goal_pose",)])
@pytest.mark.parametrize("by", [0.5, -0.5, -5.0, 1e5])
def test_one_offset_a_clock_gives_the_drive_as_it_was(tmp_path: Path, by: float, topics: tuple[str, ...]) -> None:
    bag = write_recording(tmp_path / "a.mcap", in_order([*drive_messages(), *goal_message()]), shifted(by, *topics))
    (record,) = import_recording(bag, tmp_path / "out")
    assert_baseline(record)


def test_offset_of_a_clock_is_said(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    import_recording(
        write_recording(tmp_path / "a.mcap", in_order([*drive_messages(), *goal_message()]), shifted(-5.0, "/odom")),
        tmp_path / "out",
    )
    said = capsys.readouterr().err
    assert "/odom: its clock is 5.00 s behind that of the recording; its stamps count" in said
    assert "/tf: its clock is 5.00 s ahead of that of /odom; shifted" in said


@pytest.mark.parametrize(
    "stamps",
    [shifted(0.0, rate=1.01), shifted(3.0, rate=1.0001), lambda t, topic: 0, lambda t, topic: BEGIN],
    ids=["fast", "drift", "none", "frozen"],
)
def test_clocks_that_drift_or_stand_still_give_the_drive(tmp_path: Path, stamps: Callable[[float, str], int]) -> None:
    (record,) = import_recording(
        write_recording(tmp_path / "a.mcap", in_order([*drive_messages(), *goal_message()]), stamps), tmp_path / "out"
    )
    assert_baseline(record)


@pytest.mark.parametrize("pace", [0.5, 2.0, 10.0])
@pytest.mark.parametrize("extra", [[], clock()], ids=["headers", "clock"])
def test_simulation_at_another_pace_counts_in_its_own_seconds(
    tmp_path: Path, pace: float, extra: list[RecordedMessage]
) -> None:
    def recorded(t: float) -> int:
        return BEGIN + round(t / pace * SECOND)

    bag = write_recording(
        tmp_path / "a.mcap",
        in_order([*drive_messages(), *goal_message(), *extra]),
        lambda t, topic: round((100.0 + t) * SECOND),
        recorded,
    )
    (record,) = import_recording(bag, tmp_path / "out")
    assert_baseline(record)


def test_clock_counts_where_headers_tell_wall_time(tmp_path: Path) -> None:
    def stamped(t: float, topic: str) -> int:
        return round((100.0 + t) * SECOND) if topic == "/clock" else BEGIN + round(2.0 * t * SECOND)

    told = in_order([*drive_messages(), *goal_message(), *clock()])
    (record,) = import_recording(
        write_recording(tmp_path / "a.mcap", told, stamped, lambda t: BEGIN + round(2.0 * t * SECOND)), tmp_path / "out"
    )
    assert_baseline(record)


def leap(t: float, when: bool) -> int:
    return equal_clocks(t + (1e8 if when else 0.0), "")


@pytest.mark.parametrize(
    "stamps",
    [
        lambda t, topic: leap(t, topic == "/odom" and abs(t - 6.0) < 0.01),
        lambda t, topic: leap(t, t > 6.0),
        lambda t, topic: leap(t, t > 6.0 and topic == "/odom"),
    ],
    ids=["one message", "all from there on", "one topic from there on"],
)
def test_stamps_that_leap_by_years_change_nothing(tmp_path: Path, stamps: Callable[[float, str], int]) -> None:
    (record,) = import_recording(
        write_recording(tmp_path / "a.mcap", in_order([*drive_messages(), *goal_message()]), stamps), tmp_path / "out"
    )
    assert_baseline(record)


def test_recorder_that_leaps_by_years_makes_two_episodes_of_few_rows(tmp_path: Path) -> None:
    def leapt(t: float, topic: str = "") -> int:
        return leap(t, t > 6.0)

    records = import_recording(
        write_recording(tmp_path / "a.mcap", in_order([*drive_messages(), *goal_message()]), leapt, leapt),
        tmp_path / "out",
    )
    assert [len(record["stamp"]) < 130 for record in records] == [True, True]


def test_clock_that_goes_back_begins_a_new_episode(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    stamps = shifted(-6.0)
    bag = write_recording(
        tmp_path / "a.mcap",
        in_order([*drive_messages(), *goal_message()]),
        lambda t, topic: stamps(t, topic) if t > 6.0 else equal_clocks(t, ""),
    )
    assert len(import_recording(bag, tmp_path / "out")) == 2
    assert "the clock went back: a new episode begins there" in capsys.readouterr().err


ORDERS: dict[str, Callable[[list[RecordedMessage]], list[RecordedMessage]]] = {
    "by topic": lambda told: sorted(told, key=lambda each: each.topic),
    "odometry late": lambda told: sorted(told, key=lambda each: each.seconds + 2.0 * (each.topic == "/odom")),
    "transforms late": lambda told: sorted(told, key=lambda each: each.seconds + 2.0 * (each.topic == "/tf")),
    "backwards": lambda told: told[::-1],
    "shuffled": lambda told: [told[k] for k in np.random.default_rng(0).permutation(len(told))],
    "parts swapped": lambda told: [*told[400:], *told[200:400], *told[:200]],
}


@pytest.mark.parametrize("ending", ["mcap", "db3"])
@pytest.mark.parametrize("order", ORDERS)
def test_order_of_messages_in_the_file_does_not_matter(tmp_path: Path, order: str, ending: str) -> None:
    bag = write_recording(tmp_path / f"a.{ending}", ORDERS[order](in_order([*drive_messages(), *goal_message()])))
    (record,) = import_recording(bag, tmp_path / "out")
    assert_baseline(record)


def test_recorder_by_simulated_time_that_begins_anew_gives_both_episodes(tmp_path: Path) -> None:
    first = in_order([*drive_messages(), *goal_message()])
    bag = write_recording(tmp_path / "a.mcap", [*first, *first])
    for record in import_recording(bag, tmp_path / "out"):
        assert_baseline(record)


def test_pose_is_that_of_amcl_whose_transforms_are_stamped_ahead(tmp_path: Path) -> None:
    """As Nav2 records it: simulated time in headers, wall time at the recorder, AMCL's transforms stamped 1
    s ahead; odometry drifts.
    """

    def measured(t: float) -> Pose:
        return Pose(0.22 * t, 0.0, 0.02 * t)

    def correction(t: float) -> Pose:
        return Pose(0.02 * t, 0.03 * t, -0.015 * t)

    def believed(t: float) -> Pose:
        return correction(t).compose(measured(t))

    told = list(odometry_messages(measured))
    for k in range(60):
        t = 0.2 * k
        told.append(
            RecordedMessage(
                t + 0.05,
                "/tf",
                to.TF,
                lambda ns, t=t: to.transforms_msg(OWN, [("map", "odom", correction(t))], ns + 950_000_000),
            )
        )
        told.append(
            RecordedMessage(
                t + 0.08,
                "/amcl_pose",
                to.POSE_COVARIANCE,
                lambda ns, t=t: to.pose_covariance_msg(OWN, believed(t), np.eye(3) * 0.01, ns - 80_000_000, "map"),
            )
        )
    bag = write_recording(tmp_path / "a.mcap", in_order(told), lambda t, topic: round((7.0 + t) * SECOND))
    (record,) = import_recording(bag, tmp_path / "out")
    seconds = record["stamp"] + 0.0
    off = [
        np.hypot(*(believed(t).array() - pose)[:2]) for t, pose in zip(seconds.tolist(), record["pose"], strict=True)
    ]
    assert np.mean(off) < 0.05
    assert len(record["stamp"]) == 121


def test_command_of_no_stamp_is_placed_in_the_robots_time(tmp_path: Path) -> None:
    told = [each for each in drive_messages() if each.topic != "/cmd_vel"]
    told += [
        RecordedMessage(0.1 * k, "/cmd_vel", to.TWIST, lambda ns, k=k: to.twist_msg(OWN, Twist(0.5 * (k > 50))))
        for k in range(121)
    ]
    (record,) = import_recording(
        write_recording(tmp_path / "a.mcap", in_order([*told, *goal_message(GOAL)]), shifted(-5.0)), tmp_path / "out"
    )
    begun = record["stamp"][np.flatnonzero(record["command"][:-1, 0] > 0.0)[0]]
    assert begun == pytest.approx(5.1 - 0.55, abs=0.11)
    assert robot_pose(0.55).distance(Pose.of(record["pose"][0])) < 0.02
