"""A real robot as the loop of an episode drives it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from arena_core import Pedestrians, Pose, Sensors
from arena_core.commands import print_notice
from arena_core.hosting import Benchmark, Decision, Ending, NavigatorSpent
from arena_core.records import Event, Recorder, WorldState
from arena_ros.bags.footprint import nearest_return
from arena_ros.live.connections import Connections
from arena_ros.live.speed_limiter import STAND
from arena_ros.live.time_source import TimeSource

IsOver = Callable[[], str]  # says why a drive is to end, empty while it is not
NO_PEOPLE = Pedestrians(np.empty(0, np.int32), np.empty((0, 2)), np.empty((0, 2)), np.empty(0), np.empty(0, np.int8))


class ControlClock:
    """Control steps; those that were missed are left out."""

    def __init__(self, period: float, time: TimeSource) -> None:
        self._period, self._time = period, time
        self.begin = self._due = time.now()
        self.wakes: list[float] = []

    def wait(self) -> bool:
        """Wait until a step is due, or, where the clock stands, for a while; return whether it is."""
        if not self._time.wait(self._due):
            return False
        self.wakes.append(self._time.now())
        self._due = self._time.next_due(self._due, self._period)
        return True

    def elapsed(self) -> float:
        """Return the time since the beginning, s."""
        return self._time.now() - self.begin


class RealInterface:
    """A real robot, driven to one goal; ``following`` is the next goal where one came meanwhile.

    ``last`` are state, sensors and decision of the last control step, None before the first one.
    """

    following: Pose | None = None
    last: tuple[WorldState, Sensors, Decision] | None = None

    def __init__(
        self, connections: Connections, benchmark: Benchmark, time_limit: float, recorder: Recorder, is_over: IsOver
    ) -> None:
        self._out, self._robot, self._recorder, self._is_over = connections, benchmark.robot, recorder, is_over
        self._limit = time_limit
        self._stamp = 0.0
        self.clock = ControlClock(benchmark.navigator.control_period, connections.sensors.clock)

    def read(self) -> Sensors | Ending:
        """Wait until a step is due; while something is wrong the robot stands."""
        while True:
            due, self._stamp = self.clock.wait(), self.clock.elapsed()
            if (ending := self._ending()) is not None:
                return ending
            if not due:
                continue
            self._out.velocities.await_odometry(self._out.sensors)
            fault = self._out.sensors.fault() or self._out.velocities.rival()
            if fault is None:
                self._sensors = self._out.sensors.sensors(self.clock.begin)
                return self._sensors
            self._out.velocities.stop()
            self._record_stop(fault)
            if given_up := self._out.goals.stall(fault, self._stamp):
                return Ending("error", given_up)

    def _ending(self) -> Ending | None:
        """Return how the episode ends before anything is decided."""
        if why := self._is_over():
            return Ending("error", why)
        if (following := self._out.goals.take()) is not None:
            self.following = following
            return Ending("error", "another goal came")
        if over := self._out.goals.over():
            return Ending("error", over)
        return Ending("time_out") if self._stamp >= self._limit else None

    def judge(self, decision: Decision) -> Ending | None:
        """End where the robot believes to have arrived, or who sent the goal has rules by which it is given up."""
        if not decision.arrived:
            given_up = self._out.goals.judge(decision, self._stamp)
            return Ending("error", given_up) if given_up else None
        limited = self._out.velocities.limit(decision, self._took(), self._stamp)
        self.last = self._world_state(limited), self._sensors, limited
        return Ending("goal_reached", "", limited)

    def write(self, decision: Decision) -> Decision:
        """Send the command, unless it comes too late to be true any more."""
        took = self._took()
        limited = self._out.velocities.limit(decision, took, self._stamp)
        self._out.velocities.send(limited, took)
        self.last = self._world_state(limited), self._sensors, limited
        self._recorder.sense(*self.last[:2])
        self._out.views.publish_step(limited, self._sensors)
        return limited

    def _took(self) -> float:
        return self.clock.elapsed() - self._stamp

    def _world_state(self, decision: Decision) -> WorldState:
        sensors = self._sensors
        _, clearance = nearest_return(self._robot.footprint, sensors.scan)
        pose = sensors.reference if sensors.reference is not None else decision.estimate.pose
        return WorldState(
            sensors.stamp, pose, sensors.odometry.twist, NO_PEOPLE, clearance, float("inf"), False, 0.0, ()
        )

    def _record_stop(self, fault: str) -> None:
        """Record a step in which the robot had to stand."""
        self._out.views.publish_status(f"stopped: {fault}")
        if self.last is None:
            return
        state, sensors, decision = self.last
        state = replace(state, stamp=self._stamp, contacts=())
        newly = not any(event.kind == "safety_stop" for event in decision.events)
        events = (Event(self._stamp, "safety_stop", fault if newly else "still"),)
        if newly:
            print_notice(f"stopped: {fault}")
        decision = replace(decision, command=STAND, planned=None, events=events, spent=NavigatorSpent(0.0, 0.0, 0.0))
        self._recorder.sense(state, sensors)
        self._recorder.add(decision)
        self.last = state, sensors, decision
