"""People on their rounds: where they start and which waypoints they walk between."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from arena_core import ImpossibleScenario, PedestrianSpec
from arena_tasks.free_space import FreeSpace
from arena_tasks.trip import Placement, Trip

Points = NDArray[np.float64]
Propose = Callable[[int], Points]  # number of the waypoint in its round -> CANDIDATES positions

TRIES_A_PERSON = 100
CANDIDATES = 20  # for a waypoint
LEAST_LEG = 0.5  # m between two waypoints: shorter legs are standing still
APART = 0.1  # m between two people at the start, beyond their bodies
WANDER = 0.5  # m that a waypoint may lie beside its line


@dataclass(frozen=True, slots=True)
class WalkerRules:
    """How many people walk, where and how; ``clearance`` is what they need, ``keep_off`` their distance to start and goal, m.

    ``children`` and ``elders`` are shares of them; with ``respawn`` who ends the round comes again elsewhere.
    """

    count: int
    speed: float
    radius: float
    clearance: float
    keep_off: float
    waypoints_min: int
    waypoints_max: int
    placement: Placement
    crossing: float
    reach: float
    respawn: bool
    children: float
    elders: float


def draw_walkers(space: FreeSpace, trip: Trip, rules: WalkerRules, random: np.random.Generator) -> tuple[PedestrianSpec, ...]:
    """Draw everybody's round and place on it; raise ImpossibleScenario when somebody finds no place.

    All waypoints of a round are in sight of each other in turn, so that also people who walk straight ahead get round.
    """
    if rules.count and len(space.places(rules.clearance)) == 0:
        raise ImpossibleScenario(f"no cell is free with {rules.clearance:.2f} m around it for people; lower task.pedestrian_radius")
    people: list[PedestrianSpec] = []
    for number in range(rules.count):
        people.append(_draw_walker(number, people, space, trip, rules, random))
    return tuple(people)


def with_manners(people: Sequence[PedestrianSpec], rules: WalkerRules, random: np.random.Generator) -> tuple[PedestrianSpec, ...]:
    """Return the people with what the pedestrian model shall know of them beyond their rounds: who is no adult, who comes back."""
    again: dict[str, float | str] = {"respawn": "random"} if rules.respawn else {}
    shares = zip(people, random.random(len(people)), strict=True)
    return tuple(replace(person, behaviour={**again, **_type(share, rules)}) for person, share in shares)


def _type(share: float, rules: WalkerRules) -> dict[str, str]:
    if share < rules.children:
        return {"type": "child"}
    return {"type": "elder"} if share < rules.children + rules.elders else {}


def _draw_walker(
    number: int, others: list[PedestrianSpec], space: FreeSpace, trip: Trip, rules: WalkerRules, random: np.random.Generator
) -> PedestrianSpec:
    for attempt in range(TRIES_A_PERSON):
        stretch = (number / rules.count, (number + 1) / rules.count) if attempt < TRIES_A_PERSON // 2 else (0.0, 1.0)
        waypoints = _draw_round(_proposer(space, trip, rules, stretch, random), space, trip, rules, random)
        if len(waypoints) < 2:
            continue
        position = _on_round(waypoints, random)
        if _has_place(position, others, trip, rules):
            return PedestrianSpec(number, position, waypoints, rules.speed, rules.radius)
    raise ImpossibleScenario(
        f"person {number + 1} of {rules.count} found no place in {TRIES_A_PERSON} tries; lower task.pedestrians or task.pedestrian_radius"
    )


def _proposer(space: FreeSpace, trip: Trip, rules: WalkerRules, stretch: tuple[float, float], random: np.random.Generator) -> Propose:
    """Return where this person's waypoints are sought: along the robot's route, across it, or around any free cell."""
    if rules.placement == "anywhere":
        homes = space.places(rules.clearance)
        home = homes[random.integers(len(homes))]
        return lambda _: home + random.uniform(-rules.reach, rules.reach, (CANDIDATES, 2))
    home_length = trip.lengths[-1] * random.uniform(*stretch)
    crosses = random.random() < rules.crossing

    def propose(waypoint: int) -> Points:
        far = (-1.0) ** waypoint * rules.reach * random.random(CANDIDATES)  # one to this side, the next to the other
        near = random.uniform(-WANDER, WANDER, CANDIDATES)
        return trip.beside(home_length + near, far) if crosses else trip.beside(home_length + far, near)

    return propose


def _draw_round(propose: Propose, space: FreeSpace, trip: Trip, rules: WalkerRules, random: np.random.Generator) -> Points:
    """Return waypoints (K, 2) that are in sight of each other in turn, the last of the first; fewer than two mean failure."""
    wanted = int(random.integers(rules.waypoints_min, rules.waypoints_max + 1))
    found: list[Points] = []
    for number in range(wanted):
        neighbours = [found[-1], found[0]] if number == wanted - 1 and found else found[-1:]
        waypoint = _first_walkable(propose(number), neighbours, space, trip, rules)
        if waypoint is None:
            break
        found.append(waypoint)
    if len(found) > 2 and not space.is_visible(found[-1], found[0], rules.clearance):
        found = found[:2]
    return np.array(found).reshape(-1, 2)


def _first_walkable(candidates: Points, neighbours: list[Points], space: FreeSpace, trip: Trip, rules: WalkerRules) -> Points | None:
    possible = space.has_room(candidates, rules.clearance) & _keeps_off(candidates, trip, rules)
    for other in neighbours:
        possible &= np.hypot(*(candidates - other).T) >= LEAST_LEG
    for candidate in candidates[possible]:
        if all(space.is_visible(other, candidate, rules.clearance) for other in neighbours):
            return np.asarray(candidate)
    return None


def _keeps_off(positions: Points, trip: Trip, rules: WalkerRules) -> NDArray[np.bool_]:
    """Tell which positions (..., 2) are far enough from start and goal."""
    ends = np.array([(end.x, end.y) for end in (trip.start, trip.goal)])
    away = np.hypot(*np.moveaxis(positions[..., None, :] - ends, -1, 0))
    return np.asarray((away >= rules.keep_off).all(axis=-1))


def _on_round(waypoints: Points, random: np.random.Generator) -> Points:
    """Return a random place on a random leg of the round."""
    leg = int(random.integers(len(waypoints)))
    share = random.random()
    return np.asarray(waypoints[leg - 1] + share * (waypoints[leg] - waypoints[leg - 1]))


def _has_place(position: Points, others: list[PedestrianSpec], trip: Trip, rules: WalkerRules) -> bool:
    apart = 2.0 * rules.radius + APART
    return bool(_keeps_off(position, trip, rules)) and all(np.hypot(*(position - other.position_xy)) >= apart for other in others)
