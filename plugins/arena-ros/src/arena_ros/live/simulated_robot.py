"""``arena ros simulate``: a simulated robot among people, on the air as a real one would be."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from typing import Any

import numpy as np

from arena_core import Scenario, Snapshot
from arena_core.hosting import Benchmark
from arena_ros import conversions as to
from arena_ros.codec import PEOPLE, BadMessage, get_codec
from arena_ros.live.goals import open_goals
from arena_ros.transport import Transport

BEGIN = 10**9  # ns of the clock when the first episode begins: 0 is "no time" to ROS


class SimulatedRobot:
    """One robot of a simulator, its people and its map. ``period`` s is that between two messages of odometry.

    The last command holds until the next one, as on a robot without a watch of its own. A move_base whose ``action`` is
    named is sent the goal of each problem.
    """

    def __init__(
        self, transport: Transport, benchmark: Benchmark, period: float, action: str | None = None, namespace: str = ""
    ) -> None:
        self._simulator, self._robot, self._task = benchmark.simulator, benchmark.robot, benchmark.task
        self._seed = benchmark.settings.seed
        self._ticks = max(round(period / self._simulator.inner_step), 1)
        self._period = self._ticks * self._simulator.inner_step
        own = self._codec = get_codec(transport.ros)
        kinds = {"/scan": to.SCAN, "/odom": to.ODOMETRY, "/ground_truth": to.ODOMETRY, "/tf": to.TF, "/clock": to.CLOCK}
        kinds |= {"/people": PEOPLE, "/people_markers": to.MARKERS}
        latched = {"/map": to.GRID, "/tf_static": to.TF, "/arena/scenario_goal": to.POSE_STAMPED}
        self._out = {topic: (transport.publisher(namespace + topic, kind), kind) for topic, kind in kinds.items()}
        self._out |= {
            topic: (transport.publisher(namespace + topic, kind, latched=True), kind) for topic, kind in latched.items()
        }
        self._command = np.zeros((1, 3))
        self._heard = threading.Event()
        self._reset = threading.Event()
        self._own = own
        transport.subscribe(namespace + "/cmd_vel", to.TWIST, self._on_command)
        transport.subscribe(namespace + "/arena/reset", to.EMPTY, lambda content: self._reset.set())
        transport.serve(namespace + "/arena/reset_world", self._reset.set)
        self._asked = open_goals(transport, action) if action is not None else None
        self._name = ""
        self._clock = BEGIN
        self._scan_stamp = -1.0
        self.snapshot: Snapshot

    def _on_command(self, content: bytes) -> None:
        try:
            twist = to.twist_from_msg(self._own.decode(content, to.TWIST))
        except BadMessage:
            return
        if np.isfinite(twist.array()).all():
            self._command = twist.array()[None]
            self._heard.set()

    def run(self, episode: int, speed: float, is_over: Callable[[], str], *, lock_step: bool) -> None:
        """Simulate at ``speed`` times the pace of the wall clock, or one step for each command;
        from problem ``episode`` on.
        """
        self._begin_episode(episode)
        due = time.monotonic()
        while not is_over():
            if self._reset.is_set():
                self._reset.clear()
                episode += 1
                self._begin_episode(episode)
            self._publish_state()
            self._report_goal()
            if lock_step:
                self._heard.wait(0.1)
                if not self._heard.is_set():
                    continue
                self._heard.clear()
            else:
                due = max(due + self._period / speed, time.monotonic() - self._period)
                time.sleep(max(due - time.monotonic(), 0.0))
            self.snapshot = self._simulator.advance(self._command, self._ticks)
            self._clock += round(self._period * 1e9)

    def _begin_episode(self, episode: int) -> None:
        """Put robot and people where a problem has them; the clock goes on."""
        scenario: Scenario = self._task.scenario(self._seed, episode)
        self.snapshot = self._simulator.reset([scenario])
        self._command = np.zeros((1, 3))
        self._start = scenario.start
        self._scan_stamp = -1.0
        own = self._codec
        self._publish_message("/map", to.grid_msg(own, scenario.world.grid, self._clock, "map"))
        self._publish_message(
            "/tf_static", to.transforms_msg(own, [("base_link", "laser", self._robot.lidar.mount)], self._clock)
        )
        self._publish_message("/arena/scenario_goal", to.pose_stamped_msg(own, scenario.goal, self._clock, "map"))
        self._name = scenario.name
        if self._asked is not None:
            self._asked.send(scenario.goal, self._clock)

    def _report_goal(self) -> None:
        """Say, once, what a move_base made of the problem's goal."""
        if self._asked is None or not self._name:
            return
        self._asked.resend_goal()
        if (ended := self._asked.ended) is not None:
            print(f"{self._name}: {self._asked.name} says {ended.said}", flush=True)
            self._name = ""

    def _publish_state(self) -> None:
        own, now, state = self._codec, self._clock, self.snapshot.state(0)
        sensors = self.snapshot.sensors(0)
        self._publish_message("/clock", own.make(to.CLOCK, clock=own.time(now)))
        odometry = sensors.odometry
        measured = now - round((sensors.stamp - odometry.stamp) * 1e9)
        links = [("odom", "base_link", odometry.pose)]
        self._publish_message(
            "/odom", to.odometry_msg(own, odometry.pose, odometry.twist, to.Header(measured, "odom"), "base_link")
        )
        self._publish_message("/tf", to.transforms_msg(own, links, measured))
        self._publish_message(
            "/ground_truth", to.odometry_msg(own, state.pose, state.twist, to.Header(now, "map"), "base_link")
        )
        if sensors.scan.stamp != self._scan_stamp:
            self._scan_stamp = sensors.scan.stamp
            seen = now - round((sensors.stamp - sensors.scan.stamp) * 1e9)
            self._publish_message("/scan", to.scan_msg(own, sensors.scan, seen, "laser", self._robot.lidar.period))
            people = state.pedestrians
            ids = people.ids.tolist()
            self._publish_message(
                "/people", to.people_msg(own, ids, people.positions, people.velocities, to.Header(now, "map"))
            )
            self._publish_message(
                "/people_markers", to.markers_msg(own, ids, people.positions, people.radii, to.Header(now, "map"))
            )

    def _publish_message(self, topic: str, message: Any) -> None:
        publish, kind = self._out[topic]
        publish(self._codec.encode(message, kind))
