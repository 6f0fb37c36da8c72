"""The people of N worlds: the crowd, and what the model remembers of each person."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from arena_core import Branches, Crowd, ImpossibleScenario, OccupancyGrid, PedestrianSpec, Scenario, stream_key
from arena_pedsim.people import MAX_CORNERS, PERSON
from arena_pedsim.routes.trips import Routes
from arena_pedsim.state_ids import NONE
from arena_pedsim.states.initial_crowd import initial_crowd
from arena_pedsim.states.person_defaults import CrowdDefaults


class Population:
    """N worlds with P slots for people each.

    ``people`` (N, P) is what the model remembers of them; all else is as in Routes.
    """

    def __init__(self, worlds: int) -> None:
        self.crowd = Crowd(
            np.zeros(worlds, np.int32),
            np.full((worlds, 0), -1, np.int32),
            np.full((worlds, 0, 2), np.nan),
            np.full((worlds, 0, 2), np.nan),
            np.zeros((worlds, 0)),
            np.full((worlds, 0), NONE, np.int8),
        )
        self.people = np.zeros((worlds, 0), PERSON)
        self.waypoints = np.zeros((worlds, 0, 1, 2))
        self.corners = np.zeros((worlds, 0, MAX_CORNERS, 2))
        self.legs = np.zeros((worlds, 0, 1, MAX_CORNERS, 2))
        self.leg_corners = np.full((worlds, 0, 1), -1, np.int32)

    @property
    def routes(self) -> Routes:
        """Where all of them walk, as kernels take it."""
        return Routes(self.waypoints, self.corners, self.legs, self.leg_corners)

    def __len__(self) -> int:
        return len(self.people)

    def begin_slots(self, slot: int, scenario: Scenario, grid: OccupancyGrid, customs: CrowdDefaults) -> None:
        """Put a scenario's people in a slot, in place of those who were there; raise ImpossibleScenario if
        a person starts in a wall.
        """
        begin = initial_crowd(customs, tuple(scenario.pedestrians))
        _check_starts(begin.specs, scenario, grid)
        self._make_room(len(begin.specs), begin.waypoints.shape[1])
        crowd, people = self.crowd, len(begin.specs)
        counts, ids, radii, states = crowd.counts.copy(), crowd.ids.copy(), crowd.radii.copy(), crowd.states.copy()
        positions, velocities = crowd.positions.copy(), crowd.velocities.copy()
        counts[slot] = people
        ids[slot], radii[slot], states[slot] = -1, 0.0, NONE
        positions[slot], velocities[slot] = np.nan, np.nan
        ids[slot, :people], radii[slot, :people], states[slot, :people] = begin.ids, begin.radii, begin.states
        positions[slot, :people], velocities[slot, :people] = begin.positions, begin.velocities
        self.people[slot, :people] = begin.people
        self.people["key"][slot] = stream_key(scenario.seed, scenario.name, "respawn")
        self.waypoints[slot, :people, : begin.waypoints.shape[1]] = begin.waypoints
        self.leg_corners[slot] = -1
        self.crowd = Crowd(counts, ids, positions, velocities, radii, states)

    def fork(self, branches: Branches) -> Population:
        """Return people of their own who go on from these."""
        forked, slots = Population(0), branches.slots
        forked.crowd, forked.people = self.crowd.take(slots), self.people[slots]
        forked.waypoints, forked.corners = self.waypoints[slots], self.corners[slots]
        forked.legs, forked.leg_corners = self.legs[slots], self.leg_corners[slots]
        forked.people["key"] ^= branches.streams[:, None]
        return forked

    def _make_room(self, people: int, waypoints: int) -> None:
        """Widen the arrays where these do not fit."""
        crowd, missing = self.crowd, max(people - self.people.shape[1], 0)
        if missing:
            self.crowd = Crowd(
                crowd.counts,
                _widen_array(crowd.ids, missing, -1),
                _widen_array(crowd.positions, missing, np.nan),
                _widen_array(crowd.velocities, missing, np.nan),
                _widen_array(crowd.radii, missing, 0.0),
                _widen_array(crowd.states, missing, NONE),
            )
            self.people = np.concatenate((self.people, np.zeros((len(self), missing), PERSON)), axis=1)
            self.corners = _widen_array(self.corners, missing, 0.0)
            self.waypoints = _widen_array(self.waypoints, missing, 0.0)
            self.legs = _widen_array(self.legs, missing, 0.0)
            self.leg_corners = _widen_array(self.leg_corners, missing, -1)
        more = max(waypoints - self.waypoints.shape[2], 0)
        if more:
            self.waypoints = _widen_array(self.waypoints, more, 0.0, axis=2)
            self.legs = _widen_array(self.legs, more, 0.0, axis=2)
            self.leg_corners = _widen_array(self.leg_corners, more, -1, axis=2)


def _widen_array(array: NDArray[Any], missing: int, value: float, axis: int = 1) -> NDArray[Any]:
    """Add empty slots: for people along axis 1, for waypoints along axis 2."""
    shape = (*array.shape[:axis], missing, *array.shape[axis + 1 :])
    return np.concatenate((array, np.full(shape, value, array.dtype)), axis=axis)


def _check_starts(specs: Sequence[PedestrianSpec], scenario: Scenario, grid: OccupancyGrid) -> None:
    cells = grid.cells(np.array([spec.position_xy for spec in specs]).reshape(-1, 2))
    inside = grid.contains(cells)
    free = inside.copy()
    free[inside] = ~grid.occupied[tuple(cells[inside].T)]
    for spec in (specs[i] for i in np.flatnonzero(~free).tolist()):
        where = "inside a wall or an obstacle" if grid.contains(grid.cells(spec.position_xy)) else "off the map"
        x, y = spec.position_xy
        raise ImpossibleScenario(f"scenario {scenario.name}: person {spec.id} starts at ({x:g}, {y:g}), {where}")
