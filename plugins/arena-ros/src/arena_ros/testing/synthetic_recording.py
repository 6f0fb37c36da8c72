"""One drive as a recording may tell of it: in other frames, by other clocks, in another order."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from arena_core import EpisodeRecord, Pose, Twist
from arena_core.commands import print_notice
from arena_core.records import read_record, record_paths
from arena_ros import conversions as to
from arena_ros.bags.exporting import open_writer
from arena_ros.codec import PEOPLE, get_codec
from arena_ros.commands import RosCommand

SECOND = 10**9
BEGIN = 1_700_000_000 * SECOND
OWN = get_codec(2)
ODOM = Pose(1.0, 2.0, math.pi / 2.0)  # in map
LASER = Pose(0.2, 0.0, 0.3)  # in base_link
GOAL, PERSON = Pose(1.0, 7.0), Pose(2.0, 5.0)  # in map
BASELINE_SECONDS, BASELINE_LENGTH, BASELINE_START = 9.4, 4.7, (1.0, 2.03)  # s, m, m


@dataclass(frozen=True)
class RecordedMessage:
    """A message: when it was recorded and what it says at a stamp in ns."""

    seconds: float
    topic: str
    type: str
    make: Callable[[int], Any]


def driven_distance(seconds: float) -> float:
    """Return how far the robot has come, m."""
    return 0.5 * max(seconds - 0.5, 0.0)


def robot_pose(seconds: float) -> Pose:
    """Return where the robot is, in map."""
    return ODOM.compose(Pose(driven_distance(seconds), 0.0))


def odometry_messages(
    pose: Callable[[float], Pose], topic: str = "/odom", frame: str = "odom"
) -> Iterator[RecordedMessage]:
    """Yield a pose 25 times a second, as odometry has it."""
    for k in range(301):
        t = 0.04 * k
        yield RecordedMessage(t, topic, to.ODOMETRY, partial(_make_odometry, pose(t), frame))


def drive_messages(odom: Pose = ODOM) -> list[RecordedMessage]:
    """Return 12 s of a robot that drives up along y, without a goal."""
    told = [
        RecordedMessage(
            0.0, "/tf_static", to.TF, lambda ns: to.transforms_msg(OWN, [("base_link", "laser", LASER)], ns)
        )
    ]
    told += odometry_messages(lambda t: Pose(driven_distance(t), 0.0))
    told += [
        RecordedMessage(0.04 * k, "/tf", to.TF, lambda ns: to.transforms_msg(OWN, [("map", "odom", odom)], ns))
        for k in range(301)
    ]
    return told + [
        RecordedMessage(0.1 * k, "/cmd_vel", to.TWIST, lambda ns: to.twist_msg(OWN, Twist(0.5))) for k in range(121)
    ]


def goal_message(pose: Pose = GOAL, frame: str = "map", seconds: float = 0.55) -> list[RecordedMessage]:
    """Return the goal, sent once."""
    return [
        RecordedMessage(seconds, "/goal_pose", to.POSE_STAMPED, lambda ns: to.pose_stamped_msg(OWN, pose, ns, frame))
    ]


def people_messages(frame: str, place: Callable[[float], Pose]) -> Iterator[RecordedMessage]:
    """Yield one person ten times a second, in a frame."""
    for k in range(120):
        t = 0.1 * k
        places = np.array([place(t).array()[:2]])
        yield RecordedMessage(t, "/people", PEOPLE, partial(_make_person, places, frame))


def _make_odometry(pose: Pose, frame: str, stamp: int) -> Any:
    return to.odometry_msg(OWN, pose, Twist(0.5), to.Header(stamp, frame), "base_link")


def _make_message(name: str, fields: Mapping[str, Any], stamp: int) -> Any:
    return OWN.make(name, **fields)


def _make_person(places: Any, frame: str, stamp: int) -> Any:
    x, y = places[0]
    person = OWN.make(
        "people_msgs/msg/Person",
        name="3",
        position=to.point_msg(OWN, x, y),
        velocity=to.point_msg(OWN, 0.0, 0.0),
        reliability=1.0,
        tagnames=[],
        tags=[],
    )
    return OWN.make(PEOPLE, header=OWN.header(stamp, frame), people=[person])


def count_topic(topic: str, name: str, values: Iterable[tuple[float, Any]]) -> Iterator[RecordedMessage]:
    """Yield a topic of std_msgs: a value at a time, None for an empty message."""
    for t, value in values:
        fields = {"structure_needs_at_least_one_member": 0} if value is None else {"data": value}
        yield RecordedMessage(t, topic, f"std_msgs/msg/{name}", partial(_make_message, f"std_msgs/msg/{name}", fields))


def in_order(told: Iterable[RecordedMessage]) -> list[RecordedMessage]:
    """Return messages by time."""
    return sorted(told, key=lambda each: each.seconds)


def equal_clocks(seconds: float, topic: str) -> int:
    """Return the stamp of a message by the recorder's own clock, ns."""
    return BEGIN + round(seconds * SECOND)


def write_recording(
    path: Path,
    told: Iterable[RecordedMessage],
    stamped: Callable[[float, str], int] = equal_clocks,
    recorded: Callable[[float], int] = lambda seconds: BEGIN + round(seconds * SECOND),
) -> Path:
    """Write messages in the order in which they are given; return the file."""
    with open_writer(path, OWN) as write:
        for each in told:
            write(each.topic, each.type, recorded(each.seconds), each.make(stamped(each.seconds, each.topic)))
    return next(iter(path.glob(f"*{path.suffix}")))


def import_recording(bag: Path, out: Path, *words: str) -> list[EpisodeRecord]:
    """Return the episodes of a recording."""
    print_notice.cache_clear()
    assert RosCommand().run(["import", str(bag), f"--out={out}", "robot=turtlebot3", *words]) == 0
    return [read_record(path) for path in sorted(record_paths(out))]


def path_length(record: EpisodeRecord) -> float:
    """Return how far a recorded robot has come, m."""
    return float(np.hypot(*np.diff(record["pose"][:, :2], axis=0).T).sum())


def assert_baseline(record: EpisodeRecord, tolerance: float = 0.02) -> None:
    """Assert that an episode is the drive as it was, from its goal on."""
    assert record.meta["outcome"] == "goal_reached"
    np.testing.assert_allclose(record["stamp"][-1], BASELINE_SECONDS, atol=0.11)
    np.testing.assert_allclose(path_length(record), BASELINE_LENGTH, atol=0.06)
    np.testing.assert_allclose(record["pose"][0, :2], BASELINE_START, atol=tolerance)
