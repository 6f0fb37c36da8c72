"""The simulator: N robots and their people on occupancy grids, stepped by compiled kernels."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from arena_core import (
    ConfigurationError,
    Contact,
    LaserScan,
    PedestrianModel,
    Positive,
    Robot,
    RobotBatch,
    Scenario,
    Simulator,
    Snapshot,
)
from arena_sim2d.bodies import Floats
from arena_sim2d.odometry import wheel_noise
from arena_sim2d.scanning import scanner
from arena_sim2d.starting import check_starts
from arena_sim2d.ticking import measure_clearances, run_ticks, scan_slots
from arena_sim2d.worlds import Worlds


class Sim2d(Simulator):
    """Steps N worlds at once; world k of N is bit for bit what it is alone."""

    def __init__(self, robot: Robot, pedestrians: PedestrianModel, inner_step: Positive, crowd_period: Positive) -> None:
        self.inner_step = inner_step
        self._robot = robot
        self._pedestrians = pedestrians
        self._crowd_ticks = _ticks("simulator.crowd_period", crowd_period, inner_step)
        _ticks(f"control_period of {robot.name}", robot.control_period, inner_step)
        _ticks(f"lidar.period of {robot.name}", robot.lidar.period, inner_step)
        _ticks(f"odometry.period of {robot.name}", robot.odometry.period, inner_step)
        self._wheels = wheel_noise(robot.odometry, inner_step)
        self._scanner = scanner(robot.lidar, inner_step)
        self._header = LaserScan(
            0.0,
            robot.lidar.angle_min,
            robot.lidar.angle_increment,
            robot.lidar.range_min,
            robot.lidar.range_max,
            np.empty(0, np.float32),
            robot.lidar.mount,
        )
        self._worlds: Worlds
        self._phase = 0
        self._contacts: list[tuple[Contact, ...]] = []

    def reset(self, scenarios: Sequence[Scenario], slots: NDArray[np.int64] | None = None) -> Snapshot:
        """Begin ``scenarios``: all worlds anew, or only in these ``slots``; raise ImpossibleScenario where a start is blocked."""
        if slots is None:
            slots = np.arange(len(scenarios))
            crowd = self._pedestrians.reset(slots, scenarios, len(scenarios))
            self._worlds = Worlds(self._robot, scenarios, crowd, self._crowd_ticks)
            self._contacts = [()] * len(scenarios)
            self._phase = 0
        else:
            self._reset_some(scenarios, np.asarray(slots, np.int64))
        worlds = self._worlds
        check_starts(worlds, slots)
        scan_slots(worlds.moving, self._scanner, worlds.scans, slots)
        return self._snapshot()

    def _reset_some(self, scenarios: Sequence[Scenario], slots: NDArray[np.int64]) -> None:
        if self._phase != 0:
            raise ConfigurationError("simulator.crowd_period must divide the control period for single worlds to be reset")
        self._worlds.begin(slots, scenarios, self._pedestrians.reset(slots, scenarios, len(self._worlds.scenarios)))
        for slot in slots.tolist():
            self._contacts[slot] = ()

    def advance(self, commands: Floats, ticks: int) -> Snapshot:
        """Hold ``commands`` (N, 3) for ``ticks`` inner steps and return what then is."""
        held = np.ascontiguousarray(commands, dtype=np.float64)
        self._worlds.moving.touch.ticks[:] = 0
        edges: list[list[Contact]] = [[] for _ in self._worlds.scenarios]
        left = ticks
        while left > 0:
            if self._phase == 0:
                self._ask_crowd()
            now = min(self._crowd_ticks - self._phase, left)
            self._run(held, now, left)
            self._collect(edges)
            self._phase = (self._phase + now) % self._crowd_ticks
            left -= now
        self._contacts = [tuple(world) for world in edges]
        return self._snapshot()

    def _ask_crowd(self) -> None:
        """Ask the pedestrian model where people want to be one crowd period later."""
        worlds = self._worlds
        robots = worlds.moving.robots
        poses, velocities, ticks = robots.poses.copy(), robots.velocities, robots.ticks.copy()
        c, s = np.cos(poses[:, 2]), np.sin(poses[:, 2])
        in_map = np.stack((c * velocities[:, 0] - s * velocities[:, 1], s * velocities[:, 0] + c * velocities[:, 1]), axis=1)
        batch = RobotBatch(poses, in_map, self._robot.footprint.radius)
        period = self._crowd_ticks * self.inner_step
        worlds.follow(self._pedestrians.step(worlds.crowd(), batch, ticks, period), self._crowd_ticks)

    def _run(self, commands: Floats, ticks: int, scan_within: int) -> None:
        worlds = self._worlds
        worlds.moving.touch.counts[:] = 0
        run_ticks(
            worlds.moving,
            self._wheels,
            worlds.odometers,
            self._scanner,
            worlds.scans,
            commands,
            ticks,
            scan_within,
            self.inner_step,
        )

    def _collect(self, edges: list[list[Contact]]) -> None:
        """Append the rising edges of the ticks just run."""
        touch = self._worlds.moving.touch
        for slot in np.flatnonzero(touch.counts).tolist():
            for row in touch.edges[slot, : touch.counts[slot]].tolist():
                edges[slot].append(self._contact(row))

    def _contact(self, row: list[float]) -> Contact:
        tick, thing, speed, caused, x, y, person = row
        kind: Literal["wall", "obstacle", "person"] = "person" if person >= 0 else "obstacle" if thing > 0 else "wall"
        return Contact(tick * self.inner_step, kind, int(person), speed, bool(caused), x, y)

    def _snapshot(self) -> Snapshot:
        worlds = self._worlds
        robots, touch, odometers, scans = worlds.moving.robots, worlds.moving.touch, worlds.odometers, worlds.scans
        clearances, to_people = np.empty(len(robots.ticks)), np.empty(len(robots.ticks))
        measure_clearances(worlds.moving, clearances, to_people)
        return Snapshot(
            stamps=self._seconds(robots.ticks),
            poses=robots.poses.copy(),
            twists=robots.velocities.copy(),
            crowd=worlds.crowd(),
            clearances=clearances,
            clearances_people=to_people,
            in_contact=np.array(touch.held.any(axis=1)),
            contact_times=self._seconds(touch.ticks),
            contacts=tuple(self._contacts),
            ranges=scans.ranges.copy(),
            scan_stamps=self._seconds(scans.ticks),
            odometry_stamps=self._seconds(odometers.ticks),
            odometry_poses=odometers.poses.copy(),
            odometry_twists=odometers.twists.copy(),
            scan_header=self._header,
        )

    def _seconds(self, ticks: NDArray[np.int64]) -> Floats:
        return np.multiply(ticks, self.inner_step, dtype=np.float64)


def _ticks(name: str, period: float, inner_step: float) -> int:
    """Return how many ticks a period has; raise ConfigurationError unless it is a multiple of ``inner_step``."""
    ticks = round(period / inner_step)
    if ticks < 1 or abs(ticks * inner_step - period) > 1e-9:
        raise ConfigurationError(f"{name} is {period:g} s; allowed: a multiple of simulator.inner_step ({inner_step:g} s)")
    return ticks
