"""Who walks in N worlds, and what is remembered of each: waypoints, the present way, clocks."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from arena_core import Branches, ImpossibleScenario, OccupancyGrid, Pedestrians, PedestrianSpec, Scenario, stream_key
from arena_crowds.slots import grow_array, no_crowd, with_worlds

STANDING, WALKING = 1, 2  # states; ABSENT is 0
NOTHING, NEXT_WAYPOINT, NEW_ROUTE = 0, 1, 2  # what a person wishes of the route search
MAX_CORNERS = 24  # of one route; a longer one is searched again on arrival at the last of them

WALKER = np.dtype(
    [
        ("desired_speed", np.float64),
        ("goal_x", np.float64),  # where the present waypoint can be reached
        ("goal_y", np.float64),
        ("look_clock", np.float64),  # s since the way ahead was looked at
        ("stuck_clock", np.float64),  # s since the person was at (anchor_x, anchor_y)
        ("anchor_x", np.float64),
        ("anchor_y", np.float64),
        ("waypoint", np.int64),  # index of the present waypoint
        ("waypoints", np.int64),  # number of them
        ("corner", np.int64),  # index of the next corner of the route; ``corners`` of them, then comes the goal
        ("corners", np.int64),
        ("waiting", np.int64),  # 1: the route leads through a door that is closed
        ("wish", np.int64),
        ("stay_chance", np.float64),  # that the person stays at a waypoint, and for how long on average, s
        ("stay_time", np.float64),
        ("stay", np.float64),  # s at the present waypoint, once it is reached
        ("legs", np.int64),  # number of waypoints walked to so far
        ("key", np.uint64),  # of the draws of stays
    ],
    align=True,
)


class Walkers:
    """N worlds with P places: ``crowd``, ``memory`` (N, P), ``waypoints`` (N, P, W, 2) m and ``corners``
    (N, P, C, 2) m of routes.
    """

    def __init__(self, worlds: int) -> None:
        self.crowd = no_crowd(worlds)
        self.memory = np.zeros((worlds, 0), WALKER)
        self.waypoints = np.zeros((worlds, 0, 1, 2))
        self.corners = np.zeros((worlds, 0, MAX_CORNERS, 2))

    def __len__(self) -> int:
        return len(self.memory)

    def begin_slots(self, scenarios: Mapping[int, Scenario], grids: Sequence[OccupancyGrid]) -> None:
        """Put the people of scenarios in their slots; raise ImpossibleScenario if a person starts
        in a wall or off the map.
        """
        for scenario, grid in zip(scenarios.values(), grids, strict=True):
            _check_starts(scenario, grid)
        self.crowd = with_worlds(
            self.crowd, {slot: _resting_people(scenario.pedestrians) for slot, scenario in scenarios.items()}
        )
        places = self.crowd.ids.shape[1]
        longest = max(
            (len(spec.waypoints_xy) for scenario in scenarios.values() for spec in scenario.pedestrians), default=0
        )
        self.memory = grow_array(self.memory, places, np.zeros((), WALKER))
        self.waypoints = grow_array(grow_array(self.waypoints, places, 0.0), longest, 0.0, axis=2)
        self.corners = grow_array(self.corners, places, 0.0)
        for slot, scenario in scenarios.items():
            for place, spec in enumerate(scenario.pedestrians):
                self._remember_walker(slot, place, spec)
            self.memory["key"][slot] = stream_key(scenario.seed, scenario.name, "stays")

    def fork(self, branches: Branches) -> Walkers:
        """Return walkers of their own that go on from these."""
        forked, slots = Walkers(0), branches.slots
        forked.crowd, forked.memory = self.crowd.take(slots), self.memory[slots]
        forked.waypoints, forked.corners = self.waypoints[slots], self.corners[slots]
        forked.memory["key"] ^= branches.streams[:, None]
        return forked

    def _remember_walker(self, slot: int, place: int, spec: PedestrianSpec) -> None:
        count = len(spec.waypoints_xy)
        self.memory[slot, place] = np.zeros((), WALKER)
        walker = self.memory[slot, place]
        walker["desired_speed"], walker["waypoints"], walker["waypoint"] = spec.desired_speed, count, -1
        walker["goal_x"], walker["goal_y"] = walker["anchor_x"], walker["anchor_y"] = spec.position_xy
        walker["wish"] = NEXT_WAYPOINT if count else NOTHING
        walker["stay_chance"], walker["stay_time"] = (
            float(spec.behaviour.get(key, 0.0)) for key in ("pause_probability", "pause_time")
        )
        self.waypoints[slot, place, :count] = spec.waypoints_xy


def _resting_people(specs: Sequence[PedestrianSpec]) -> Pedestrians:
    """Return people at their starts, at rest."""
    positions = np.array([spec.position_xy for spec in specs], np.float64).reshape(-1, 2)
    states = np.array([WALKING if len(spec.waypoints_xy) else STANDING for spec in specs], np.int8)
    ids: NDArray[np.int32] = np.array([spec.id for spec in specs], np.int32)
    return Pedestrians(
        ids, positions, np.zeros_like(positions), np.array([spec.radius for spec in specs], np.float64), states
    )


def _check_starts(scenario: Scenario, grid: OccupancyGrid) -> None:
    for spec in scenario.pedestrians:
        cell = grid.cells(spec.position_xy)
        inside = bool(grid.contains(cell))
        if not inside or grid.occupied[tuple(cell)]:
            (x, y), where = spec.position_xy, "inside a wall or an obstacle" if inside else "off the map"
            raise ImpossibleScenario(f"scenario {scenario.name}: person {spec.id} starts at ({x:g}, {y:g}), {where}")
