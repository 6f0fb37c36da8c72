"""The simulator: N robots and their people on occupancy grids, stepped by compiled kernels."""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from arena_core import (
    Branches,
    ConfigurationError,
    Contact,
    Crowd,
    LaserScan,
    PedestrianModel,
    Robot,
    RobotBatch,
    Scenario,
    Simulator,
    Snapshot,
)
from arena_core.parameters import NonNegative, Positive, Step
from arena_kernels.compiled import TypedDispatch
from arena_kernels.pool import GridPool
from arena_sim2d.bodies import Floats, Rows, Worlds
from arena_sim2d.doors import doors_open
from arena_sim2d.kinds import Kind, kind_of
from arena_sim2d.obstacles import Reach
from arena_sim2d.readout import allocate_people_readout, allocate_robot_readout, read_people, read_robots
from arena_sim2d.substeps import set_substeps
from arena_sim2d.ticking import measure_gaps, run_ticks, scan_slots, set_doors
from arena_sim2d.walking import begin_walking, count_steps, gait_of
from arena_sim2d.worlds import (
    begin_worlds,
    check_starts,
    fork_worlds,
    kinds_of,
    no_worlds,
    place_of_kind,
    present_robots,
    rows_of,
)

MOST_TICKS = 100_000  # of a period; events of that many are kept room for


class Sim2d(Simulator):
    """Steps N worlds of one robot or a team each at once; world k of N is bit for bit what it is alone."""

    moves_teams = True

    _worlds: Worlds
    _crowd: Crowd
    _ranges: NDArray[np.float32]
    _gaps: Floats
    _rows: NDArray[np.int64]
    _team: int

    def __init__(
        self,
        robot: Robot,
        pedestrians: PedestrianModel,
        inner_step: Step,
        crowd_period: Positive,
        lidar_height: NonNegative,
        robot_height: NonNegative,
    ) -> None:
        self.inner_step = inner_step
        self._reach = Reach(lidar_height, 0.0, robot_height)
        self._robot = robot
        self._pedestrians = pedestrians
        self._gait = gait_of(pedestrians.gait)
        self._crowd_ticks = _period_ticks("simulator.crowd_period", crowd_period, inner_step)
        self._chassis, self._wheels, self._scanner = self._take_kinds((robot,))
        self._header = _scan_header(robot)
        self._read_robots, self._read_people = TypedDispatch(read_robots), TypedDispatch(read_people)
        self._pool = GridPool()
        self._edges = (self._crowd_ticks + 1) // 2  # a contact ends a tick after it began at the earliest
        self._scenarios: list[Scenario] = []
        self._contacts: list[tuple[Contact, ...]] = []
        self._phase = 0

    def _take_kinds(self, robots: tuple[Robot, ...]) -> Kind:
        """Take in which types of robots there are; return what kernels need to know of the first.

        Raises ConfigurationError for periods that are no multiples of the inner step.
        """
        for robot in robots:
            _period_ticks(f"control_period of {robot.name}", robot.control_period, self.inner_step)
            _period_ticks(f"lidar.period of {robot.name}", robot.lidar.period, self.inner_step)
            _period_ticks(f"odometry.period of {robot.name}", robot.odometry.period, self.inner_step)
        self._types = robots
        self._kinds = tuple(kind_of(robot, self.inner_step) for robot in robots)
        # kernels are compiled for a number of types
        self._run_ticks, self._measure_gaps = TypedDispatch(run_ticks), TypedDispatch(measure_gaps)
        self._take_strides = TypedDispatch(set_substeps)
        return self._kinds[0]

    def reset(self, scenarios: Sequence[Scenario], slots: NDArray[np.int64] | None = None) -> Snapshot:
        """Begin ``scenarios``: all worlds again, or only in these ``slots``; raise
        ImpossibleScenario where a start is blocked.
        """
        if slots is None:
            self._reset_all(scenarios)
        else:
            self._reset_some(scenarios, np.asarray(slots, np.int64))
        return self._take_snapshot()

    def _reset_all(self, scenarios: Sequence[Scenario]) -> None:
        self._check_teams(scenarios, max((scenario.robots for scenario in scenarios), default=1))
        self._scenarios = list(scenarios)
        self._phase = 0
        types = kinds_of(self._robot, scenarios)
        if types != self._types:
            self._take_kinds(types)
        self._worlds = no_worlds(types, scenarios, self._pool, self._gait)
        self._rows, self._team = np.arange(len(self._worlds.robots)), self._worlds.team
        self._contacts = [()] * len(self._rows)
        self._ranges = np.zeros((len(self._rows), max(kind.lidar.beams for kind in types)), np.float32)
        self._gaps = np.zeros((len(self._rows), 4))
        self._begin_worlds(np.arange(len(scenarios)))

    def check_scenario(self, scenario: Scenario) -> None:
        """Raise ConfigurationError for a team that this simulator or its people do not know."""
        self._check_teams([scenario], scenario.robots)

    def _check_teams(self, scenarios: Sequence[Scenario], most: int) -> None:
        """Raise ConfigurationError for a team that is larger than ``most``, or that this simulator or its people do
        not know.
        """
        for scenario in scenarios:
            if scenario.robots > 1 and not self.moves_teams:
                raise ConfigurationError(
                    f"{scenario.name} has {scenario.robots} robots, and {type(self).__name__} moves one; allowed: "
                    "simulator=sim2d"
                )
            if scenario.robots > 1 and scenario.pedestrians and not self._pedestrians.meets_teams:
                raise ConfigurationError(
                    f"{scenario.name} has {scenario.robots} robots among people, and "
                    f"{type(self._pedestrians).__name__} knows of one robot; allowed: pedestrians=none"
                )
            if scenario.robots > most:
                raise ConfigurationError(
                    f"{scenario.name} has {scenario.robots} robots; allowed: up to {most}, as the worlds began with"
                )

    def _reset_some(self, scenarios: Sequence[Scenario], slots: NDArray[np.int64]) -> None:
        if self._phase != 0:
            raise ConfigurationError(
                "simulator.crowd_period must divide the control period for single worlds to be reset"
            )
        self._check_teams(scenarios, self._worlds.team)
        self._check_types(scenarios)
        for slot, scenario in zip(slots.tolist(), scenarios, strict=True):
            self._scenarios[slot] = scenario
        for row in rows_of(slots, self._worlds.team).tolist():
            self._contacts[row] = ()
        self._begin_worlds(slots)

    def _check_types(self, scenarios: Sequence[Scenario]) -> None:
        """Raise ConfigurationError for a robot of a type that the worlds did not begin with."""
        for scenario in scenarios:
            for mate in scenario.team:
                if place_of_kind(mate, self._types) < 0:
                    raise ConfigurationError(
                        f"{scenario.name} has a {mate.robot}; allowed: {', '.join(kind.name for kind in self._types)}, "
                        "as the worlds began with"
                    )

    def _begin_worlds(self, slots: NDArray[np.int64]) -> None:
        scenarios = [self._scenarios[slot] for slot in slots.tolist()]
        self._crowd = self._pedestrians.reset(slots, scenarios, len(self._scenarios))
        self._worlds = begin_worlds(
            self._worlds, self._scenarios, slots, self._crowd, self._pool, self._edges, self._reach
        )
        self._worlds.people["through_walls"] = self._pedestrians.through_walls
        if self._pedestrians.gait is not None:
            begin_walking(self._worlds.people, self._pedestrians.walks(self._crowd), scenarios, slots)
        rows = rows_of(slots, self._worlds.team)
        self._write_kinds(slots)
        if any(self._scenarios[slot].doors for slot in slots.tolist()):
            set_doors(self._worlds, slots)
        self._measure_gaps(self._worlds, rows, self._gaps)
        check_starts(self._gaps, self._scenarios, slots)
        scan_slots(self._worlds, self._kinds, self._ranges, rows)

    def _write_kinds(self, slots: NDArray[np.int64]) -> None:
        """Write the types of teammates into their rows."""
        if len(self._types) > 1:
            for slot in slots.tolist():
                first = slot * self._worlds.team
                for row, mate in enumerate(self._scenarios[slot].team, first + 1):
                    self._worlds.robots["kind"][row] = place_of_kind(mate, self._types)

    def fork(self, branches: Branches) -> Sim2d:
        """Return a simulator of its own whose worlds go on from these, bit for bit."""
        forked, slots = copy(self), branches.slots
        rows, present = rows_of(slots, self._worlds.team), present_robots(branches, self._worlds.team)
        vars(forked).update(
            _pedestrians=self._pedestrians.fork(branches),
            _crowd=self._crowd.take(slots),
            _worlds=fork_worlds(self._worlds, branches),
            _ranges=self._ranges[rows],
            _gaps=np.where(present[:, None], self._gaps[rows], np.inf),
            _rows=np.arange(len(rows)),
            _scenarios=[self._scenarios[slot] for slot in slots],
            _contacts=[self._contacts[row] for row in rows],
        )
        return forked

    def advance(self, commands: Floats, ticks: int) -> Snapshot:
        """Hold ``commands`` (R, 3), one a robot, for ``ticks`` inner steps and return what then is."""
        held = np.ascontiguousarray(commands, dtype=np.float64)
        self._worlds.robots["contact_ticks"] = 0
        edges: list[list[Contact]] = [[] for _ in self._contacts]
        left = ticks
        while left > 0:
            if self._phase == 0:
                self._step_crowd()
            now = min(self._crowd_ticks - self._phase, left)
            self._advance_worlds(held, now, left)
            self._collect_contacts(edges)
            self._phase = (self._phase + now) % self._crowd_ticks
            if self._phase == 0 and self._pedestrians.gait is not None:
                count_steps(self._worlds, self._crowd_ticks * self.inner_step)
            left -= now
        self._contacts = [tuple(begun) for begun in edges]
        self._measure_gaps(self._worlds, self._rows, self._gaps)
        return self._take_snapshot()

    def _step_crowd(self) -> None:
        """Ask the pedestrian model where people want to be one crowd period later; they go there in equal strides."""
        robots, ticks = self._worlds.robots, self._crowd_ticks
        poses, velocities = _copy_columns(robots, "x", 3), _copy_columns(robots, "vx", 2)
        in_map = velocities * np.cos(poses[:, 2:]) + velocities[:, ::-1] * np.sin(poses[:, 2:]) * (-1.0, 1.0)
        worlds_ticks, team = robots["tick"].copy(), self._team
        if team > 1:
            poses, in_map = poses.reshape(-1, team, 3), in_map.reshape(-1, team, 2)
            worlds_ticks = worlds_ticks[::team].copy()
            if not self._pedestrians.meets_teams:  # there is no one to see the others
                poses, in_map = poses[:, 0].copy(), in_map[:, 0].copy()
        batch = RobotBatch(poses, in_map, self._radii())
        doors = doors_open(self._worlds.doors)
        if doors is not None:
            self._pedestrians.watch_doors(doors)
        self._crowd = self._pedestrians.step(self._current_people(), batch, worlds_ticks, ticks * self.inner_step)
        wanted = (
            np.ascontiguousarray(self._crowd.positions, np.float64),
            np.ascontiguousarray(self._crowd.velocities, np.float64),
        )
        self._take_strides(self._worlds, *wanted, ticks)

    def _radii(self) -> float | Floats:
        """Return the radius of all robots, or where they differ of each (N, M), m."""
        if len(self._types) == 1:
            return self._robot.footprint.radius
        radii = np.array([kind.footprint.radius for kind in self._types])[self._worlds.robots["kind"]]
        return np.asarray(radii.reshape(-1, self._team))

    def _current_people(self) -> Crowd:
        """Return the people where they really are, in the states that the pedestrian model gave
        them; who waits to come is absent.
        """
        given, people = self._crowd, self._worlds.people
        now = allocate_people_readout(*people.shape)
        self._read_people(people, np.ascontiguousarray(given.states, np.int8), now)
        return Crowd(given.counts, given.ids, now.positions, now.velocities, given.radii, now.states)

    def _advance_worlds(self, commands: Floats, ticks: int, scan_within: int) -> None:
        self._worlds.robots["contacts"] = 0
        self._run_ticks(
            self._worlds,
            self._kinds,
            self._ranges,
            commands,
            ticks,
            scan_within,
            self.inner_step,
        )

    def _collect_contacts(self, edges: list[list[Contact]]) -> None:
        """Append the rising edges of the ticks just run."""
        counts = self._worlds.robots["contacts"]
        for row in np.flatnonzero(counts).tolist():
            edges[row].extend(self._make_contact(*edge) for edge in self._worlds.contacts[row, : counts[row]].tolist())

    def _make_contact(
        self, tick: int, thing: int, person: int, caused: int, speed: float, x: float, y: float
    ) -> Contact:
        kind: Literal["wall", "obstacle", "person", "robot"] = "wall"
        if thing >= self._worlds.first_robot:
            kind = "robot"
        elif thing > 0:
            kind = "obstacle" if thing < self._worlds.first_person else "person"
        return Contact(tick * self.inner_step, kind, person, speed, bool(caused), x, y)

    def _take_snapshot(self) -> Snapshot:
        worlds, now = self._worlds, allocate_robot_readout(len(self._contacts))
        self._read_robots(worlds.robots, worlds.touching, self._gaps, self.inner_step, now)
        return Snapshot(
            crowd=self._current_people(),
            contacts=tuple(self._contacts),
            ranges=self._ranges.copy(),
            scan_header=self._header,
            scan_headers=self._headers(),
            doors_open=doors_open(worlds.doors),
            team=self._team,
            **now._asdict(),
        )

    def _headers(self) -> tuple[LaserScan, ...]:
        """Return what the scans of each robot have in common, nothing where they are of one type."""
        if len(self._types) == 1:
            return ()
        headers = [_scan_header(kind, kind.lidar.beams) for kind in self._types]
        return tuple(headers[kind] for kind in self._worlds.robots["kind"].tolist())


def _copy_columns(rows: Rows, first: str, count: int) -> Floats:
    """Return copies of ``count`` fields from ``first`` on, side by side in a last axis; every
    field of a table takes eight bytes.
    """
    start = rows.dtype.fields[first][1] // 8  # type: ignore[index]
    table = rows.view(np.float64).reshape(*rows.shape, rows.dtype.itemsize // 8)
    return table[..., start : start + count].copy()


def _scan_header(robot: Robot, beams: int = 0) -> LaserScan:
    lidar = robot.lidar
    geometry = (lidar.angle_min, lidar.angle_increment, lidar.range_min, lidar.range_max)
    return LaserScan(0.0, *geometry, np.zeros(beams, np.float32), lidar.mount)


def _period_ticks(name: str, period: float, inner_step: float) -> int:
    """Return how many ticks a period has; raise ConfigurationError unless it is a multiple of ``inner_step``."""
    ticks = round(period / inner_step)
    if not 1 <= ticks <= MOST_TICKS or abs(ticks * inner_step - period) > 1e-9:
        raise ConfigurationError(
            f"{name} is {period:g} s; allowed: a multiple of simulator.inner_step ({inner_step:g} s), "
            f"up to {MOST_TICKS} times"
        )
    return ticks
