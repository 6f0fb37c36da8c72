"""Messages of each role into what is gathered of an episode; what is no number is left out and counted."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any

import numpy as np

from arena_core import Footprint, OccupancyGrid, Pose
from arena_ros import conversions as of
from arena_ros.bags.clocks import LATEST, Clocks
from arena_ros.bags.episode_messages import (
    FARTHEST,
    EpisodeMessages,
    are_numbers,
    is_settled,
    person_number,
    position_and_rotation,
)
from arena_ros.bags.event_counter import EventCounter
from arena_ros.bags.footprint import nearest_return
from arena_ros.bags.people_tracking import PeopleTracker
from arena_ros.bags.series import PersonSightings, Series
from arena_ros.bags.topic_roles import RoleAssignment
from arena_ros.bags.transform_tree import TransformBuffer
from arena_ros.codec import stamp_of
from arena_ros.frames import BASES, Mount, find_mount


@dataclass(frozen=True, slots=True, eq=False)
class ScanReading:
    """How scans are read: on which robot, from which ``mount``, and by whom people are seen in them.

    ``same`` are frames that are taken for one, the first of them.
    """

    footprint: Footprint
    mount: Pose
    watcher: PeopleTracker | None = None
    same: Sequence[str] = ()
    keep_scans: bool = False


class MessageHandler:
    """Takes in messages, and what they say for all episodes: links, mounts, frames and the map; ``note`` is called with
    what was left out.
    """

    def __init__(self, cast: RoleAssignment, clocks: Clocks, reading: ScanReading, note: Callable[[str], None]) -> None:
        self._clocks, self._footprint, self._mount = clocks, reading.footprint, reading.mount
        self._keep_scans, self._watcher, self._note = reading.keep_scans, reading.watcher, note
        same = reading.same
        self._tf = cast.by_role["tf"].topic if "tf" in cast.by_role else ""
        self._counts_collisions = "collisions" in cast.by_role
        self._same = dict.fromkeys(same, same[0]) if same else {}
        self.grid: OccupancyGrid | None = None
        self.grid_frame = ""
        self.heard = TransformBuffer()
        self._mounts: dict[str, tuple[str, Mount]] = {}
        self._contacts = EventCounter()
        self._odom, self._base = "odom", "base_link"
        for frame in BASES:
            self.heard.track_frame(frame)

    def begin(self, gathered: EpisodeMessages) -> None:
        """Begin an episode."""
        gathered.frame, gathered.base = self._odom, self._base
        gathered.counts_collisions = self._counts_collisions
        self.heard.begin()
        if gathered.goal is not None:
            self.heard.track_frame(gathered.goal[0])
        if self._watcher is not None:
            self._watcher.begin(self.grid)

    def end(self, gathered: EpisodeMessages) -> None:
        """End an episode: the links that were heard in it are its."""
        self.detect_people(gathered)
        gathered.links = self.heard.links()
        if not len(gathered.odometry):
            known = gathered.links.frames()
            gathered.base = next((base for base in sorted(BASES) if base in known), gathered.base)

    def take(self, role: str, now: EpisodeMessages, stamp: int, message: Any) -> None:
        """Take a message of a role into an episode; a role that only parts recordings has nothing to take."""
        if take := getattr(self, f"_take_{role}", None):
            take(now, stamp, message)

    def frame(self, message: Any) -> str:
        """Return the frame of a message."""
        return self._frame_name(message.header.frame_id)

    def _frame_name(self, frame: str) -> str:
        """Return a frame's name without the slash of old ones, or that of the frame that it is taken for."""
        name = frame.lstrip("/")
        return self._same.get(name, name)

    def take_map(self, message: Any) -> None:
        """Take in the map, the last one of which counts."""
        try:
            grid = of.grid_from_msg(message)
        except ValueError:
            self._note("a map has another number of cells than it says; left out")
            return
        if not are_numbers([*grid.origin.array(), grid.resolution]) or not grid.resolution > 0.0 or not grid.data.size:
            self._note("a map whose place is no number, or which has no cells; left out")
            return
        self.grid, self.grid_frame = grid, self.frame(message)

    def _valid_transforms(self, message: Any) -> list[Any]:
        """Return the transforms of a message that are numbers."""
        good = [each for each in message.transforms if are_numbers(position_and_rotation(each))]
        if len(good) < len(message.transforms):
            self._note("a transform that is no number; left out")
        return good

    def take_tf_static(self, message: Any) -> None:
        """Take in links that do not move."""
        good = self._valid_transforms(message)
        self._mounts |= of.mounts_from_msg(SimpleNamespace(transforms=good))
        for each in good:
            self.heard.take_static(self.frame(each), self._frame_name(each.child_frame_id), position_and_rotation(each))

    def take_tf(self, recorded: int, message: Any) -> None:
        """Take in links that move, and mounts of old robots, which tell there where their laser is."""
        good = self._valid_transforms(message)
        if not {self._frame_name(each.child_frame_id) for each in good} <= self._mounts.keys():
            self._mounts = of.mounts_from_msg(SimpleNamespace(transforms=good)) | self._mounts
        first = stamp_of(message.transforms[0].header.stamp) if message.transforms else 0
        child = message.transforms[0].child_frame_id.lstrip("/") if message.transforms else ""
        made, now = self._clocks.stamp((self._tf, child), recorded, first), self._clocks.now(recorded)
        for each in good:
            own = stamp_of(each.header.stamp) + made - first
            stamp = own if abs(own - now) <= LATEST else now
            self.heard.take(self.frame(each), self._frame_name(each.child_frame_id), stamp, position_and_rotation(each))

    def _take_odometry(self, now: EpisodeMessages, stamp: int, message: Any) -> None:
        measured = of.odometry_from_msg(message, 0.0)
        if not are_numbers(measured.pose.array(), measured.twist.array()):
            self._note("odometry that is no number; left out")
            return
        self._odom, self._base = self.frame(message) or "odom", self._frame_name(message.child_frame_id) or "base_link"
        now.frame, now.base = self._odom, self._base
        self.heard.track_frame(self._odom)
        self.heard.track_frame(self._base)
        now.odometry.extend(stamp, np.concatenate((measured.pose.array(), measured.twist.array())))

    def _take_reference(self, now: EpisodeMessages, stamp: int, message: Any) -> None:
        inner = message.pose.pose if hasattr(message, "twist") else message.pose
        twist = of.twist_from_msg(message.twist.twist).array() if hasattr(message, "twist") else np.full(3, np.nan)
        if not are_numbers(of.pose_from_msg(inner).array()):
            self._note("a reference pose that is no number; left out")
            return
        frame = self._tracked_frame(message)
        twist = twist if are_numbers((), twist) else np.full(3, np.nan)
        now.reference.setdefault(frame, Series(6)).extend(
            stamp, np.concatenate((of.pose_from_msg(inner).array(), twist))
        )

    def _take_estimate(self, now: EpisodeMessages, stamp: int, message: Any) -> None:
        pose = of.pose_from_msg(message.pose.pose)
        if not are_numbers(pose.array()):
            self._note("an estimate that is no number; left out")
            return
        covariance = of.planar_covariance(message.pose.covariance).ravel()
        now.estimate.setdefault(self._tracked_frame(message), Series(12)).extend(
            stamp, np.concatenate((pose.array(), covariance))
        )

    def _tracked_frame(self, message: Any) -> str:
        """Return the frame of a message, whose motion matters from here on."""
        frame = self.frame(message)
        self.heard.track_frame(frame)
        return frame

    def _take_command(self, now: EpisodeMessages, stamp: int, message: Any) -> None:
        twist = of.twist_from_msg(message).array()
        if not are_numbers((), twist):
            self._note("a command that is no number; left out")
            return
        now.command.extend(stamp, twist)

    def _take_scan(self, now: EpisodeMessages, stamp: int, message: Any) -> None:
        if not np.isfinite([message.angle_min, message.angle_increment, message.range_min]).all() or np.isnan(
            message.range_max
        ):
            self._note("a scan whose angles or ranges are no numbers; left out")
            return
        scan = of.scan_from_msg(message, 0.0, self._sensor_mount(message.header.frame_id.lstrip("/")))
        now.scan.add(stamp, *nearest_return(self._footprint, scan))
        if self._watcher is not None:
            self._watcher.take(stamp, scan)
            self.detect_people(now)
        if self._keep_scans:
            if now.ranges and len(now.ranges[0][1]) != len(scan.ranges):
                self._note("scans have different numbers of beams: they are not kept")
                self._keep_scans = False
                now.ranges.clear()
            else:
                now.ranges.append((stamp, scan.ranges))

    def detect_people(self, now: EpisodeMessages) -> None:
        """Have the watcher see people in the scans that came."""
        if self._watcher is not None:
            for frame, stamp, seen in self._watcher.detect_people(
                now.begin, lambda stamp: self._robot_pose(now, stamp)
            ):
                now.people.setdefault(frame, PersonSightings()).add(stamp, seen)

    def _robot_pose(self, now: EpisodeMessages, stamp: int) -> tuple[str, Pose] | None:
        """Return where the robot stood, in the frame above all others of odometry; None where that has not come yet."""
        for frame, series in (*now.reference.items(), (now.frame, now.odometry), *now.estimate.items()):
            if len(series):
                pose = series.at(stamp)
                if pose is None or series is not now.odometry:
                    return None if pose is None else (frame, Pose.of(pose))
                root, above = self.heard.newest(frame)
                return root, Pose.of(above.transform_poses(pose[None])[0])
        return None

    def _sensor_mount(self, frame: str) -> Mount:
        """Return where a frame is in that of the base, by the static transforms; else where the robot's lidar is."""
        mount = find_mount(self._mounts, frame, {self._base, *BASES})
        return Mount(self._mount) if mount is None else mount

    def _take_people(self, now: EpisodeMessages, stamp: int, message: Any) -> None:
        if hasattr(message, "people"):
            seen = [
                (
                    person_number(each.name, k),
                    each.position.x,
                    each.position.y,
                    each.position.z,
                    each.velocity.x,
                    each.velocity.y,
                )
                for k, each in enumerate(message.people)
            ]
        else:
            seen = [
                (k, each.position.x, each.position.y, each.position.z, np.nan, np.nan)
                for k, each in enumerate(message.poses)
            ]
        good = [each for each in seen if are_numbers(each[1:4])]
        if len(good) < len(seen):
            self._note("people whose place is no number; left out")
        now.people.setdefault(self._tracked_frame(message), PersonSightings()).add(stamp, good)

    def _take_path(self, now: EpisodeMessages, stamp: int, message: Any) -> None:
        poses = of.path_from_msg(message)
        good = poses[(np.abs(poses) < FARTHEST).all(axis=1)]
        if len(good) < len(poses):
            self._note("poses of a path that are no numbers; left out")
        now.paths.append((stamp, self._tracked_frame(message), good))

    def _take_waypoint(self, now: EpisodeMessages, stamp: int, message: Any) -> None:
        now.waypoint.extend(stamp, of.pose_from_msg(message.pose).array())

    def _take_state(self, now: EpisodeMessages, stamp: int, message: Any) -> None:
        now.state.append((stamp, np.array(message.data, np.float64)))

    def _take_collisions(self, now: EpisodeMessages, stamp: int, message: Any) -> None:
        touches = float(message.data) if isinstance(getattr(message, "data", None), bool) else np.nan
        now.collisions.add(stamp, self._contacts.take(message, settled=is_settled(now, stamp)), touches)
