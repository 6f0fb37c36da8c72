"""Messages of a recording, one after the other, into episodes: one at a time is in memory."""

from __future__ import annotations

import heapq
import json
from collections.abc import Iterator, Sequence
from types import SimpleNamespace
from typing import Any

import numpy as np

from arena_core import Footprint, OccupancyGrid, Pose
from arena_ros import conversions as of
from arena_ros.bags.clocks import JUMP, LATEST, STAMPED, Clocks, source_of
from arena_ros.bags.counting import Counter
from arena_ros.bags.footprint import nearest
from arena_ros.bags.gathered import FARTHEST, Gathered, are_numbers, person_number, place_and_turn
from arena_ros.bags.links import Heard
from arena_ros.bags.roles import Cast
from arena_ros.bags.series import People, Series
from arena_ros.bags.stream import Bag, Channel, Message
from arena_ros.bags.watching import Watcher
from arena_ros.codec import BadMessage, codec, stamp_of
from arena_ros.frames import BASES, Mount, mounted

GOAL_MOVED = 0.05  # m between two goals that are not the same one sent again
LONGEST = 4 * 3600 * 10**9  # ns of one episode; what is longer is cut, so that no recording takes all memory
SETTLED = 10**9  # ns after the begin of an episode from which on a counter's first message is an event


class Gatherer:
    """Takes messages in the order in which they were recorded, and yields episodes. ``watcher`` sees people in the scans.

    ``same`` are frames that are taken for one, the first of them.
    """

    def __init__(
        self,
        cast: Cast,
        clocks: Clocks,
        footprint: Footprint,
        mount: Pose,
        keep_scans: bool,
        watcher: Watcher | None = None,
        same: Sequence[str] = (),
    ) -> None:
        self._clocks, self._footprint, self._mount, self._keep_scans = clocks, footprint, mount, keep_scans
        self._roles: dict[str, list[str]] = {}
        for role, channel in cast.by_role.items():
            self._roles.setdefault(channel.topic, []).append(role)
        self._cast = frozenset(cast.by_role)
        self.by_markers = "episode" in cast.by_role
        self.topics = frozenset(self._roles)
        self._watcher = watcher
        self._same = dict.fromkeys(same, same[0]) if same else {}
        self.grid: OccupancyGrid | None = None
        self.grid_frame = ""
        self.notes: dict[str, int] = {}
        self._heard = Heard()
        self._mounts: dict[str, tuple[str, Mount]] = {}
        self._resets, self._contacts = Counter(), Counter()
        self._newest: int | None = None
        self._open: Gathered | None = None
        self._has_goals = self._is_reset = False
        self._odom, self._base = "odom", "base_link"
        for frame in BASES:
            self._heard.want(frame)

    def episodes(self, bags: Sequence[Bag]) -> Iterator[Gathered]:
        """Yield the episodes of recordings that are read side by side."""
        streams = [bag.messages(self.topics, in_time) for bag, in_time in zip(bags, self._clocks.in_time, strict=True)]
        for channel, recorded, content in heapq.merge(*streams, key=_recorded) if len(streams) > 1 else streams[0]:
            try:
                message = codec(channel.ros).decode(content, channel.type)
            except BadMessage as bad:
                self.note(f"{channel.topic}: {bad}; left out")
                continue
            for role in self._roles[channel.topic]:
                yield from self._take(role, channel, recorded, self._stamp(role, channel, recorded, content), message)
        yield from self._close("the recording ended")

    def _stamp(self, role: str, channel: Channel, recorded: int, content: bytes) -> int:
        """Return when a message was made; goals and the like count from when they were heard."""
        if role not in STAMPED:
            return self._clocks.now(recorded)
        source, own = source_of(channel, content)
        return self._clocks.stamp(source, recorded, own)

    def _take(self, role: str, channel: Channel, recorded: int, stamp: int, message: Any) -> Iterator[Gathered]:
        yield from self._check_clock(channel.topic, stamp)
        if role == "episode":
            yield from self._mark(stamp, message)
        elif role == "reset":
            settled = self._is_settled(stamp)
            if self._resets.changed(message, settled) and settled:  # one that comes with a goal is of the same beginning
                yield from self._close("a reset came")
                self._is_reset = True
        elif role == "goal" and not self.by_markers:
            yield from self._set_goal(stamp, self._frame(message), of.pose_of(message.pose))
        elif role in ("map", "tf_static"):
            getattr(self, f"_take_{role}")(message)
        elif role == "tf":
            if self._open is None and "odometry" not in self._cast and not self.by_markers:
                self._begin(Gathered(stamp))
            self._take_tf(recorded, message)
        elif role != "clock" and not (self._open is None and self.by_markers):
            if self._open is None:
                self._begin(Gathered(stamp))
            if (take := getattr(self, f"_take_{role}", None)) and self._open is not None:
                take(self._open, stamp, message)

    def _check_clock(self, topic: str, stamp: int) -> Iterator[Gathered]:
        """End the episode where the clock by which all goes began anew, or where it took too long."""
        if self._newest is not None and self._clocks.leads(topic) and stamp < self._newest - JUMP:
            self.note("the clock went back: a new episode begins there")
            yield from self._close("the clock went back")
            self._heard.begin(stamp)
        if self._clocks.leads(topic):
            self._newest = stamp
        if self._open is not None and stamp - self._open.begin > LONGEST:
            self.note("an episode of more than 4 h is cut")
            goal = self._open.goal
            yield from self._close("it took more than 4 h")
            if goal is not None:
                self._begin(Gathered(stamp, goal))

    def _is_settled(self, stamp: int) -> bool:
        return self._open is not None and stamp - self._open.begin > SETTLED

    def _mark(self, stamp: int, message: Any) -> Iterator[Gathered]:
        try:
            content = json.loads(message.data)
            kind = content["event"]
        except (ValueError, KeyError, TypeError):
            self.note("a mark of an episode is no JSON with an event; left out")
            return
        if kind == "begin":
            yield from self._close("the next episode began")
            self._begin(Gathered(stamp, meta=content))
        elif kind == "end" and self._open is not None:
            self._open.ending = content
            yield from self._close("")

    def _set_goal(self, stamp: int, frame: str, goal: Pose) -> Iterator[Gathered]:
        if not are_numbers(goal.array()):
            self.note("a goal that is no number; left out")
            return
        before = self._open.goal if self._open is not None else None
        if before is not None and before[0] == frame and before[1].distance(goal) < GOAL_MOVED:
            return
        if before is not None:
            yield from self._close("another goal came")
        self._has_goals, self._is_reset = True, False
        self._begin(Gathered(stamp, (frame, goal)))  # what was recorded before a goal belongs to no episode

    def _begin(self, gathered: Gathered) -> None:
        gathered.frame, gathered.base = self._odom, self._base
        gathered.counts_collisions = "collisions" in self._cast
        self._open = gathered
        self._heard.begin()
        if gathered.goal is not None:
            self._heard.want(gathered.goal[0])
        if self._watcher is not None:
            self._watcher.begin(self.grid)

    def _close(self, why: str) -> Iterator[Gathered]:
        finished, self._open, self._newest = self._open, None, None
        if finished is not None and finished.goal is None and self._has_goals and self._is_reset:
            self.note("what came after a reset and before a goal belongs to no episode")
        elif finished is not None:
            self._look(finished)
            finished.why_ended, finished.links = why, self._heard.links()
            if not len(finished.odometry):
                known = finished.links.frames()
                finished.base = next((base for base in sorted(BASES) if base in known), finished.base)
            yield finished

    def _frame(self, message: Any) -> str:
        return self._named(message.header.frame_id)

    def _named(self, frame: str) -> str:
        """Return a frame's name without the slash of old ones, or that of the frame that it is taken for."""
        name = frame.lstrip("/")
        return self._same.get(name, name)

    def _take_map(self, message: Any) -> None:
        try:
            grid = of.grid_of(message)
        except ValueError:
            self.note("a map has another number of cells than it says; left out")
            return
        if not are_numbers([*grid.origin.array(), grid.resolution]) or not grid.resolution > 0.0 or not grid.data.size:
            self.note("a map whose place is no number, or which has no cells; left out")
            return
        self.grid, self.grid_frame = grid, self._frame(message)

    def _transforms(self, message: Any) -> list[Any]:
        """Return the transforms of a message that are numbers."""
        good = [each for each in message.transforms if are_numbers(place_and_turn(each))]
        if len(good) < len(message.transforms):
            self.note("a transform that is no number; left out")
        return good

    def _take_tf_static(self, message: Any) -> None:
        good = self._transforms(message)
        self._mounts |= of.mounts_of(SimpleNamespace(transforms=good))
        for each in good:
            self._heard.take_static(self._frame(each), self._named(each.child_frame_id), place_and_turn(each))

    def _take_tf(self, recorded: int, message: Any) -> None:
        good = self._transforms(message)
        if not {self._named(each.child_frame_id) for each in good} <= self._mounts.keys():  # old robots tell there where their laser is
            self._mounts = of.mounts_of(SimpleNamespace(transforms=good)) | self._mounts
        topic = next(topic for topic, roles in self._roles.items() if "tf" in roles)
        first = stamp_of(message.transforms[0].header.stamp) if message.transforms else 0
        child = message.transforms[0].child_frame_id.lstrip("/") if message.transforms else ""
        made, now = self._clocks.stamp((topic, child), recorded, first), self._clocks.now(recorded)
        for each in good:
            own = stamp_of(each.header.stamp) + made - first
            stamp = own if abs(own - now) <= LATEST else now
            self._heard.take(self._frame(each), self._named(each.child_frame_id), stamp, place_and_turn(each))

    def _take_odometry(self, now: Gathered, stamp: int, message: Any) -> None:
        measured = of.odometry_of(message, 0.0)
        if not are_numbers(measured.pose.array(), measured.twist.array()):
            self.note("odometry that is no number; left out")
            return
        self._odom, self._base = self._frame(message) or "odom", self._named(message.child_frame_id) or "base_link"
        now.frame, now.base = self._odom, self._base
        self._heard.want(self._odom)
        self._heard.want(self._base)
        now.odometry.extend(stamp, np.concatenate((measured.pose.array(), measured.twist.array())))

    def _take_reference(self, now: Gathered, stamp: int, message: Any) -> None:
        inner = message.pose.pose if hasattr(message, "twist") else message.pose
        twist = of.twist_of(message.twist.twist).array() if hasattr(message, "twist") else np.full(3, np.nan)
        if not are_numbers(of.pose_of(inner).array()):
            self.note("a reference pose that is no number; left out")
            return
        frame = self._want(message)
        twist = twist if are_numbers((), twist) else np.full(3, np.nan)
        now.reference.setdefault(frame, Series(6)).extend(stamp, np.concatenate((of.pose_of(inner).array(), twist)))

    def _take_estimate(self, now: Gathered, stamp: int, message: Any) -> None:
        pose = of.pose_of(message.pose.pose)
        if not are_numbers(pose.array()):
            self.note("an estimate that is no number; left out")
            return
        covariance = of.covariance_of(message.pose.covariance).ravel()
        now.estimate.setdefault(self._want(message), Series(12)).extend(stamp, np.concatenate((pose.array(), covariance)))

    def _want(self, message: Any) -> str:
        """Return the frame of a message, whose motion matters from here on."""
        frame = self._frame(message)
        self._heard.want(frame)
        return frame

    def _take_command(self, now: Gathered, stamp: int, message: Any) -> None:
        twist = of.twist_of(message).array()
        if not are_numbers((), twist):
            self.note("a command that is no number; left out")
            return
        now.command.extend(stamp, twist)

    def _take_scan(self, now: Gathered, stamp: int, message: Any) -> None:
        if not np.isfinite([message.angle_min, message.angle_increment, message.range_min]).all() or np.isnan(message.range_max):
            self.note("a scan whose angles or ranges are no numbers; left out")
            return
        scan = of.scan_of(message, 0.0, self._mounted(message.header.frame_id.lstrip("/")))
        now.scan.add(stamp, *nearest(self._footprint, scan))
        if self._watcher is not None:
            self._watcher.take(stamp, scan)
            self._look(now)
        if self._keep_scans:
            if now.ranges and len(now.ranges[0][1]) != len(scan.ranges):
                self.note("scans have different numbers of beams: they are not kept")
                self._keep_scans = False
                now.ranges.clear()
            else:
                now.ranges.append((stamp, scan.ranges))

    def _look(self, now: Gathered) -> None:
        if self._watcher is not None:
            for frame, stamp, seen in self._watcher.look(now.begin, lambda stamp: self._stood(now, stamp)):
                now.people.setdefault(frame, People()).add(stamp, seen)

    def _stood(self, now: Gathered, stamp: int) -> tuple[str, Pose] | None:
        """Return where the robot stood, in the frame above all others of odometry; None where that has not come yet."""
        for frame, series in (*now.reference.items(), (now.frame, now.odometry), *now.estimate.items()):
            if len(series):
                pose = series.at(stamp)
                if pose is None or series is not now.odometry:
                    return None if pose is None else (frame, Pose.of(pose))
                root, above = self._heard.newest(frame)
                return root, Pose.of(above.moved(pose[None])[0])
        return None

    def _mounted(self, frame: str) -> Mount:
        """Return where a frame is in that of the base, by the static transforms; else where the robot's lidar is."""
        mount = mounted(self._mounts, frame, {self._base, *BASES})
        return Mount(self._mount) if mount is None else mount

    def _take_people(self, now: Gathered, stamp: int, message: Any) -> None:
        if hasattr(message, "people"):
            seen = [
                (person_number(each.name, k), each.position.x, each.position.y, each.position.z, each.velocity.x, each.velocity.y)
                for k, each in enumerate(message.people)
            ]
        else:
            seen = [(k, each.position.x, each.position.y, each.position.z, np.nan, np.nan) for k, each in enumerate(message.poses)]
        good = [each for each in seen if are_numbers(each[1:4])]
        if len(good) < len(seen):
            self.note("people whose place is no number; left out")
        now.people.setdefault(self._want(message), People()).add(stamp, good)

    def _take_path(self, now: Gathered, stamp: int, message: Any) -> None:
        poses = of.path_of(message)
        good = poses[(np.abs(poses) < FARTHEST).all(axis=1)]
        if len(good) < len(poses):
            self.note("poses of a path that are no numbers; left out")
        now.paths.append((stamp, self._want(message), good))

    def _take_waypoint(self, now: Gathered, stamp: int, message: Any) -> None:
        now.waypoint.extend(stamp, of.pose_of(message.pose).array())

    def _take_state(self, now: Gathered, stamp: int, message: Any) -> None:
        now.state.append((stamp, np.array(message.data, np.float64)))

    def _take_collisions(self, now: Gathered, stamp: int, message: Any) -> None:
        touches = float(message.data) if isinstance(getattr(message, "data", None), bool) else np.nan
        now.collisions.add(stamp, self._contacts.take(message, self._is_settled(stamp)), touches)

    def note(self, line: str) -> None:
        """Count what was left out or is worth saying."""
        self.notes[line] = self.notes.get(line, 0) + 1


def _recorded(message: Message) -> int:
    return message[1]
