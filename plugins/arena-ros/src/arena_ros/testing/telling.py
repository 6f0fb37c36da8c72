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
from arena_ros.bags.exporting import writer
from arena_ros.codec import PEOPLE, codec
from arena_ros.commands import RosCommand

SECOND = 10**9
BEGIN = 1_700_000_000 * SECOND
OWN = codec(2)
ODOM = Pose(1.0, 2.0, math.pi / 2.0)  # in map
LASER = Pose(0.2, 0.0, 0.3)  # in base_link
GOAL, PERSON = Pose(1.0, 7.0), Pose(2.0, 5.0)  # in map
BASELINE_SECONDS, BASELINE_LENGTH, BASELINE_START = 9.4, 4.7, (1.0, 2.03)  # s, m, m


@dataclass(frozen=True)
class Told:
    """A message: when it was recorded and what it says at a stamp in ns."""

    seconds: float
    topic: str
    type: str
    make: Callable[[int], Any]


def driven(seconds: float) -> float:
    """Return how far the robot has come, m."""
    return 0.5 * max(seconds - 0.5, 0.0)


def robot(seconds: float) -> Pose:
    """Return where the robot is, in map."""
    return ODOM.compose(Pose(driven(seconds), 0.0))


def odometry(pose: Callable[[float], Pose], topic: str = "/odom", frame: str = "odom") -> Iterator[Told]:
    """Yield a pose 25 times a second, as odometry has it."""
    for k in range(301):
        t = 0.04 * k
        yield Told(t, topic, to.ODOMETRY, partial(_odometry, pose(t), frame))


def drive(odom: Pose = ODOM) -> list[Told]:
    """Return 12 s of a robot that drives up along y, without a goal."""
    told = [Told(0.0, "/tf_static", to.TF, lambda ns: to.transforms(OWN, [("base_link", "laser", LASER)], ns))]
    told += odometry(lambda t: Pose(driven(t), 0.0))
    told += [Told(0.04 * k, "/tf", to.TF, lambda ns: to.transforms(OWN, [("map", "odom", odom)], ns)) for k in range(301)]
    return told + [Told(0.1 * k, "/cmd_vel", to.TWIST, lambda ns: to.twist(OWN, Twist(0.5))) for k in range(121)]


def goal(pose: Pose = GOAL, frame: str = "map", seconds: float = 0.55) -> list[Told]:
    """Return the goal, sent once."""
    return [Told(seconds, "/goal_pose", to.POSE_STAMPED, lambda ns: to.pose_stamped(OWN, pose, ns, frame))]


def people(frame: str, place: Callable[[float], Pose]) -> Iterator[Told]:
    """Yield one person ten times a second, in a frame."""
    for k in range(120):
        t = 0.1 * k
        places = np.array([place(t).array()[:2]])
        yield Told(t, "/people", PEOPLE, partial(_person, places, frame))


def _odometry(pose: Pose, frame: str, stamp: int) -> Any:
    return to.odometry(OWN, pose, Twist(0.5), stamp, frame, "base_link")


def _made(name: str, fields: Mapping[str, Any], stamp: int) -> Any:
    return OWN.make(name, **fields)


def _person(places: Any, frame: str, stamp: int) -> Any:
    x, y = places[0]
    person = OWN.make(
        "people_msgs/msg/Person",
        name="3",
        position=to.point(OWN, x, y),
        velocity=to.point(OWN, 0.0, 0.0),
        reliability=1.0,
        tagnames=[],
        tags=[],
    )
    return OWN.make(PEOPLE, header=OWN.header(stamp, frame), people=[person])


def counts(topic: str, name: str, values: Iterable[tuple[float, Any]]) -> Iterator[Told]:
    """Yield a topic of std_msgs: a value at a time, None for an empty message."""
    for t, value in values:
        fields = {"structure_needs_at_least_one_member": 0} if value is None else {"data": value}
        yield Told(t, topic, f"std_msgs/msg/{name}", partial(_made, f"std_msgs/msg/{name}", fields))


def in_order(told: Iterable[Told]) -> list[Told]:
    """Return messages by time."""
    return sorted(told, key=lambda each: each.seconds)


def equal_clocks(seconds: float, topic: str) -> int:
    """Return the stamp of a message by the recorder's own clock, ns."""
    return BEGIN + round(seconds * SECOND)


def written(
    path: Path,
    told: Iterable[Told],
    stamped: Callable[[float, str], int] = equal_clocks,
    recorded: Callable[[float], int] = lambda seconds: BEGIN + round(seconds * SECOND),
) -> Path:
    """Write messages in the order in which they are given; return the file."""
    with writer(path, OWN) as write:
        for each in told:
            write(each.topic, each.type, recorded(each.seconds), each.make(stamped(each.seconds, each.topic)))
    return next(iter(path.glob(f"*{path.suffix}")))


def imported(bag: Path, out: Path, *words: str) -> list[EpisodeRecord]:
    """Return the episodes of a recording."""
    print_notice.cache_clear()
    assert RosCommand().run(["import", str(bag), f"--out={out}", "robot=turtlebot3", *words]) == 0
    return [read_record(path) for path in sorted(record_paths(out))]


def length(record: EpisodeRecord) -> float:
    """Return how far a recorded robot has come, m."""
    return float(np.hypot(*np.diff(record["pose"][:, :2], axis=0).T).sum())


def assert_baseline(record: EpisodeRecord, tolerance: float = 0.02) -> None:
    """Assert that an episode is the drive as it was, from its goal on."""
    assert record.meta["outcome"] == "goal_reached"
    np.testing.assert_allclose(record["stamp"][-1], BASELINE_SECONDS, atol=0.11)
    np.testing.assert_allclose(length(record), BASELINE_LENGTH, atol=0.06)
    np.testing.assert_allclose(record["pose"][0, :2], BASELINE_START, atol=tolerance)
