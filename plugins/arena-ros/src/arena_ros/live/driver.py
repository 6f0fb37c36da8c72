"""``arena ros drive``: the navigator of the simulation drives a robot, with the wall clock for
its time, and keeps records of it.
"""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from arena_core import Candidate, Observation, Pedestrians, Planner, Pose, Scenario, Sensors, Twist, World
from arena_core.commands import describe_error, print_notice
from arena_core.hosting import Benchmark, Decision, Mission, NavigatorSpent, OutsideRun
from arena_core.records import Event, Recorder, WorldState
from arena_core.scenes import free_area
from arena_ros import conversions as to
from arena_ros.bags.footprint import nearest_return
from arena_ros.bags.records import ALL_CONTACTS, ALL_PEOPLE
from arena_ros.codec import PEOPLE, get_codec
from arena_ros.live.goals import Goals
from arena_ros.live.latest_message import LatestMessage
from arena_ros.live.loop_monitor import LoopMonitor
from arena_ros.live.sensor_inputs import SensorInputs
from arena_ros.live.settings import Settings
from arena_ros.live.speed_limiter import STAND, SpeedLimiter
from arena_ros.transport import Transport

NO_PEOPLE = Pedestrians(np.empty(0, np.int32), np.empty((0, 2)), np.empty((0, 2)), np.empty(0), np.empty(0, np.int8))


class Seen(Planner):
    """A planner whose last observation can be shown to people."""

    def __init__(self, planner: Planner) -> None:
        self.inner = planner
        self.observation: Observation | None = None

    def reset(self, episode: Any) -> None:
        """Begin an episode."""
        self.observation = None
        self.inner.reset(episode)

    def compute_velocity(self, observation: Observation) -> Twist:
        """Return what the planner says."""
        self.observation = observation
        return self.inner.compute_velocity(observation)

    def considered(self) -> Sequence[Candidate] | None:
        """Return what the planner considered."""
        return self.inner.considered()


class Driver:
    """Drives to one goal after another until ``is_over``; ``world`` is the site, ``target`` the topic of velocities.

    With ``alone`` the robot stands while another node publishes ``target``: two masters move it as neither of them
    wants. ``action`` is the name under which move_base's action is served; None: the usual one in ROS 1.
    """

    def __init__(
        self,
        transport: Transport,
        senses: SensorInputs,
        benchmark: Benchmark,
        world: World,
        run: OutsideRun,
        settings: Settings,
        target: str,
        action: str | None,
        *,
        alone: bool,
    ) -> None:
        self._benchmark, self._world, self._run, self._settings, self._senses = benchmark, world, run, settings, senses
        self._navigator = benchmark.navigator
        self._seen = Seen(self._navigator.planner)
        self._seen.compiles = self._navigator.planner.compiles  # type: ignore[misc]
        self._navigator.planner = self._seen
        self._period = self._navigator.control_period
        self._governor = SpeedLimiter(benchmark.robot, settings.speed, self._period)
        own = self._codec = get_codec(transport.ros)
        self._goals = Goals(transport, action)
        self._starts = LatestMessage(transport, own, "/initialpose", to.POSE_COVARIANCE)
        self._send = transport.publisher(target, to.TWIST)
        self._target, self._stand = target, own.encode(to.twist_msg(own, STAND), to.TWIST)
        limit = (settings.overrun + 1.0) * self._period
        self._guard = LoopMonitor(
            lambda: self._send(self._stand), limit, (lambda: transport.rivals(target)) if alone else None
        )
        topics = {
            "/plan": to.PATH,
            "/waypoint": to.POSE_STAMPED,
            "/arena/pose": to.POSE_COVARIANCE,
            "/arena/status": to.TEXT,
        }
        topics |= {"/arena/local_costmap": to.GRID, "/arena/tracks": PEOPLE}
        self._out = {
            topic: (transport.publisher(topic, kind, latched=topic == "/plan"), kind) for topic, kind in topics.items()
        }
        self._tf = None if senses.is_external else transport.publisher("/tf", to.TF)
        self._shown = float("-inf")
        self._estimate: Pose | None = None  # where it believed to be when it was last driven
        self.latencies: list[float] = []
        # s of each step that were not the navigator's: taking in sensors, limits, sending
        self.beyond: list[float] = []
        self.wakes: list[float] = []

    def drive(self, start: Pose | None, goal: Pose | None, is_over: Callable[[], str]) -> int:
        """Drive to a goal, or, where it is None, to each that comes, until ``is_over`` says why it ends;
        return how many were driven to.
        """
        with self._guard:
            return self._drive_goals(start, goal, is_over)

    def _drive_goals(self, start: Pose | None, goal: Pose | None, is_over: Callable[[], str]) -> int:
        only, driven = goal is not None, 0
        try:
            self._senses.await_all(is_over)
            while not is_over():
                goal = goal or self._next_goal(is_over)
                if goal is None:
                    break
                place = self._start_pose(start, is_over)
                if place is None:
                    break
                goal, start = self._drive_episode(driven, place, goal, is_over), None
                driven += 1
                if only:
                    break
        finally:
            self._publish_command(self._governor.stop())
            self._goals.end(is_over() or "the driver ends", reached=False)
        return driven

    def _next_goal(self, is_over: Callable[[], str]) -> Pose | None:
        """Wait for a goal in ``map``; meanwhile the robot stands."""
        while not is_over():
            if (goal := self._goals.take()) is not None:
                return goal
            self._publish_command(self._governor.stop())
            self._publish_status("waits for a goal", None)
            time.sleep(self._period)
        return None

    def _start_pose(self, start: Pose | None, is_over: Callable[[], str]) -> Pose | None:
        """Return where the robot stands: by a pose from elsewhere, by what was said, by what it believed
        last, or by /initialpose.
        """
        if self._senses.is_external:
            return self._senses.pose()
        if start is not None:
            return start
        if self._estimate is not None:
            return self._estimate
        print_notice(
            "where the robot stands is not known: waiting for /initialpose (start=X,Y,THETA says it, "
            "pose=/tf takes it from elsewhere)"
        )
        while not is_over():
            if (message := self._starts.newest()) is not None:
                return to.pose_from_msg(message.pose.pose)
            time.sleep(self._period)
        return None

    def _drive_episode(self, number: int, start: Pose, goal: Pose, is_over: Callable[[], str]) -> Pose | None:
        """Drive to one goal and write its record; return the next goal where one came meanwhile."""
        task, grid = self._benchmark.config["task"], self._world.grid
        radius, limit = float(task.get("goal_radius", 0.3)), float(task.get("time_limit", 180.0))
        seed = self._benchmark.settings.seed
        scenario = Scenario(f"driven_{number:04d}", seed, self._world, start, goal, (), (), radius, limit)
        keeps = self._benchmark.recording
        meta = self._record_meta(scenario, number)
        recorder = Recorder(
            scenario,
            self._benchmark.robot,
            meta,
            keep_scans=keeps.scans,
            keep_tracks=keeps.tracks,
            keep_considered=keeps.considered,
        )
        self._navigator.reset(Mission(grid if self._world.known else None, start, goal, radius, seed, scenario.name))
        if (fault := self._senses.fault()) is None:
            self._navigator.rehearse(self._senses.sensors(time.monotonic()))
        begin = due = time.monotonic()
        last: tuple[WorldState, Sensors, Decision] | None = None
        following: Pose | None = None
        outcome, error, ending = "error", "", None
        while True:
            due = self._wait_until(due)
            stamp = time.monotonic() - begin
            if why := is_over():
                error = why
                break
            if (following := self._goals.take()) is not None:
                error = "another goal came"
                break
            if self._goals.is_cancelled():
                error = "the goal was cancelled"
                break
            if stamp >= limit:
                outcome = "time_out"
                break
            if (fault := self._senses.fault() or self._rival_publisher()) is not None:
                self._publish_command(self._governor.stop())
                last = self._record_stop(recorder, last, stamp, fault)
                continue
            sensors = self._senses.sensors(begin)
            try:
                decision = self._navigator.decide(sensors)
                considered = self._navigator.considered(decision) if recorder.keeps_considered else None
            # whatever a planner raises, or a second Ctrl-C: the robot stands first
            except (Exception, KeyboardInterrupt) as broken:
                self._publish_command(self._governor.stop())
                error = describe_error(broken)
                break
            decision = self._send_command(decision, time.monotonic() - begin - stamp, stamp)
            state = self._world_state(sensors, decision)
            last = state, sensors, decision
            if decision.arrived:
                self._publish_command(self._governor.stop())
                outcome, ending = "goal_reached", decision
                break
            recorder.sense(state, sensors)
            recorder.add(decision, considered)
            self._publish_views(decision, sensors)
        self._publish_command(self._governor.stop())
        self._guard.note_standing()
        if last is not None:
            self._estimate = last[2].estimate.pose
            record = recorder.finish(last[0], outcome, error, ending)  # type: ignore[arg-type]
            self._run.add(replace(record, meta={**record.meta, **self._unknown_arrays()}))
        if following is None:
            self._goals.end(error or outcome, reached=outcome == "goal_reached")
        self._publish_status(outcome + (f": {error}" if error else ""), None, at_once=True)
        print(f"{scenario.name}: {outcome}" + (f" ({error})" if error else ""), flush=True)
        return following

    def _wait_until(self, due: float) -> float:
        """Wait until a step is due; return when the next one is. Steps that were missed are left out."""
        now = time.monotonic()
        if due > now:
            time.sleep(due - now)
        self.wakes.append(time.monotonic())
        return (
            max(due + self._period, time.monotonic()) if time.monotonic() - due > self._period else due + self._period
        )

    def _send_command(self, decision: Decision, took: float, stamp: float) -> Decision:
        """Send the command, unless it comes too late to be true any more."""
        if took > self._settings.overrun * self._period:
            sent = self._governor.stop()
            event = Event(stamp, "safety_stop", f"a control step took {took:.2f} s")
            decision = replace(decision, events=(*decision.events, event))
            print_notice("control steps take longer than they may: the robot stops for each of them")
        else:
            sent = self._governor.limit_command(decision.command)
        if not decision.arrived:
            begin = time.monotonic()
            self._publish_command(sent)
            self._guard.note_command()
            self.latencies.append(took + time.monotonic() - begin)
            self.beyond.append(self.latencies[-1] - decision.spent.navigator)
        return replace(decision, command=sent)

    def _rival_publisher(self) -> str | None:
        rivals = self._guard.rivals
        return f"{rivals[0]} publishes {self._target}, too (alone=false lets it)" if rivals else None

    def _record_stop(self, recorder: Recorder, last: Any, stamp: float, fault: str) -> Any:
        """Record a step in which the robot had to stand."""
        self._publish_status(f"stopped: {fault}", None)
        if last is None:
            return None
        state, sensors, decision = last
        state = replace(state, stamp=stamp, contacts=())
        newly = not any(event.kind == "safety_stop" for event in decision.events)
        events = (Event(stamp, "safety_stop", fault),) if newly else (Event(stamp, "safety_stop", "still"),)
        if newly:
            print_notice(f"stopped: {fault}")
        decision = replace(decision, command=STAND, planned=None, events=events, spent=NavigatorSpent(0.0, 0.0, 0.0))
        recorder.sense(state, sensors)
        recorder.add(decision)
        return state, sensors, decision

    def _world_state(self, sensors: Sensors, decision: Decision) -> WorldState:
        _, clearance = nearest_return(self._benchmark.robot.footprint, sensors.scan)
        pose = sensors.reference if sensors.reference is not None else decision.estimate.pose
        return WorldState(
            sensors.stamp, pose, sensors.odometry.twist, NO_PEOPLE, clearance, float("inf"), False, 0.0, ()
        )

    def _unknown_arrays(self) -> dict[str, Any]:
        unknown = dict.fromkeys(ALL_CONTACTS, "no simulator knows contacts")
        unknown |= dict.fromkeys(ALL_PEOPLE, "nobody told where people were")
        unknown["estimate"] = "the truth is itself an estimate"
        return {"truth": "reference" if self._senses.is_external else "estimated", "unknown": unknown}

    def _record_meta(self, scenario: Scenario, number: int) -> dict[str, Any]:
        grid = self._world.grid
        columns = {
            **self._benchmark.columns,
            "simulator": "real",
            "timing": "real",
            "scenario": scenario.name,
            "scenario_hash": "",
            "stage": None,
            "seed": scenario.seed,
            "n_pedestrians": 0,
        }
        world = {
            "name": self._world.name,
            "known": self._world.known,
            "grid": self._run.grid(grid),
            "free_area": grid.derive(free_area),
        }
        return {"columns": {**columns, "episode": number}, "world": world, "config": self._benchmark.config}

    def _publish_command(self, command: Twist) -> None:
        self._send(self._codec.encode(to.twist_msg(self._codec, command), to.TWIST))

    def _publish_views(self, decision: Decision, sensors: Sensors) -> None:
        """Publish what people want to see; the command is out already."""
        own, now = self._codec, time.time_ns()
        if decision.planned is not None:
            self._publish_message("/plan", to.path_msg(own, decision.planned.poses, now, "map"))
        self._publish_message("/waypoint", to.pose_stamped_msg(own, decision.waypoint, now, "map"))
        estimate = decision.estimate
        self._publish_message(
            "/arena/pose", to.pose_covariance_msg(own, estimate.pose, estimate.covariance, now, "map")
        )
        if self._tf is not None:
            correction = estimate.pose.compose(sensors.odometry.pose.relative(Pose(0.0, 0.0)))
            self._tf(own.encode(to.transforms_msg(own, [("map", "odom", correction)], now), to.TF))
        self._goals.publish_pose(estimate.pose)
        self._publish_status("drives", decision)

    def _publish_status(self, text: str, decision: Decision | None, *, at_once: bool = False) -> None:
        self._goals.tick()
        if not at_once and time.monotonic() - self._shown < self._settings.status_period:
            return
        self._shown = time.monotonic()
        own, now = self._codec, time.time_ns()
        status: dict[str, Any] = {"status": text}
        if decision is not None:
            status["command"] = decision.command.array().tolist()
            if (seen := self._seen.observation) is not None:
                costs, tracks = seen.local_map, seen.tracks
                self._publish_message("/arena/local_costmap", to.costmap_msg(own, costs, now, "map"))
                self._publish_message(
                    "/arena/tracks",
                    to.people_msg(own, tracks.ids.tolist(), tracks.positions, tracks.velocities, to.Header(now, "map")),
                )
        self._publish_message("/arena/status", to.text_msg(own, json.dumps(status)))

    def _publish_message(self, topic: str, message: Any) -> None:
        publish, kind = self._out[topic]
        publish(self._codec.encode(message, kind))
