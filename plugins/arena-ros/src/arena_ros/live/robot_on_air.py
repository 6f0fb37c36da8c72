"""One simulated robot on the air: its topics in a namespace, its frames with the namespace before their names."""

from __future__ import annotations

import threading
from typing import Any

import numpy as np

from arena_core import Pose, Robot, Scenario, Snapshot
from arena_ros import conversions as to
from arena_ros.codec import BadMessage, get_codec
from arena_ros.live.goals import open_goals
from arena_ros.transport import Transport

Link = tuple[str, str, Pose]  # a frame, its child, and where that is in it


class RobotOnAir:
    """What a robot in a ``namespace`` (empty, or such as ``/robot1``) sends and hears.

    ``command`` (3,), the last one, holds until the next one, as on a robot without a watch of its own; ``heard`` is set
    when one comes. A move_base whose ``action`` is named is sent the goal of each problem.
    """

    def __init__(self, transport: Transport, namespace: str, action: str | None) -> None:
        self._codec = get_codec(transport.ros)
        self._prefix = f"{namespace.strip('/')}/" if namespace else ""
        kinds = {"/odom": to.ODOMETRY, "/tf": to.TF, "/ground_truth": to.ODOMETRY, "/scan": to.SCAN}
        names = {topic: topic if topic == "/tf" else namespace + topic for topic in kinds}
        self._out = {topic: (transport.publisher(names[topic], kind), kind) for topic, kind in kinds.items()}
        goal = transport.publisher(f"{namespace}/arena/scenario_goal", to.POSE_STAMPED, latched=True)
        self._out["/arena/scenario_goal"] = goal, to.POSE_STAMPED
        self.command = np.zeros(3)
        self.heard = threading.Event()
        transport.subscribe(f"{namespace}/cmd_vel", to.TWIST, self._on_command)
        self._asked = open_goals(transport, f"{namespace}/{action.strip('/')}") if action is not None else None
        self._name = ""  # of the problem whose goal a move_base was sent
        self._scan_stamp = -1.0
        self._robot: Robot

    def _on_command(self, content: bytes) -> None:
        try:
            twist = to.twist_from_msg(self._codec.decode(content, to.TWIST))
        except BadMessage:
            return
        if np.isfinite(twist.array()).all():
            self.command = twist.array()
            self.heard.set()

    def begin(self, scenario: Scenario, robot: Robot, clock: int) -> None:
        """Stand at the begin of a problem and tell its goal; ``clock`` in ns."""
        self.command = np.zeros(3)
        self._robot, self._scan_stamp, self._name = robot, -1.0, scenario.name
        goal = to.pose_stamped_msg(self._codec, scenario.goal, clock, "map")
        self._publish_message("/arena/scenario_goal", goal)
        if self._asked is not None:
            self._asked.send(scenario.goal, clock)

    def lidar_link(self, robot: Robot) -> Link:
        """Return where the lidar of this type of robot is."""
        return self._prefix + "base_link", self._prefix + "laser", robot.lidar.mount

    def report_goal(self) -> None:
        """Say, once, what a move_base made of the problem's goal."""
        if self._asked is None or not self._name:
            return
        self._asked.resend_goal()
        if (ended := self._asked.ended) is not None:
            print(f"{self._name}: {self._asked.name} says {ended.said}", flush=True)
            self._name = ""

    def publish(self, snapshot: Snapshot, row: int, clock: int) -> bool:
        """Send what the robot of a row measures and where it truly is; return whether its scan is a new one."""
        own, state, sensors = self._codec, snapshot.state(row), snapshot.sensors(row)
        odom, base, odometry = self._prefix + "odom", self._prefix + "base_link", sensors.odometry
        measured = clock - round((sensors.stamp - odometry.stamp) * 1e9)
        self._publish_message(
            "/odom", to.odometry_msg(own, odometry.pose, odometry.twist, to.Header(measured, odom), base)
        )
        self._publish_message("/tf", to.transforms_msg(own, [(odom, base, odometry.pose)], measured))
        self._publish_message(
            "/ground_truth", to.odometry_msg(own, state.pose, state.twist, to.Header(clock, "map"), base)
        )
        if sensors.scan.stamp == self._scan_stamp:
            return False
        self._scan_stamp = sensors.scan.stamp
        seen = clock - round((sensors.stamp - sensors.scan.stamp) * 1e9)
        scan = to.scan_msg(own, sensors.scan, seen, self._prefix + "laser", self._robot.lidar.period)
        self._publish_message("/scan", scan)
        return True

    def _publish_message(self, topic: str, message: Any) -> None:
        publish, kind = self._out[topic]
        publish(self._codec.encode(message, kind))
