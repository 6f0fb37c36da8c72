"""People on their rounds: where they start and which waypoints they walk between, alone or in groups."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from arena_core import ImpossibleScenario, PedestrianSpec
from arena_kernels.shortest_path import ShortestPaths, place_on_patrol
from arena_tasks.random.free_space import FreeSpace
from arena_tasks.random.patrol_routes import RouteDraw, WalkableFloorOf, draw_patrol_route
from arena_tasks.random.trip import Placement, Trip
from arena_tasks.random_parameters import GroupParameters, PeopleParameters, RoundParameters

Points = NDArray[np.float64]

TRIES_A_PERSON = 100
STARTS = 10  # places on a round that are tried
APART = 0.1  # m between two people at the start, beyond their bodies
BESIDE = 0.8  # m between the centres of two who walk together (Moussaid et al. 2010)
SIDES = 12  # directions in which a companion's place is sought


@dataclass(frozen=True, slots=True)
class WalkerRules:
    """How many people walk, where and how; ``clearance`` is what they need, ``keep_off`` their
    distance to start and goal, m.
    """

    count: int
    clearance: float
    keep_off: float
    people: PeopleParameters
    groups: GroupParameters
    rounds: RoundParameters
    placement: Placement


def draw_walkers(
    space: FreeSpace, trip: Trip, rules: WalkerRules, random: np.random.Generator
) -> tuple[PedestrianSpec, ...]:
    """Draw everybody's round and place on it; raise ImpossibleScenario when a person finds no place.

    All waypoints of a round lie where a body has room, and ways with room join them in turn, the last with the first.
    """
    if not rules.count:
        return ()
    floor = space.grid.derive(WalkableFloorOf(rules.clearance))
    floor = floor.without_places(~_keeps_off(floor.places, trip, rules))
    if len(floor.places) == 0:
        raise ImpossibleScenario(
            f"no cell is free with {rules.clearance:.2f} m around it for people; lower task.people.radius"
        )
    sizes = _party_sizes(rules, random)
    people: list[PedestrianSpec] = []
    rounds, ground = RouteDraw(floor, trip, rules.rounds, rules.placement, random), _Ground(space, trip, rules)
    for number, size in enumerate(sizes):
        people += _draw_party(_Party(number, size, len(sizes)), people, ground, rounds)
    return tuple(people)


@dataclass(frozen=True, slots=True)
class _Party:
    """So many who walk together, one of some parties."""

    number: int
    size: int
    parties: int


@dataclass(frozen=True, slots=True, eq=False)
class _Ground:
    """Where people may stand: in free space, off the ends of the robot's trip."""

    space: FreeSpace
    trip: Trip
    rules: WalkerRules

    def has_place(self, position: Points, taken: list[Points]) -> bool:
        """Return whether a person may stand there, apart from others."""
        rules, apart = self.rules, 2.0 * self.rules.people.radius + APART
        free = bool(_keeps_off(position, self.trip, rules)) and bool(self.space.has_room(position, rules.clearance))
        return free and all(np.hypot(*(position - other)) >= apart for other in taken)


def _party_sizes(rules: WalkerRules, random: np.random.Generator) -> list[int]:
    """Return how many walk together, 1 for who walks alone, in the order in which they are drawn."""
    together, sizes = round(rules.groups.share * rules.count), list[int]()
    least = rules.groups.size_min
    while together >= least:
        possible = range(least, min(rules.groups.size_max, together) + 1)
        leaving_none_alone = [size for size in possible if together - size == 0 or together - size >= least]
        sizes.append(int(random.choice(leaving_none_alone or possible)))
        together -= sizes[-1]
    return sizes + [1] * (rules.count - sum(sizes))


def _draw_party(
    party: _Party, others: list[PedestrianSpec], ground: _Ground, rounds: RouteDraw
) -> list[PedestrianSpec]:
    rules, number, parties = ground.rules, party.number, party.parties
    ways = ground.space.grid.derive(ShortestPaths)
    for attempt in range(TRIES_A_PERSON):
        stretch = (number / parties, (number + 1) / parties) if attempt < TRIES_A_PERSON // 2 else (0.0, 1.0)
        waypoints = draw_patrol_route(rounds, stretch)
        legs = ways.patrol_paths(waypoints, rules.people.radius) if len(waypoints) > 1 else []
        for share in rounds.random.random(STARTS) if legs else ():
            start, leg = place_on_patrol(legs, float(share))
            places = _party_places(start, party.size, others, ground)
            if len(places) == party.size:
                return _make_party(places, np.roll(waypoints, -leg, axis=0), number, len(others), rules)
    raise ImpossibleScenario(
        f"person {len(others) + 1} of {rules.count} found no place in {TRIES_A_PERSON} tries; "
        "lower task.pedestrians or task.people.radius"
    )


def _make_party(
    places: list[Points], waypoints: Points, number: int, first: int, rules: WalkerRules
) -> list[PedestrianSpec]:
    """Return people who walk the same round, the next waypoint first."""
    together: dict[str, float | str] = {"group": number} if len(places) > 1 else {}
    return [
        PedestrianSpec(first + k, place, waypoints, rules.people.speed, rules.people.radius, together)
        for k, place in enumerate(places)
    ]


def _party_places(start: Points, size: int, others: list[PedestrianSpec], ground: _Ground) -> list[Points]:
    """Return the start and, for who walks together, places around it; fewer than ``size`` where there is no room."""
    angles = 2.0 * np.pi * np.arange(SIDES) / SIDES
    around = start + BESIDE * np.stack((np.cos(angles), np.sin(angles)), axis=1)
    taken, places = [other.position_xy for other in others], list[Points]()
    for place in [start, *around]:
        seen = ground.has_place(place, [*taken, *places])
        if seen and ground.space.is_visible(start, place, ground.rules.people.radius):
            places.append(place)
        if not places or len(places) == size:
            break
    return places


def _keeps_off(positions: Points, trip: Trip, rules: WalkerRules) -> NDArray[np.bool_]:
    """Tell which positions (..., 2) are far enough from start and goal."""
    ends = np.array([(end.x, end.y) for end in (trip.start, trip.goal)])
    away = np.hypot(*np.moveaxis(positions[..., None, :] - ends, -1, 0))
    return np.asarray((away >= rules.keep_off).all(axis=-1))
