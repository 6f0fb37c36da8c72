"""``arena ros simulate``: a simulated robot among people, or a team of them, on the air as real ones would be."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from typing import Any

import numpy as np

from arena_core import ConfigurationError, Scenario, Snapshot
from arena_core.hosting import Benchmark
from arena_ros import conversions as to
from arena_ros.codec import PEOPLE, get_codec
from arena_ros.live.robot_on_air import RobotOnAir
from arena_ros.transport import Transport

BEGIN = 10**9  # ns of the clock when the first episode begins: 0 is "no time" to ROS
WAITING = 0.1  # s of wall time after which a world in lock-step that lacks a command says again what is


def robot_namespaces(count: int) -> list[str]:
    """Return the namespaces of so many robots: none of one alone, ``/robot0`` and so on of a team."""
    return [""] if count == 1 else [f"/robot{member}" for member in range(count)]


class SimulatedWorld:
    """The robots of a simulator, their people and their map. ``period`` s is that between two messages of odometry.

    A robot alone has its topics and frames by their usual names, each of a team in a namespace of its own.
    """

    def __init__(self, transport: Transport, benchmark: Benchmark, period: float, action: str | None = None) -> None:
        if benchmark.communication is not None:
            raise ConfigurationError(
                f"communication is {benchmark.config['communication']['name']}; allowed with arena ros simulate: none, "
                "nodes tell each other what they want by topics"
            )
        self._benchmark, self._simulator = benchmark, benchmark.simulator
        self._ticks = max(round(period / self._simulator.inner_step), 1)
        self._period = self._ticks * self._simulator.inner_step
        self._codec = get_codec(transport.ros)
        kinds = {"/clock": to.CLOCK, "/people": PEOPLE, "/people_markers": to.MARKERS}
        latched = {"/map": to.GRID, "/tf_static": to.TF}
        self._out = {topic: (transport.publisher(topic, kind), kind) for topic, kind in kinds.items()}
        self._out |= {topic: (transport.publisher(topic, kind, latched=True), kind) for topic, kind in latched.items()}
        self._robots = [RobotOnAir(transport, space, action) for space in robot_namespaces(benchmark.robots)]
        self._reset = threading.Event()
        transport.subscribe("/arena/reset", to.EMPTY, lambda content: self._reset.set())
        transport.serve("/arena/reset_world", self._reset.set)
        self._clock = BEGIN
        self.snapshot: Snapshot

    def warm_up(self, episode: int) -> None:
        """Have the simulator compiled by a few steps of a problem, before anybody waits for its robots."""
        self._simulator.reset([self._scenario(episode)])
        self._simulator.advance(np.zeros((len(self._robots), 3)), self._ticks)

    def run(self, episode: int, speed: float, is_over: Callable[[], str], *, lock_step: bool) -> None:
        """Simulate at ``speed`` times the pace of the wall clock, or one step for each command (of all robots);
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
            for robot in self._robots:
                robot.report_goal()
            if lock_step:
                if not self._await_commands():
                    continue
            else:
                due = max(due + self._period / speed, time.monotonic() - self._period)
                time.sleep(max(due - time.monotonic(), 0.0))
            commands = np.array([robot.command for robot in self._robots])
            self.snapshot = self._simulator.advance(commands, self._ticks)
            self._clock += round(self._period * 1e9)

    def _await_commands(self) -> bool:
        """Wait for a command of every robot; return whether all have come by now."""
        end = time.monotonic() + WAITING
        if not all(robot.heard.wait(max(end - time.monotonic(), 0.0)) for robot in self._robots):
            return False
        for robot in self._robots:
            robot.heard.clear()
        return True

    def _begin_episode(self, episode: int) -> None:
        """Put robots and people where a problem has them; the clock goes on."""
        scenario, own = self._scenario(episode), self._codec
        bodies = [self._benchmark.robot, *(mate.body or self._benchmark.robot for mate in scenario.team)]
        self.snapshot = self._simulator.reset([scenario])
        self._publish_message("/map", to.grid_msg(own, scenario.world.grid, self._clock, "map"))
        links = [robot.lidar_link(body) for robot, body in zip(self._robots, bodies, strict=True)]
        self._publish_message("/tf_static", to.transforms_msg(own, links, self._clock))
        for member, (robot, body) in enumerate(zip(self._robots, bodies, strict=True)):
            robot.begin(scenario.seen_by(member), body, self._clock)

    def _scenario(self, episode: int) -> Scenario:
        """Return a problem with the bodies of its team; raise ConfigurationError where goals of it move."""
        benchmark = self._benchmark
        scenario = benchmark.task.scenario(benchmark.settings.seed, episode)
        if scenario.errands is not None:
            raise ConfigurationError(
                f"task {benchmark.config['task']['name']} sends robots on from goal to goal; allowed with arena ros "
                "simulate: tasks whose goals stay"
            )
        return scenario if benchmark.mates is None else benchmark.mates.equip(scenario)

    def _publish_state(self) -> None:
        own, now = self._codec, self._clock
        self._publish_message("/clock", own.make(to.CLOCK, clock=own.time(now)))
        new_scans = [robot.publish(self.snapshot, row, now) for row, robot in enumerate(self._robots)]
        if new_scans[0]:
            people = self.snapshot.state(0).pedestrians
            ids, header = people.ids.tolist(), to.Header(now, "map")
            self._publish_message("/people", to.people_msg(own, ids, people.positions, people.velocities, header))
            self._publish_message("/people_markers", to.markers_msg(own, ids, people.positions, people.radii, header))

    def _publish_message(self, topic: str, message: Any) -> None:
        publish, kind = self._out[topic]
        publish(self._codec.encode(message, kind))
