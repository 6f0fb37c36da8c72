"""Who stands by while a robot is driven: one who listens, and a robot in a thread that can be
told what is wrong with it.
"""

from __future__ import annotations

import json
import threading
import time
from collections.abc import Callable, Sequence
from functools import partial

import numpy as np
from numpy.typing import NDArray

from arena_core import LaserScan, Pose, Twist
from arena_ros import conversions as to
from arena_ros.codec import get_codec
from arena_ros.testing.site import SIZE_XY, START
from arena_ros.transport import Transport

PERIOD = 0.05  # s
ANGLES = np.linspace(-np.pi, np.pi, 180, endpoint=False)
NAN_SCAN = LaserScan(0.0, 0.0, 0.1, 0.1, 30.0, np.full(60, np.nan, np.float32), Pose(0.0, 0.0))
HOUR = 3600 * 10**9  # ns


class RobotProbe:
    """What a bystander hears of a simulated robot; times are those of the monotonic clock."""

    def __init__(self, node: Transport) -> None:
        self.node = node
        self.forget()
        node.subscribe("/ground_truth", to.ODOMETRY, self._on_message)
        node.subscribe("/cmd_vel", to.TWIST, self._on_command)

    def forget(self) -> None:
        """Begin again: another robot comes."""
        self.speeds: list[tuple[float, float]] = []
        self.xs: list[float] = []
        self.commands: list[tuple[float, float]] = []

    def _on_message(self, content: bytes) -> None:
        message = get_codec(self.node.ros).decode(content, to.ODOMETRY)
        self.speeds.append((time.monotonic(), abs(message.twist.twist.linear.x)))
        self.xs.append(message.pose.pose.position.x)

    def _on_command(self, content: bytes) -> None:
        self.commands.append((time.monotonic(), get_codec(self.node.ros).decode(content, to.TWIST).linear.x))

    def speed(self) -> float:
        """Return how fast the robot drives, m/s."""
        return self.speeds[-1][1] if self.speeds else 0.0


class FakeRobot:
    """Drives as it is told in an empty room, while its block lasts.

    ``fault`` is what is wrong: empty, or a name that ``_send_sensors`` knows.
    """

    def __init__(self, node: Transport) -> None:
        self.node, self._codec = node, get_codec(node.ros)
        self._kinds = {"/scan": to.SCAN, "/odom": to.ODOMETRY, "/tf": to.TF}
        self._out = {topic: node.publisher(topic, kind) for topic, kind in self._kinds.items()}
        node.subscribe("/cmd_vel", to.TWIST, self._on_message)
        node.subscribe("/arena/status", to.TEXT, self._on_status)
        self._over, self._threads = threading.Event(), list[threading.Thread]()
        self._begin_run()

    def _begin_run(self) -> None:
        self.pose, self.command, self.fault, self.status = Pose(*START), Twist(0.0), "", ""
        self.commands: list[float] = []
        self.faced: list[str] = []
        self._plan: tuple[Sequence[tuple[str, str]], Callable[[str], None]] = ((), lambda fault: None)

    def _on_message(self, content: bytes) -> None:
        self.command = to.twist_from_msg(self._codec.decode(content, to.TWIST))
        self.commands.append(self.command.vx)

    def _on_status(self, content: bytes) -> None:
        self.status = json.loads(self._codec.decode(content, to.TEXT).data)["status"]

    def inject_faults(
        self, faults: Sequence[tuple[str, str]], act: Callable[[str], None] = lambda fault: None
    ) -> FakeRobot:
        """Have one fault after the other while driving, each until the driver names it; ``act`` hears of
        each, and of its end as empty.
        """
        self._plan = faults, act
        return self

    def __enter__(self) -> FakeRobot:
        self._over.clear()
        self._threads = [threading.Thread(target=each, daemon=True) for each in (self._run_loop, self._inject_faults)]
        for thread in self._threads:
            thread.start()
        return self

    def __exit__(self, *raised: object) -> None:
        self._over.set()
        for thread in self._threads:
            thread.join(5.0)
        self._begin_run()

    def _inject_faults(self) -> None:
        faults, act = self._plan
        for fault, named in faults:
            self._wait_until(lambda: self.status == "drives" and self.command.vx > 0.05)
            self.fault = fault
            act(fault)
            if self._wait_until(partial(self._stands_and_says, named)):
                self.faced.append(fault)
            self.fault = ""
            act("")

    def _stands_and_says(self, word: str) -> bool:
        return word in self.status and self.command == Twist(0.0)

    def _wait_until(self, condition: Callable[[], bool]) -> bool:
        """Wait until something is so, or the block is over; return which."""
        while not condition():
            if self._over.wait(0.02):
                return False
        return True

    def _run_loop(self) -> None:
        while not self._over.wait(PERIOD):
            turned = self.pose.theta + self.command.wz * PERIOD
            step = self.command.vx * PERIOD
            self.pose = Pose(self.pose.x + step * np.cos(turned), self.pose.y + step * np.sin(turned), turned)
            self._send_sensors()

    def _send_sensors(self) -> None:
        own, stamp = self._codec, time.time_ns() - (HOUR if self.fault == "the clock jumps" else 0)
        scan = LaserScan(
            0.0, float(ANGLES[0]), float(ANGLES[1] - ANGLES[0]), 0.1, 30.0, self._scan_ranges(), Pose(0.0, 0.0)
        )
        seen = 10**9 if self.fault == "a scan that stays the same" else stamp
        pose = Pose(np.nan, 0.0) if self.fault == "odometry of NaN" else self.pose
        correction = Pose(np.nan, 0.0) if self.fault == "tf of NaN" else Pose(0.0, 0.0)
        frame = "world" if self.fault == "tf of another frame" else "map"
        messages = {
            "/scan": to.scan_msg(own, NAN_SCAN if self.fault == "scans of NaN" else scan, seen, "laser", PERIOD),
            "/odom": to.odometry_msg(own, pose, self.command, to.Header(stamp, "odom"), "base_link"),
            "/tf": to.transforms_msg(own, [(frame, "odom", correction)], stamp),
        }
        for topic, message in messages.items():
            content = own.encode(message, self._kinds[topic])
            if self.fault != f"nothing on {topic}":
                self._out[topic](content[:20] if self.fault == f"rubbish on {topic}" else content)

    def _scan_ranges(self) -> NDArray[np.float32]:
        heading = self.pose.theta + ANGLES
        ways, place = np.stack((np.cos(heading), np.sin(heading))), self.pose.array()[:2, None]
        with np.errstate(divide="ignore"):
            walls = np.where(ways > 0, (np.array(SIZE_XY)[:, None] - place) / ways, -place / ways)
        return np.asarray(walls.min(axis=0), np.float32)
