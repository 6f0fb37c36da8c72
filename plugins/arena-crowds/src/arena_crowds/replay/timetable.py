"""What moves by a timetable: each is where its stamps say, round after round, whatever robots do."""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy

import numpy as np
from numpy.typing import NDArray

from arena_core import (
    ABSENT,
    Branches,
    Crowd,
    PedestrianModel,
    Pedestrians,
    PedestrianSpec,
    RobotBatch,
    Scenario,
    random_generator,
)
from arena_core.parameters import NonNegative
from arena_crowds.replay.gliding import Timetables, ground_under, hide_in_walls, pack_timetables, sample_timetables
from arena_crowds.slots import no_crowd, with_worlds
from arena_kernels.ground import Ground

STANDING, WALKING = 1, 2
STANDS = 0.1  # m/s: who is slower stands, more or less


class TimetableCrowd(PedestrianModel):
    """Scenarios' people with ``stamps``; at the end of its round each jumps to where that began. Who has none walks its
    waypoints.

    Who would reach into a wall is absent: it comes out of walls and goes into them.
    An episode begins at ``start_time`` s of all timetables; None draws it for each scenario, up to ``latest`` s.
    """

    meets_teams = True

    def __init__(self, start_time: NonNegative | None, latest: NonNegative) -> None:
        self._start_time, self._latest = start_time, latest
        self._clear_worlds(0)

    def _clear_worlds(self, total: int) -> None:
        """Empty all worlds. ``_times`` (N,) are the seconds since each episode began."""
        self._crowd = no_crowd(total)
        self._tables: list[Timetables] = [pack_timetables((), 0.0)] * total
        self._grounds: list[Ground | None] = [None] * total
        self._times = np.zeros(total)

    def reset(self, slots: NDArray[np.int64], scenarios: Sequence[Scenario], total: int) -> Crowd:
        """Begin ``scenarios`` in these slots, at their times of the timetables."""
        if total != len(self._times):
            self._clear_worlds(total)
        worlds = {}
        for slot, scenario in zip(slots.tolist(), scenarios, strict=True):
            self._tables[slot] = pack_timetables(scenario.pedestrians, self._start_of(scenario))
            self._grounds[slot] = scenario.world.grid.derive(ground_under)
            self._times[slot] = 0.0
            radii = np.array([spec.radius for spec in scenario.pedestrians], np.float64)
            worlds[slot] = _make_people(scenario.pedestrians, radii, *self._current_motion(slot, radii, 0.0))
        self._crowd = with_worlds(self._crowd, worlds)
        return self._crowd

    def step(self, crowd: Crowd, robots: RobotBatch, ticks: NDArray[np.int64], dt: float) -> Crowd:
        """Return where timetables say that all are ``dt`` seconds later; who began again in between is absent."""
        self._times = self._times + dt
        positions, velocities = np.full_like(crowd.positions, np.nan), np.full_like(crowd.positions, np.nan)
        for slot, count in enumerate(crowd.counts.tolist()):
            positions[slot, :count], velocities[slot, :count] = self._current_motion(
                slot, crowd.radii[slot, :count], dt
            )
        self._crowd = Crowd(
            crowd.counts, crowd.ids, positions, velocities, crowd.radii, _walking_states(positions, velocities)
        )
        return self._crowd

    def fork(self, branches: Branches) -> TimetableCrowd:
        """Return a crowd of its own that goes on from this one; nothing is drawn on the way."""
        forked, slots = copy(self), branches.slots
        vars(forked).update(
            _crowd=self._crowd.take(slots),
            _tables=[self._tables[slot] for slot in slots],
            _grounds=[self._grounds[slot] for slot in slots],
            _times=self._times[slots],
        )
        return forked

    def _current_motion(
        self, slot: int, radii: NDArray[np.float64], dt: float
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return positions and velocities, each (P, 2), in one world; NaN for who is absent."""
        positions, velocities = sample_timetables(self._tables[slot], self._times[slot], dt)
        ground = self._grounds[slot]
        if ground is not None:
            hide_in_walls(ground, radii, positions, velocities)
        return positions, velocities

    def _start_of(self, scenario: Scenario) -> float:
        if self._start_time is not None:
            return float(self._start_time)
        return float(random_generator(scenario.seed, scenario.name, "timetable").uniform(0.0, self._latest))


def _make_people(
    specs: Sequence[PedestrianSpec],
    radii: NDArray[np.float64],
    positions: NDArray[np.float64],
    velocities: NDArray[np.float64],
) -> Pedestrians:
    ids = np.array([spec.id for spec in specs], np.int32)
    return Pedestrians(ids, positions, velocities, radii, _walking_states(positions, velocities))


def _walking_states(positions: NDArray[np.float64], velocities: NDArray[np.float64]) -> NDArray[np.int8]:
    speeds = np.hypot(velocities[..., 0], velocities[..., 1])
    return np.where(np.isfinite(positions[..., 0]), np.where(speeds < STANDS, STANDING, WALKING), ABSENT).astype(
        np.int8
    )
