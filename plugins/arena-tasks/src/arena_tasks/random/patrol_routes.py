"""The rounds that people walk: waypoints metres apart, joined by ways round walls."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from arena_core import OccupancyGrid
from arena_tasks.random.free_space import FreeSpace
from arena_tasks.random.trip import Placement, Trip
from arena_tasks.random_parameters import RoundParameters

Points = NDArray[np.float64]
Mask = NDArray[np.bool_]

SPACING = 0.2  # m between the places that waypoints are drawn among: finer ones change no round
FEWEST = 200  # places below which every free cell is one
SNAP = 1.0  # m from a place on the robot's way to one where a person has room, at most
NEAR = 0.75  # share of leg_max within which both ends of a crossing lie from where it is
SHRINKING = 0.5  # of the greatest distance there is, in a region too small for leg_min


@dataclass(frozen=True, slots=True, eq=False)
class WalkableFloor:
    """Where people may have waypoints: ``places`` (N, 2) m, connected with each other where their
    ``labels`` (N,) are equal.
    """

    places: Points
    labels: NDArray[np.int32]

    def nearest_place(self, point: Points) -> int | None:
        """Return the number of the place nearest to a point; None when it is too far off."""
        away = self.distances_to(point)
        nearest = int(np.argmin(away))
        return nearest if away[nearest] <= SNAP else None

    def distances_to(self, point: Points) -> Points:
        """Return how far each place is from a point, m."""
        return np.asarray(np.hypot(*(self.places - point).T))

    def without_places(self, banned: Mask) -> WalkableFloor:
        """Return the floor without some of its places."""
        return WalkableFloor(self.places[~banned], self.labels[~banned])


@dataclass(frozen=True, slots=True)
class WalkableFloorOf:
    """A key and function for ``grid.derive``: the floor for bodies that need this much clearance."""

    clearance: float

    def __call__(self, grid: OccupancyGrid) -> WalkableFloor:
        """Return the places, thinned where there are many."""
        space = grid.derive(FreeSpace)
        cells = np.argwhere(space.clearance >= self.clearance)
        every = max(round(SPACING / grid.resolution), 1)
        thinned = cells[(cells % every == 0).all(axis=1)]
        cells = thinned if len(thinned) >= FEWEST else cells
        return WalkableFloor(grid.positions(cells).reshape(-1, 2), space.regions(self.clearance)[tuple(cells.T)])


@dataclass(frozen=True, slots=True, eq=False)
class RouteDraw:
    """What rounds are drawn from: the floor, the robot's trip, and rules.

    With ``placement`` ``along_route`` a share ``meeting`` of the rounds comes to the robot's way.
    """

    floor: WalkableFloor
    trip: Trip
    rules: RoundParameters
    placement: Placement
    random: np.random.Generator


def draw_patrol_route(draw: RouteDraw, stretch: tuple[float, float]) -> Points:
    """Return waypoints (K, 2) in the order in which they are walked, again and again; fewer than two mean failure.

    ``stretch`` says between which shares of the robot's way a round comes to it, if it does.
    """
    floor, rules, random = draw.floor, draw.rules, draw.random
    wanted = int(random.integers(rules.waypoints_min, rules.waypoints_max + 1))
    meets = draw.placement == "along_route" and random.random() < rules.meeting
    crosses, turns_back = random.random() < rules.crossing, random.random() < rules.to_and_fro
    if not meets:
        found = [int(random.integers(len(floor.places)))]
    else:
        length = draw.trip.lengths[-1] * random.uniform(*stretch)
        found = _crossing_places(draw, length, wanted) if crosses else _places_along(draw, length)
    while found and len(found) < wanted:
        found = _with_another(draw, found)
    stops = floor.places[found]
    return np.concatenate((stops, stops[-2:0:-1])) if turns_back else stops


def _crossing_places(draw: RouteDraw, length: float, wanted: int) -> list[int]:
    """Return places on one side of the robot's way, on it (where there are to be three) and on the other side."""
    floor, trip, rules, random = draw.floor, draw.trip, draw.rules, draw.random
    home_xy, ahead = trip.at(np.array(length)), trip.route_direction(length)
    home = floor.nearest_place(home_xy)
    if home is None:
        return []
    offsets = floor.places - home_xy
    along, across, away = offsets @ ahead, offsets @ np.array((-ahead[1], ahead[0])), np.hypot(*offsets.T)
    same, beside = floor.labels == floor.labels[home], np.abs(across) > np.abs(along)
    near = same & (away <= NEAR * rules.leg_max)
    first = _one_of(random, near & beside & (away >= (1.0 - NEAR) * rules.leg_min), near)
    if first is None:
        return []
    leg, opposite = same & _segment_mask(floor.distances_to(floor.places[first]), rules), across * across[first] < 0.0
    second = _one_of(random, leg & near & beside & opposite, leg & opposite, leg)
    if second is None:
        return [first]
    return [first, home, second] if wanted > 2 else [first, second]


def _places_along(draw: RouteDraw, length: float) -> list[int]:
    """Return two places on the robot's way."""
    floor, trip, rules = draw.floor, draw.trip, draw.rules
    first = floor.nearest_place(trip.at(np.array(length)))
    if first is None:
        return []
    away = np.hypot(*(trip.route_xy - floor.places[first]).T)
    on_route = _one_of(draw.random, (away >= rules.leg_min) & (away <= rules.leg_max))
    second = None if on_route is None else floor.nearest_place(trip.route_xy[on_route])
    return [first] if second is None or floor.labels[second] != floor.labels[first] else [first, second]


def _with_another(draw: RouteDraw, found: list[int]) -> list[int]:
    """Return the places with one more, a leg from the last; none when there is none anywhere."""
    floor, rules, random = draw.floor, draw.rules, draw.random
    same, away = floor.labels == floor.labels[found[-1]], floor.distances_to(floor.places[found[-1]])
    another = _one_of(random, same & _segment_mask(away, rules))
    if another is None:  # a region too small
        within = np.where(same, away, 0.0)
        another = _one_of(random, (within > 0.0) & (within >= SHRINKING * within.max()))
    return [] if another is None else [*found, another]


def _segment_mask(away: Points, rules: RoundParameters) -> Mask:
    """Tell which places are a leg off, by how far they are, m."""
    return np.asarray((away >= rules.leg_min) & (away <= rules.leg_max))


def _one_of(random: np.random.Generator, *masks: Mask) -> int | None:
    """Return one of the numbers that the first mask with any has; None when none has."""
    for mask in masks:
        numbers = np.flatnonzero(mask)
        if len(numbers):
            return int(numbers[random.integers(len(numbers))])
    return None
