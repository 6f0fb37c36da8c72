"""Recorded people in N worlds: they appear, walk and vanish as they did."""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from arena_core import (
    ABSENT,
    Branches,
    ConfigurationError,
    Crowd,
    Gait,
    ImpossibleScenario,
    PedestrianModel,
    Pedestrians,
    RobotBatch,
    Scenario,
    World,
    random_generator,
)
from arena_core.commands import print_notice
from arena_core.files import local_path
from arena_core.parameters import NonNegative, Positive
from arena_crowds.replay.recordings import Format, read_recording
from arena_crowds.replay.scale import Unit
from arena_crowds.slots import grow_array, no_crowd, with_worlds

STANDING, WALKING = 1, 2
STANDS = 0.1  # m/s: who is slower stands, more or less
DRAWS = 100  # of a start time, before a scenario is given up
NOBODY = -1


class ReplayedCrowd(PedestrianModel):
    """People of a recording. Scenarios' own people are left out, and so is the one whose place the robot takes; neither
    robots nor walls change anything.

    Whoever walks through a wall, since the recording is not of this map, is told of.
    """

    through_walls = True
    meets_teams = True

    def __init__(
        self,
        path: str,
        format: Format,
        unit: Unit | None,
        frame_rate: Positive | None,
        interpolation: Literal["cubic", "linear"],
        offset_xy: Sequence[float],
        rotation: float,
        speed: Positive,
        start_time: NonNegative | None,
        clear_start: NonNegative,
        radius: Positive,
        body: Literal["discs", "legs"],
        gait: Gait,
    ) -> None:
        self.gait = gait if body == "legs" else None
        recording = read_recording(local_path(path), format, frame_rate, unit)
        self._recording = recording.transform(np.array(offset_xy, np.float64), rotation)
        if len(offset_xy) != 2:
            raise ConfigurationError(f"pedestrians.offset_xy has {len(offset_xy)} numbers; allowed: 2, x and y")
        if start_time is not None and start_time >= recording.duration:
            raise ConfigurationError(
                f"pedestrians.start_time is {start_time:g}; allowed: below {recording.duration:g} s, "
                "the recording's end"
            )
        self._path, self._unaware_of_walls = path, True
        self._cubic = interpolation == "cubic"
        self._speed, self._start_time, self._clear_start, self._radius = speed, start_time, clear_start, radius
        self._clear_worlds(0)

    def _clear_worlds(self, total: int) -> None:
        """Empty all worlds.

        ``_walks`` (N, P) says whose walk is in each place, ``_times`` (N,) what time of the recording it is, s.
        """
        self._crowd = no_crowd(total)
        self._walks = np.full((total, 0), NOBODY)
        self._times = np.zeros(total)

    def reset(self, slots: NDArray[np.int64], scenarios: Sequence[Scenario], total: int) -> Crowd:
        """Begin in these slots at the start times of ``scenarios``; raise
        ImpossibleScenario when none has a clear start.
        """
        if total != len(self._times):
            self._clear_worlds(total)
        worlds = {}
        for slot, scenario in zip(slots.tolist(), scenarios, strict=True):
            begin = self._start_of(scenario)
            walks = self._walks_between(begin, begin + self._speed * scenario.time_limit)
            if scenario.replaces is not None:
                walks = walks[self._recording.ids[walks] != scenario.replaces.person]
            self._times[slot] = begin
            self._walks = grow_array(self._walks, len(walks), NOBODY)
            self._walks[slot, : len(walks)], self._walks[slot, len(walks) :] = walks, NOBODY
            worlds[slot] = self._make_people(walks, begin)
            self._warn_of_walls(walks, scenario.world)
        self._crowd = with_worlds(self._crowd, worlds)
        return self._crowd

    def _warn_of_walls(self, walks: NDArray[np.int64], world: World) -> None:
        """Tell once whether a person walks where the map has a wall."""
        bounds, grid = self._recording.first, world.grid
        for walk in walks.tolist() if self._unaware_of_walls else ():
            cells = grid.cells(self._recording.positions[bounds[walk] : bounds[walk + 1]])
            if grid.occupied[tuple(cells[grid.contains(cells)].T)].any():
                print_notice(
                    f"{self._path}: person {self._recording.ids[walk]}, and maybe others, "
                    f"walk through walls of {world.name}"
                )
                self._unaware_of_walls = False
                return

    def step(self, crowd: Crowd, robots: RobotBatch, ticks: NDArray[np.int64], dt: float) -> Crowd:
        """Return where the recorded people are ``dt`` seconds later, wherever those of ``crowd`` were held up."""
        self._times = self._times + self._speed * dt
        there = self._walks != NOBODY
        positions, velocities = np.full((*there.shape, 2), np.nan), np.full((*there.shape, 2), np.nan)
        times = np.broadcast_to(self._times[:, None], there.shape)
        positions[there], velocities[there] = self._sample_walks(self._walks[there], times[there])
        self._crowd = Crowd(
            crowd.counts, crowd.ids, positions, velocities, crowd.radii, _walking_states(positions, velocities)
        )
        return self._crowd

    def fork(self, branches: Branches) -> ReplayedCrowd:
        """Return a crowd of its own that goes on from this one; nothing is drawn on the way."""
        forked, slots = copy(self), branches.slots
        vars(forked).update(_crowd=self._crowd.take(slots), _walks=self._walks[slots], _times=self._times[slots])
        return forked

    def _sample_walks(
        self, walks: NDArray[np.int64], times: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        positions, velocities = self._recording.at(walks, times, cubic=self._cubic)
        return positions, self._speed * velocities

    def _walks_between(self, begin: float, end: float) -> NDArray[np.int64]:
        """Return the walks of which something lies between two times of the recording."""
        return np.flatnonzero((self._recording.ends >= begin) & (self._recording.begins <= end))

    def _make_people(self, walks: NDArray[np.int64], time: float) -> Pedestrians:
        positions, velocities = self._sample_walks(walks, np.full(len(walks), time))
        states = _walking_states(positions, velocities)
        return Pedestrians(
            self._recording.ids[walks], positions, velocities, np.full(len(walks), float(self._radius)), states
        )

    def _start_of(self, scenario: Scenario) -> float:
        """Return the time of the recording at which an episode begins: that of the walk which the robot replaces, the
        given one, or one that the scenario draws.
        """
        if scenario.replaces is not None:
            return scenario.replaces.begin
        if self._start_time is not None:
            return float(self._start_time)
        random = random_generator(scenario.seed, scenario.name, "replay")
        latest = max(self._recording.duration - self._speed * scenario.time_limit, 0.0)
        for _ in range(DRAWS):
            begin = float(random.uniform(0.0, latest))
            positions = self._make_people(self._walks_between(begin, begin), begin).positions
            if not (np.hypot(*(positions - (scenario.start.x, scenario.start.y)).T) < self._clear_start).any():
                return begin
        raise ImpossibleScenario(
            f"scenario {scenario.name}: at {DRAWS} times of the recording a person was within "
            f"{self._clear_start:g} m of the robot's start"
        )


def _walking_states(positions: NDArray[np.float64], velocities: NDArray[np.float64]) -> NDArray[np.int8]:
    speeds = np.hypot(velocities[..., 0], velocities[..., 1])
    return np.where(np.isfinite(positions[..., 0]), np.where(speeds < STANDS, STANDING, WALKING), ABSENT).astype(
        np.int8
    )
