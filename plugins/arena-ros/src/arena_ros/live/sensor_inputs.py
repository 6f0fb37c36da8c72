"""What a robot on the air measures, as the navigator takes it, or why it cannot be driven now."""

from __future__ import annotations

import time
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

import numpy as np

from arena_core import ArenaError, Odometry, Pose, Robot, Sensors
from arena_core.commands import print_notice
from arena_ros import conversions as of
from arena_ros.codec import BadMessage, get_codec, stamp_of
from arena_ros.frames import BASES, Mount, find_mount
from arena_ros.live.latest_message import LatestMessage
from arena_ros.live.settings import Settings
from arena_ros.live.time_source import TimeSource, WallTime
from arena_ros.transport import Transport

# s by which a scan's stamp may lie before odometry's; beyond, clocks differ and times of arrival count
LARGEST_LAG = 1.0
POLL = 1e-3  # s between two looks for odometry
MOVED = 0.02  # m and rad from the robot's own figures, from which on it is worth a line that the laser is elsewhere


@dataclass(frozen=True, slots=True)
class SensorTopics:
    """Where sensors come from; ``pose`` is empty where the robot localises itself, ``tf`` where
    map -> odom on /tf counts.
    """

    scan: str
    odometry: str
    pose: str


class SensorInputs:
    """Hears a robot's sensors."""

    def __init__(
        self,
        transport: Transport,
        topics: SensorTopics,
        robot: Robot,
        settings: Settings,
        clock: TimeSource | None = None,
    ) -> None:
        own = get_codec(transport.ros)
        self.clock: TimeSource = clock or WallTime()
        self._robot, self._settings, self._topics, self._transport = robot, settings, topics, transport
        self._scan = LatestMessage(transport, own, topics.scan, of.SCAN)
        self._odometry = LatestMessage(transport, own, topics.odometry, of.ODOMETRY)
        self._pose = LatestMessage(transport, own, topics.pose, _pose_type(topics.pose)) if topics.pose else None
        self._correction: Pose | None = None  # odom in map, by a pose from elsewhere
        self._corrected = float("-inf")
        self._good_scan = self._good_odometry = float("-inf")  # when the newest of use came
        self._tf_needed = topics.pose == "/tf"
        self._stamps = {"scan": 0, "odometry": 0}
        self._static: dict[str, tuple[str, Mount]] = {}
        self._mounts: dict[str, Mount] = {}
        with suppress(ArenaError):  # a transport that does not know the type: then the robot's own figures count
            transport.subscribe("/tf_static", of.TF, self._on_static, latched=True)

    def await_all(self, is_over: object = None) -> None:
        """Wait until scan, odometry and, where it comes from elsewhere, pose have come; raise
        ArenaError where they do not.
        """
        end = time.monotonic() + self._settings.patience
        while (fault := self.fault()) is not None:
            self._read_messages()
            if time.monotonic() > end:
                raise ArenaError(f"{fault} within {self._settings.patience:g} s; {self._topics_hint()}")
            if callable(is_over) and is_over():
                raise KeyboardInterrupt
            time.sleep(0.02)

    def _topics_hint(self) -> str:
        there = self._transport.topics()
        wanted = {self._topics.scan: of.SCAN, self._topics.odometry: of.ODOMETRY}
        for topic, kind in wanted.items():
            if there.get(topic, kind) not in (kind, "*"):
                return f"{topic} is a {there[topic]}; allowed: {kind}"
        return f"published are {', '.join(sorted(there)[:12]) or 'no topics at all'}"

    def fault(self) -> str | None:
        """Return what is missing or too old, None where the robot may be driven."""
        self._read_messages()
        now, own = self.clock.now(), self._settings
        if now - self._good_scan > own.scan_age:
            return f"no scan of use on {self._topics.scan}" + _age_text(self._good_scan, now)
        if now - self._good_odometry > own.odometry_age:
            return f"no odometry of use on {self._topics.odometry}" + _age_text(self._good_odometry, now)
        if self._pose is not None and now - self._corrected > own.pose_age:
            return f"no pose on {self._topics.pose}" + _age_text(self._corrected, now)
        return None

    def _read_messages(self) -> None:
        """Take in what has come: what is no number is of no use, and grows old."""
        scan = self._scan.take()
        if scan is not None and self._is_new("scan", scan) and _is_usable_scan(scan):
            self._good_scan = self.clock.measured(scan, self._scan.receive_time)
            self._newest_scan = scan
        odometry = self._odometry.take()
        if odometry is not None and self._is_new("odometry", odometry):
            measured = of.odometry_from_msg(odometry, 0.0)
            if np.isfinite([*measured.pose.array(), *measured.twist.array()]).all():
                self._good_odometry = self.clock.measured(odometry, self._odometry.receive_time)
                self._newest_odometry, self._measured = odometry, measured
        if self._pose is not None and self._good_odometry > float("-inf"):
            self._take_pose(self._pose.take())

    def _is_new(self, role: str, message: Any) -> bool:
        """Return whether a message was measured again: a driver that sends the same one again and
        again has lost its sensor.
        """
        before, stamp = self._stamps[role], stamp_of(message.header.stamp)
        self._stamps[role] = stamp
        return stamp != before or stamp == 0

    def _take_pose(self, message: object) -> None:
        if message is None or self._pose is None:
            return
        if self._tf_needed:
            odom = self._newest_odometry.header.frame_id.lstrip("/") or "odom"
            found = [pose for parent, child, pose, _ in of.links_from_msg(message) if (parent, child) == ("map", odom)]
            if not found:
                return
            correction = found[-1]
        elif (frame := message.header.frame_id.lstrip("/")) not in ("map", ""):  # type: ignore[attr-defined]
            print_notice(f"{self._topics.pose} is in the frame {frame} and does not count; allowed: map")
            return
        else:
            inner = message.pose  # type: ignore[attr-defined]
            pose = of.pose_from_msg(getattr(inner, "pose", inner))
            correction = pose.compose(self._measured.pose.relative(Pose(0.0, 0.0)))
        if np.isfinite(correction.array()).all():
            self._correction, self._corrected = correction, self.clock.now()

    def _on_static(self, content: bytes) -> None:
        with suppress(BadMessage):
            self._static = self._static | of.mounts_from_msg(get_codec(self._transport.ros).decode(content, of.TF))

    def _lidar_mount(self, frame: str) -> Mount:
        """Return where the lidar of a frame is on the robot: as /tf_static says, else as the
        robot's configuration does.
        """
        if frame not in self._mounts:
            own = Mount(self._robot.lidar.mount)
            found = find_mount(
                self._static, frame, {self._newest_odometry.child_frame_id.lstrip("/") or "base_link", *BASES}
            )
            if found is None:
                return own
            self._mounts[frame] = found
            if found.flipped or np.abs(found.pose.array() - own.pose.array()).max() > MOVED:
                where = "{:.3f}, {:.3f}, {:.3f}".format(*found.pose.array()) + (
                    ", upside down" if found.flipped else ""
                )
                print_notice(f"/tf_static has {frame} at {where}: this counts, not lidar.mount of the robot")
        return self._mounts[frame]

    @property
    def is_external(self) -> bool:
        """Return whether the pose comes from elsewhere."""
        return self._pose is not None

    def wait_for_odometry(self, stamp: int, seconds: float) -> None:
        """Wait until odometry of a stamp, ns, or a later one has come, for so many seconds at most."""
        end = time.monotonic() + seconds
        while self._stamps["odometry"] < stamp and time.monotonic() < end:
            self._read_messages()
            time.sleep(POLL)

    def odom_frame(self) -> tuple[str, Pose | None]:
        """Return the name of odometry's frame, and where it is in ``map`` where a pose from elsewhere says so."""
        return self._newest_odometry.header.frame_id.lstrip("/") or "odom", self._correction

    def pose(self) -> Pose | None:
        """Return the pose from elsewhere, carried on by odometry."""
        return None if self._correction is None else self._correction.compose(self._measured.pose)

    def sensors(self, begin: float) -> Sensors:
        """Return what is measured now, s since ``begin`` of the clock. Only where there is no fault."""
        now = self.clock.now() - begin
        odometry_stamp = self._good_odometry - begin
        lag = (stamp_of(self._newest_odometry.header.stamp) - stamp_of(self._newest_scan.header.stamp)) * 1e-9
        scan_stamp = odometry_stamp - lag if abs(lag) < LARGEST_LAG else self._good_scan - begin
        scan = of.scan_from_msg(
            self._newest_scan, min(scan_stamp, now), self._lidar_mount(self._newest_scan.header.frame_id.lstrip("/"))
        )
        odometry = Odometry(odometry_stamp, self._measured.pose, self._measured.twist)
        return Sensors(now, scan, odometry, self.pose())


def _is_usable_scan(scan: Any) -> bool:
    """Return whether a scan says anything: beams, a step between them, and one return at least that is a number."""
    figures = (scan.angle_min, scan.angle_increment, scan.range_min, scan.range_max)
    return (
        bool(len(scan.ranges))
        and bool(np.isfinite(figures[:3]).all())
        and not np.isnan(figures[3])
        and not np.isnan(scan.ranges).all()
    )


def _pose_type(topic: str) -> str:
    if topic == "/tf":
        return of.TF
    return (
        of.ODOMETRY
        if "odom" in topic or "truth" in topic
        else of.POSE_STAMPED
        if "mocap" in topic or "vicon" in topic
        else of.POSE_COVARIANCE
    )


def _age_text(when: float, now: float) -> str:
    return "" if when == float("-inf") else f" for {now - when:.2f} s"
