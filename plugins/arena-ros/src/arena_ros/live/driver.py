"""``arena ros drive``: the navigator of the simulation drives a robot, and keeps records of it."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from typing import Any

from arena_core import Pose, Scenario, World
from arena_core.commands import print_notice
from arena_core.hosting import Benchmark, OutsideRun, drive_episode, mission_of
from arena_core.records import Recorder
from arena_core.scenes import free_area
from arena_ros import conversions as to
from arena_ros.bags.records import ALL_CONTACTS, ALL_PEOPLE
from arena_ros.live.connections import Connections
from arena_ros.live.robot_interface import IsOver, RealInterface


@dataclass(frozen=True, slots=True, eq=False)
class Site:
    """What is driven where: the benchmark with its navigator, the world, and the run that keeps the records."""

    benchmark: Benchmark
    world: World
    run: OutsideRun


class Driver:
    """Drives to one goal after another until ``is_over`` says why that ends, empty while it does not."""

    def __init__(self, site: Site, connections: Connections, is_over: IsOver) -> None:
        self._site, self._out, self._is_over = site, connections, is_over
        self._navigator = site.benchmark.navigator
        self._period = self._navigator.control_period
        self._estimate: Pose | None = None  # where it believed to be when it was last driven
        self.wakes: list[float] = []

    def drive(self, start: Pose | None, goal: Pose | None) -> int:
        """Drive to a goal, or, where it is None, to each that comes; return how many were driven to."""
        with self._out.velocities.monitor:
            return self._drive_goals(start, goal)

    def _drive_goals(self, start: Pose | None, goal: Pose | None) -> int:
        only, driven = goal is not None, 0
        try:
            self._out.sensors.await_all(self._is_over)
            while not self._is_over():
                goal = goal or self._next_goal()
                if goal is None:
                    break
                place = self._start_pose(start)
                if place is None:
                    break
                goal, start = self._drive_episode(driven, place, goal), None
                driven += 1
                if only:
                    break
        finally:
            self._out.velocities.stop()
            self._out.goals.end(self._is_over() or "the driver ends", reached=False)
        return driven

    def _next_goal(self) -> Pose | None:
        """Wait for a goal in ``map``; meanwhile the robot stands."""
        while not self._is_over():
            if (goal := self._out.goals.take()) is not None:
                return goal
            self._out.velocities.idle()
            self._out.views.publish_status("waits for a goal")
            time.sleep(min(self._period, self._out.goals.look))
        return None

    def _start_pose(self, start: Pose | None) -> Pose | None:
        """Return where the robot stands: by a pose from elsewhere, by what was said, by what it believed
        last, or by /initialpose.
        """
        if self._out.sensors.is_external:
            return self._out.sensors.pose()
        if start is not None:
            return start
        if self._estimate is not None:
            return self._estimate
        print_notice(
            "where the robot stands is not known: waiting for /initialpose (start=X,Y,THETA says it, "
            "pose=/tf takes it from elsewhere)"
        )
        while not self._is_over():
            if (message := self._out.starts.newest()) is not None:
                return to.pose_from_msg(message.pose.pose)
            time.sleep(self._period)
        return None

    def _drive_episode(self, number: int, start: Pose, goal: Pose) -> Pose | None:
        """Drive to one goal and write its record; return the next goal where one came meanwhile."""
        scenario = self._scenario(number, start, goal)
        recorder = self._recorder(scenario, number)
        self._navigator.reset(mission_of(scenario))
        if self._out.sensors.fault() is None:
            self._navigator.rehearse(self._out.sensors.sensors(self._out.sensors.clock.now()))
        robot = RealInterface(self._out, self._site.benchmark, scenario.time_limit, recorder, self._is_over)
        ending = drive_episode(robot, self._navigator, recorder)
        self._out.velocities.stop()
        self._out.velocities.monitor.note_standing()
        self.wakes += robot.clock.wakes
        outcome, error = ending.outcome, ending.error
        if robot.last is not None:
            self._estimate = robot.last[2].estimate.pose
            notes = self._navigator.notes()
            record = recorder.finish(robot.last[0], outcome, error, ending.decision, notes)
            self._site.run.add(replace(record, meta={**record.meta, **self._unknown_arrays()}))
        if robot.following is None:
            self._out.goals.end(error or outcome, reached=outcome == "goal_reached")
        self._out.views.publish_status(outcome + (f": {error}" if error else ""), at_once=True)
        print(f"{scenario.name}: {outcome}" + (f" ({error})" if error else ""), flush=True)
        return robot.following

    def _scenario(self, number: int, start: Pose, goal: Pose) -> Scenario:
        task, seed = self._site.benchmark.config["task"], self._site.benchmark.settings.seed
        radius, limit = float(task.get("goal_radius", 0.3)), float(task.get("time_limit", 180.0))
        return Scenario(f"driven_{number:04d}", seed, self._site.world, start, goal, (), (), radius, limit)

    def _recorder(self, scenario: Scenario, number: int) -> Recorder:
        benchmark = self._site.benchmark
        return Recorder(scenario, benchmark.robot, self._record_meta(scenario, number), benchmark.recording)

    def _unknown_arrays(self) -> dict[str, Any]:
        unknown = dict.fromkeys(ALL_CONTACTS, "no simulator knows contacts")
        unknown |= dict.fromkeys(ALL_PEOPLE, "nobody told where people were")
        unknown["estimate"] = "the truth is itself an estimate"
        return {"truth": "reference" if self._out.sensors.is_external else "estimated", "unknown": unknown}

    def _record_meta(self, scenario: Scenario, number: int) -> dict[str, Any]:
        world = self._site.world
        columns = {
            **self._site.benchmark.columns,
            "simulator": "real",
            "timing": "real",
            "scenario": scenario.name,
            "scenario_hash": "",
            "stage": None,
            "seed": scenario.seed,
            "n_pedestrians": 0,
        }
        of_world = {
            "name": world.name,
            "known": world.known,
            "grid": self._site.run.grid(world.grid),
            "free_area": world.grid.derive(free_area),
        }
        return {
            "columns": {**columns, "episode": number},
            "world": of_world,
            "config": self._site.benchmark.config,
        }
