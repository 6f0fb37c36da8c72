"""Static obstacles that are on no map: where they stand, so that the robot still gets through."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from arena_core import ImpossibleScenario, Obstacle
from arena_core.scenes import add_obstacles
from arena_tasks.random.free_space import FreeSpace
from arena_tasks.random.trip import Placement, Trip
from arena_tasks.random_parameters import ObstacleParameters

TRIES_AN_OBSTACLE = 100
CORNERS = (3, 7)  # of a polygon: from the first to below the second
SKEW = 0.35  # of the angle between two corners that each may be off: polygons differ, and none becomes a sliver


@dataclass(frozen=True, slots=True)
class ObstacleRules:
    """How many obstacles stand where; lengths in m.

    ``keep_off`` is free between an obstacle and the robot's start and goal, ``passage`` what the robot needs on its
    way.
    """

    wanted: ObstacleParameters
    placement: Placement
    keep_off: float
    passage: float


def draw_obstacles(
    space: FreeSpace, trip: Trip, rules: ObstacleRules, random: np.random.Generator
) -> tuple[tuple[Obstacle, ...], Trip]:
    """Draw obstacles and return them with the trip, whose route leads round them; raise
    ImpossibleScenario when one finds no place.
    """
    obstacles: list[Obstacle] = []
    circles = np.empty((0, 3))
    for number in range(rules.wanted.count):
        for _ in range(TRIES_AN_OBSTACLE):
            circle = _draw_circle(space, trip, rules, random)
            if not _has_place(circle, circles, space, trip, rules):
                continue
            obstacle = _draw_shape(circle, rules, random)
            onward = _reroute_trip(trip, circle, [*obstacles, obstacle], space, rules)
            if onward is not None:
                break
        else:
            raise ImpossibleScenario(
                f"obstacle {number + 1} of {rules.wanted.count} found no place in {TRIES_AN_OBSTACLE} tries; "
                "lower task.obstacles.count or task.obstacles.radius_max"
            )
        trip, circles = onward, np.vstack((circles, circle))
        obstacles.append(obstacle)
    return tuple(obstacles), trip


def _draw_circle(
    space: FreeSpace, trip: Trip, rules: ObstacleRules, random: np.random.Generator
) -> NDArray[np.float64]:
    """Draw the circle (x, y, radius) that holds an obstacle: beside the robot's route, or around any free cell."""
    radius = random.uniform(rules.wanted.radius_min, rules.wanted.radius_max)
    if rules.placement == "along_route":
        along, across = (
            random.uniform(0.0, trip.lengths[-1], 1),
            random.uniform(-rules.wanted.reach, rules.wanted.reach, 1),
        )
        return np.array((*trip.positions_beside(along, across)[0], radius))
    places = space.places(0.0)
    return np.array((*places[random.integers(len(places))], radius))


def _has_place(
    circle: NDArray[np.float64], others: NDArray[np.float64], space: FreeSpace, trip: Trip, rules: ObstacleRules
) -> np.bool_ | bool:
    """Return whether an obstacle stands on free ground, off the others and off both ends of the trip."""
    ends = np.array([(end.x, end.y, rules.keep_off) for end in (trip.start, trip.goal)])
    kept_off = np.vstack((others, ends))
    gaps = np.hypot(*(kept_off[:, :2] - circle[:2]).T) - kept_off[:, 2] - circle[2]
    return bool(space.has_room(circle[:2], circle[2])) and (gaps >= 0.0).all()


def _draw_shape(circle: NDArray[np.float64], rules: ObstacleRules, random: np.random.Generator) -> Obstacle:
    """Draw a disc, or a convex polygon with its corners on the circle."""
    if random.random() >= rules.wanted.polygons:
        return Obstacle(circle[None, :2], circle[2].item())
    corners = int(random.integers(*CORNERS))
    turns = (np.arange(corners) + random.uniform(-SKEW, SKEW, corners) + random.random()) / corners
    return Obstacle(
        circle[:2] + circle[2] * np.stack((np.cos(2.0 * np.pi * turns), np.sin(2.0 * np.pi * turns)), axis=1)
    )


def _reroute_trip(
    trip: Trip, circle: NDArray[np.float64], obstacles: Sequence[Obstacle], space: FreeSpace, rules: ObstacleRules
) -> Trip | None:
    """Return the trip among obstacles, of which the last one is new in ``circle``; None where it leaves no way."""
    if (np.hypot(*(trip.route_xy - circle[:2]).T) - circle[2] >= rules.passage + space.grid.resolution).all():
        return trip
    return trip.reroute_on(add_obstacles(space.grid, obstacles), rules.passage)
