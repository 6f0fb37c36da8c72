"""Messages of a recording, one after the other, into episodes: one at a time is in memory."""

from __future__ import annotations

import heapq
import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from arena_core import Footprint, OccupancyGrid, Pose
from arena_ros import conversions as of
from arena_ros.bags.footprint import nearest
from arena_ros.bags.roles import Cast
from arena_ros.bags.series import People, Series
from arena_ros.bags.stream import Bag, Channel
from arena_ros.bags.watching import Watcher
from arena_ros.codec import BadMessage, Codec, stamp_of
from arena_ros.frames import BASES, Mount, mounted

JUMP = 10**9  # ns that the clock has to go back for a new beginning
FOREIGN_CLOCK = 10 * 10**9  # ns between the stamp in a message and its time of recording, beyond which only the latter counts
GOAL_MOVED = 0.05  # m between two goals that are not the same one sent again
LONGEST = 4 * 3600 * 10**9  # ns of one episode; what is longer is cut, so that no recording takes all memory


@dataclass(eq=False)
class Gathered:
    """All that was recorded of one episode; stamps in ns."""

    begin: int
    end: int
    goal: Pose | None = None
    why_ended: str = "the recording ended"
    meta: Mapping[str, Any] | None = None  # what our own export says of it
    ending: Mapping[str, Any] | None = None
    odometry: Series = field(default_factory=lambda: Series(6))  # x, y, theta in odom, vx, vy, wz
    reference: Series = field(default_factory=lambda: Series(6))  # x, y, theta in map, vx, vy, wz (NaN where only a pose)
    correction: Series = field(default_factory=lambda: Series(3))  # odom in map
    estimate: Series = field(default_factory=lambda: Series(12))  # pose in map and its covariance
    command: Series = field(default_factory=lambda: Series(3))
    scan: Series = field(default_factory=lambda: Series(2))  # nearest return, clearance by the scan
    waypoint: Series = field(default_factory=lambda: Series(3))
    state: list[tuple[int, NDArray[np.float64]]] = field(default_factory=list)
    ranges: list[tuple[int, NDArray[np.float32]]] = field(default_factory=list)
    paths: list[tuple[int, NDArray[np.float64]]] = field(default_factory=list)
    people: People = field(default_factory=People)

    def is_empty(self) -> bool:
        """Tell whether nothing says where the robot was."""
        return not (len(self.odometry) or len(self.reference) or len(self.estimate))


class Gatherer:
    """Takes messages in the order in which they were recorded, and yields episodes. ``watcher`` sees people in the scans."""

    def __init__(
        self, codec: Codec, cast: Cast, footprint: Footprint, mount: Pose, keep_scans: bool, watcher: Watcher | None = None
    ) -> None:
        self._codec, self._footprint, self._mount, self._keep_scans = codec, footprint, mount, keep_scans
        self._roles: dict[str, list[str]] = {}
        for role, channel in cast.by_role.items():
            self._roles.setdefault(channel.topic, []).append(role)
        self.by_markers = "episode" in cast.by_role
        self.topics = frozenset(self._roles)
        self._watcher = watcher
        self.grid: OccupancyGrid | None = None
        self.notes: dict[str, int] = {}
        self._foreign: dict[str, bool] = {}
        self._static: dict[str, tuple[str, Mount]] = {}
        self._last_odometry: Pose | None = None
        self._newest: int | None = None
        self._open: Gathered | None = None
        self._frames: dict[str, str] = {}

    def episodes(self, bags: Sequence[Bag]) -> Iterator[Gathered]:
        """Yield the episodes of recordings that are read side by side."""
        streams = [bag.messages(self.topics) for bag in bags]
        for channel, recorded, content in heapq.merge(*streams, key=_recorded) if len(streams) > 1 else streams[0]:
            try:
                message = self._codec.decode(content, channel.type)
            except BadMessage as bad:
                self._note(f"{channel.topic}: {bad}; left out")
                continue
            for role in self._roles[channel.topic]:
                yield from self._take(role, channel, recorded, message)
        yield from self._close("the recording ended")

    def _take(self, role: str, channel: Channel, recorded: int, message: Any) -> Iterator[Gathered]:
        if self._newest is not None and recorded < self._newest - JUMP:
            self._note("the clock went back: a new episode begins there")
            yield from self._close("the clock went back")
        self._newest = recorded
        if role == "episode":
            yield from self._mark(recorded, message)
            return
        if role == "reset":
            yield from self._close("a reset came")
            return
        if role == "goal" and not self.by_markers:
            yield from self._set_goal(recorded, of.pose_of(message.pose))
            return
        if role in ("map", "tf_static"):
            getattr(self, f"_take_{role}")(message)
            return
        if self._open is None:
            if self.by_markers:
                return
            self._begin(Gathered(recorded, recorded))
        now = self._open
        assert now is not None
        now.end = max(now.end, recorded)
        if take := getattr(self, f"_take_{role}", None):
            take(now, self._stamp(channel, recorded, message), message)
        if recorded - now.begin > LONGEST:
            self._note("an episode of more than 4 h is cut in two")
            yield from self._close("it took more than 4 h")

    def _mark(self, recorded: int, message: Any) -> Iterator[Gathered]:
        try:
            content = json.loads(message.data)
            kind = content["event"]
        except (ValueError, KeyError, TypeError):
            self._note("a mark of an episode is no JSON with an event; left out")
            return
        if kind == "begin":
            yield from self._close("the next episode began")
            self._begin(Gathered(recorded, recorded, meta=content))
        elif kind == "end" and self._open is not None:
            self._open.ending = content
            yield from self._close("")

    def _set_goal(self, recorded: int, goal: Pose) -> Iterator[Gathered]:
        before = self._open.goal if self._open is not None else None
        if before is not None and before.distance(goal) < GOAL_MOVED:
            return
        if before is not None:
            yield from self._close("another goal came")
        self._begin(Gathered(recorded, recorded, goal))  # what was recorded before a goal belongs to no episode

    def _begin(self, gathered: Gathered) -> None:
        self._open = gathered
        if self._watcher is not None:
            self._watcher.begin(self.grid)

    def _close(self, why: str) -> Iterator[Gathered]:
        finished, self._open, self._newest, self._last_odometry = self._open, None, None, None
        if finished is not None and not finished.is_empty():
            if self._watcher is not None:
                self._watcher.look(finished)
            finished.why_ended = why
            yield finished

    def _take_map(self, message: Any) -> None:
        try:
            self.grid = of.grid_of(message)
        except ValueError:
            self._note("a map has another number of cells than it says; left out")

    def _take_tf_static(self, message: Any) -> None:
        self._static |= of.mounts_of(message)

    def _take_tf(self, now: Gathered, stamp: int, message: Any) -> None:
        odom = self._frames.get("odom", "odom")
        links = of.links_of(message)
        if not {child for _, child, _, _ in links} <= self._static.keys():  # old robots tell there where their laser is
            self._static = of.mounts_of(message) | self._static
        for parent, child, pose, stamped in links:
            if child == odom:
                self._frames["map"] = parent
                now.correction.extend(stamped if not self._foreign.get("/tf") else stamp, pose.array())

    def _take_odometry(self, now: Gathered, stamp: int, message: Any) -> None:
        measured = of.odometry_of(message, 0.0)
        if not np.isfinite([*measured.pose.array(), *measured.twist.array()]).all():
            self._note("odometry that is no number; left out")
            return
        self._frames["odom"] = message.header.frame_id.lstrip("/") or "odom"
        self._frames["base"] = message.child_frame_id.lstrip("/") or "base_link"
        self._last_odometry = measured.pose
        now.odometry.extend(stamp, np.concatenate((measured.pose.array(), measured.twist.array())))

    def _take_reference(self, now: Gathered, stamp: int, message: Any) -> None:
        if hasattr(message, "twist"):
            now.reference.extend(stamp, np.concatenate((of.pose_of(message.pose.pose).array(), of.twist_of(message.twist.twist).array())))
        else:
            now.reference.extend(stamp, np.concatenate((of.pose_of(message.pose).array(), np.full(3, np.nan))))

    def _take_estimate(self, now: Gathered, stamp: int, message: Any) -> None:
        pose = of.pose_of(message.pose.pose)
        now.estimate.extend(stamp, np.concatenate((pose.array(), of.covariance_of(message.pose.covariance).ravel())))
        if self._last_odometry is not None and "tf" not in self._of_roles():
            now.correction.extend(stamp, pose.compose(self._last_odometry.relative(Pose(0.0, 0.0))).array())

    def _of_roles(self) -> set[str]:
        return {role for roles in self._roles.values() for role in roles}

    def _take_command(self, now: Gathered, stamp: int, message: Any) -> None:
        now.command.extend(stamp, of.twist_of(message).array())

    def _take_scan(self, now: Gathered, stamp: int, message: Any) -> None:
        scan = of.scan_of(message, 0.0, self._mounted(message.header.frame_id.lstrip("/")))
        now.scan.add(stamp, *nearest(self._footprint, scan))
        if self._watcher is not None:
            self._watcher.take(stamp, scan)
            self._watcher.look(now)
        if self._keep_scans:
            if now.ranges and len(now.ranges[0][1]) != len(scan.ranges):
                self._note("scans have different numbers of beams: they are not kept")
                self._keep_scans = False
                now.ranges.clear()
            else:
                now.ranges.append((stamp, scan.ranges))

    def _mounted(self, frame: str) -> Mount:
        """Return where a frame is in that of the base, by the static transforms; else where the robot's lidar is."""
        mount = mounted(self._static, frame, {self._frames.get("base", "base_link"), *BASES})
        return Mount(self._mount) if mount is None else mount

    def _take_people(self, now: Gathered, stamp: int, message: Any) -> None:
        if hasattr(message, "people"):
            seen = [
                (_number(person.name, k), person.position.x, person.position.y, person.velocity.x, person.velocity.y)
                for k, person in enumerate(message.people)
            ]
        else:
            seen = [(k, pose.position.x, pose.position.y, np.nan, np.nan) for k, pose in enumerate(message.poses)]
        now.people.add(stamp, seen)

    def _take_path(self, now: Gathered, stamp: int, message: Any) -> None:
        now.paths.append((stamp, of.path_of(message)))

    def _take_waypoint(self, now: Gathered, stamp: int, message: Any) -> None:
        now.waypoint.extend(stamp, of.pose_of(message.pose).array())

    def _take_state(self, now: Gathered, stamp: int, message: Any) -> None:
        now.state.append((stamp, np.array(message.data, np.float64)))

    def _stamp(self, channel: Channel, recorded: int, message: Any) -> int:
        """Return when something was measured: by its own stamp, unless that is of another clock than the recording's."""
        header = getattr(message, "header", None)
        if header is None:
            return recorded
        own = stamp_of(header.stamp)
        if channel.topic not in self._foreign:
            self._foreign[channel.topic] = abs(own - recorded) > FOREIGN_CLOCK
            if self._foreign[channel.topic]:
                self._note(f"{channel.topic}: stamps are of another clock; the time of recording counts")
        return recorded if self._foreign[channel.topic] else own

    def _note(self, line: str) -> None:
        self.notes[line] = self.notes.get(line, 0) + 1


def _recorded(message: tuple[Channel, int, bytes]) -> int:
    return message[1]


def _number(name: str, place: int) -> int:
    digits = "".join(character for character in name if character.isdigit())[-9:]
    return int(digits) if digits else place
