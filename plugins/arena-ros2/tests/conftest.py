"""A robot in a thread, over DDS, that can be told what is wrong with it."""

from __future__ import annotations

import json
import threading
import time
from collections.abc import Callable

import numpy as np
import pytest

from arena_core import LaserScan, Pose, Twist
from arena_ros import conversions as to
from arena_ros.codec import codec
from arena_ros2.dds import Dds

PERIOD = 0.05  # s
ROOM_XY = np.array([10.0, 6.0])
ANGLES = np.linspace(-np.pi, np.pi, 180, endpoint=False)


class Puppet:
    """Drives as it is told in an empty room. ``fault`` is what is wrong: empty, or a name that ``_send`` knows."""

    def __init__(self) -> None:
        self.node, self._codec = Dds("puppet"), codec(2)
        kinds = {"/scan": to.SCAN, "/odom": to.ODOMETRY, "/tf": to.TF}
        self._out = {topic: self.node.publisher(topic, kind) for topic, kind in kinds.items()}
        self._kinds = kinds
        self.node.subscribe("/cmd_vel", to.TWIST, self._hear)
        self.node.subscribe("/arena/status", to.TEXT, self._hear_status)
        self.pose, self.command, self.fault, self.status = Pose(1.5, 3.0), Twist(0.0), "", ""
        self.faced: list[str] = []
        self._over = threading.Event()
        self._threads = [threading.Thread(target=self._run, daemon=True)]

    def _hear(self, content: bytes) -> None:
        self.command = to.twist_of(self._codec.decode(content, to.TWIST))

    def _hear_status(self, content: bytes) -> None:
        self.status = json.loads(self._codec.decode(content, to.TEXT).data)["status"]

    def face(self, faults: list[tuple[str, str]], act: Callable[[str], None] = lambda fault: None) -> None:
        """Have one fault after the other while driving, each until the driver names it."""
        self._threads.append(threading.Thread(target=self._face, args=(faults, act), daemon=True))

    def _face(self, faults: list[tuple[str, str]], act: Callable[[str], None]) -> None:
        for fault, said in faults:
            while not self._over.is_set() and not (self.status == "drives" and self.command.vx > 0.05):
                time.sleep(0.02)
            self.fault = fault
            act(fault)
            while not self._over.is_set() and not (said in self.status and self.command == Twist(0.0)):
                time.sleep(0.02)
            if not self._over.is_set():
                self.faced.append(fault)
            self.fault = ""
            act("")

    def __enter__(self) -> Puppet:
        for thread in self._threads:
            thread.start()
        return self

    def __exit__(self, *raised: object) -> None:
        self._over.set()
        for thread in self._threads:
            thread.join(5.0)
        self.node.close()

    def _run(self) -> None:
        while not self._over.wait(PERIOD):
            turned = self.pose.theta + self.command.wz * PERIOD
            step = self.command.vx * PERIOD
            self.pose = Pose(self.pose.x + step * np.cos(turned), self.pose.y + step * np.sin(turned), turned)
            self._send()

    def _send(self) -> None:
        own, stamp = self._codec, time.time_ns()
        if self.fault == "the clock jumps":
            stamp -= 3600 * 10**9
        scan = LaserScan(0.0, float(ANGLES[0]), float(ANGLES[1] - ANGLES[0]), 0.1, 30.0, self._ranges(), Pose(0.0, 0.0))
        if self.fault == "scans of NaN":
            scan = LaserScan(0.0, 0.0, 0.1, 0.1, 30.0, np.full(60, np.nan, np.float32), Pose(0.0, 0.0))
        pose = Pose(np.nan, 0.0) if self.fault == "odometry of NaN" else self.pose
        correction = Pose(np.nan, 0.0) if self.fault == "tf of NaN" else Pose(0.0, 0.0)
        frame = "world" if self.fault == "tf of another frame" else "map"
        messages = {
            "/scan": to.scan(own, scan, 10**9 if self.fault == "a scan that stays the same" else stamp, "laser", PERIOD),
            "/odom": to.odometry(own, pose, self.command, stamp, "odom", "base_link"),
            "/tf": to.transforms(own, [(frame, "odom", correction)], stamp),
        }
        for topic, message in messages.items():
            content = own.encode(message, self._kinds[topic])
            if self.fault == f"nothing on {topic}":
                continue
            self._out[topic](content[:20] if self.fault == f"rubbish on {topic}" else content)

    def _ranges(self) -> np.ndarray:
        heading = self.pose.theta + ANGLES
        ways = np.stack((np.cos(heading), np.sin(heading)))
        with np.errstate(divide="ignore"):
            walls = np.where(ways > 0, (ROOM_XY - self.pose.array()[:2])[:, None] / ways, -self.pose.array()[:2][:, None] / ways)
        return walls.min(axis=0).astype(np.float32)


@pytest.fixture
def puppet() -> Puppet:
    """A robot that drives as soon as its block is entered."""
    return Puppet()
