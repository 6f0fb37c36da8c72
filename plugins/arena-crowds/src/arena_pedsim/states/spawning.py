"""Who is in the world: people who come later, and people who leave at the end of their round and come back."""

from __future__ import annotations

from math import isnan, nan
from typing import Any

import numpy as np
from numpy.typing import NDArray

from arena_core import ConfigurationError, PedestrianSpec
from arena_kernels.compiled import compiled
from arena_kernels.crowds import Crowds, Robots, RobotStack, bodies_of, robots_of
from arena_kernels.ground import Ground, GroundStack, wall_clearance, world_ground
from arena_kernels.random import uniform
from arena_pedsim.people import AT_RANDOM, AT_START, COME, LEAVE, NEVER, NEXT_WAYPOINT, NOTHING
from arena_pedsim.routes.trips import has_wishes
from arena_pedsim.state_ids import NONE, STANDING, WALKING

Floats = NDArray[np.float64]

PLACES = {0: NEVER, 1: AT_START, "start": AT_START, "random": AT_RANDOM}
AGAIN = 0.5  # s until the place is looked at again, or another is drawn


def init_spawning(person: np.void, spec: PedestrianSpec) -> bool:
    """Write into a person's memory when and where it comes; return whether it is there at the start.

    Raises ConfigurationError for an impossible ``spawn_time`` or ``respawn``.
    """
    wait, place = spec.behaviour.get("spawn_time", 0.0), spec.behaviour.get("respawn", 0)
    if not (isinstance(wait, int | float) and 0.0 <= wait < np.inf):
        raise ConfigurationError(f"person {spec.id}: spawn_time is {wait!r}; allowed: a number >= 0 (s)")
    if place not in PLACES:
        raise ConfigurationError(f"person {spec.id}: respawn is {place!r}; allowed: {', '.join(map(str, PLACES))}")
    person["absence"], person["respawn"] = wait, PLACES[place]
    if wait > 0.0:
        person["wish"] = NOTHING
    return not wait > 0.0


@compiled
def spawn_and_despawn(
    crowds: Crowds,
    people: NDArray[np.void],
    waypoints: Floats,
    robots: RobotStack,
    land: GroundStack,
    parameters: NDArray[np.void],
) -> None:
    """Let everybody who wishes for it leave, or come where there is room."""
    for world in range(len(crowds.counts)):
        if not has_wishes(people[world], crowds.counts[world]):
            continue
        positions, velocities, radii, states = bodies_of(crowds, world)
        team, ground = robots_of(robots, world), world_ground(land, world)
        for i in range(len(positions)):
            person = people[world, i]
            if person.wish == LEAVE:
                person.wish, person.absence, states[i] = NOTHING, parameters[0].spawning_pause, NONE
                positions[i, 0], positions[i, 1] = nan, nan
                velocities[i, 0], velocities[i, 1] = nan, nan
            elif person.wish == COME:
                person.wish, person.absence = NOTHING, AGAIN
                x, y, before = _spawn_place(person, waypoints[world, i], i)
                near = _is_near_robot((x, y, radii[i]), team, parameters[0].spawning_robot_distance)
                if near or not _is_free((x, y, radii[i]), before, ground, positions, radii):
                    continue
                positions[i, 0], positions[i, 1] = x, y
                velocities[i, 0], velocities[i, 1] = 0.0, 0.0
                person.absence, person.waypoint, person.sees_robot = 0.0, before, 0
                person.interest_left, person.pause_left = person.interest, 0.0
                states[i], person.wish = (WALKING, NEXT_WAYPOINT) if person.waypoints > 0 else (STANDING, NOTHING)


@compiled
def _is_near_robot(disc: tuple[float, float, float], robots: Robots, distance: float) -> bool:
    """Return whether a body would be nearer than this to a robot."""
    x, y, radius = disc
    for place in range(len(robots.radii)):
        away = distance + robots.radii[place] + radius
        if (robots.poses[place, 0] - x) ** 2 + (robots.poses[place, 1] - y) ** 2 < away * away:
            return True
    return False


@compiled
def _spawn_place(person: Any, waypoints: Floats, i: int) -> tuple[float, float, int]:
    """Return where a person comes, and which waypoint that is: -1 for the start."""
    if person.respawn != AT_RANDOM or person.waypoint < 0:
        return person.start_x, person.start_y, -1
    drawn = int(uniform(person.key, person.draws, i) * person.waypoints)
    person.draws += 1
    return waypoints[drawn, 0], waypoints[drawn, 1], drawn


@compiled
def _is_free(disc: tuple[float, float, float], waypoint: int, ground: Ground, positions: Floats, radii: Floats) -> bool:
    """Return whether a body would touch neither people nor, at a waypoint, walls."""
    x, y, radius = disc
    if waypoint >= 0 and wall_clearance(ground, x, y) < radius:
        return False
    for j in range(len(positions)):
        if (
            not isnan(positions[j, 0])
            and (positions[j, 0] - x) ** 2 + (positions[j, 1] - y) ** 2 < (radius + radii[j]) ** 2
        ):
            return False
    return True
