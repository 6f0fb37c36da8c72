"""The halls of the pack: a warehouse, an office floor and a square, with slow people about the robot's way."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from arena_scenarios.floor import RESOLUTION, Floor
from arena_scenarios.problems import RADIUS, Person, Point, Problem
from arena_scenarios.situations import is_spaced

Random = np.random.Generator
Route = tuple[Point, ...]
SPEED = 0.3  # m/s (paper)
ROOM = RADIUS + 0.1  # m, free on both sides of everybody's round
TRIES = 600
KIOSKS = (
    (9.3, 3.4, 1.5),
    (15.2, 5.6, 1.2),
    (1.4, 8.2, 1.1),
    (5.2, 6.6, 1.3),
    (12.9, 9.6, 1.4),
    (7.1, 11.1, 1.2),
    (10.7, 12.9, 1.0),
)
PLANTERS = ((2.6, 3.9, 0.9), (5.9, 1.9, 0.6), (13.6, 2.1, 0.8), (9.9, 8.3, 0.7), (3.3, 11.8, 0.8), (15.4, 13.2, 0.9))


def warehouse_floor() -> Floor:
    """Draw two rows of five racks, whose bays stand back by different depths, so that an aisle looks
    different along its length.
    """
    floor = Floor(20.0, 20.0)
    floor.room(0.0, 0.0, 20.0, 20.0)
    for rack, x in enumerate((2.6, 6.2, 9.8, 13.4, 17.0)):
        for row, y in enumerate((2.4, 11.2)):
            for bay in range(4):
                recess = 0.05 * ((3 * rack + 5 * row + 2 * bay) % 5)
                floor.block(
                    x + recess, y + 1.6 * bay, x + 1.2 - 0.05 * ((rack + 2 * row + 3 * bay) % 4), y + 1.6 * (bay + 1)
                )
    return floor


def indoor_floor() -> Floor:
    """Draw a corridor of 2.4 m between eight rooms with doors of 1.3 m and some furniture."""
    floor = Floor(18.0, 15.0)
    floor.room(0.0, 6.3, 18.0, 8.7)
    for number, x in enumerate((0.0, 4.6, 9.2, 13.8)):
        floor.room(x, 0.0, x + 4.2, 6.1)
        floor.room(x, 8.9, x + 4.2, 15.0)
        door = x + 1.0 + 0.5 * number
        floor.room(door, 6.1, door + 1.3, 6.3)
        floor.room(4.2 + x - (door - x) - 1.3, 8.7, 4.2 + x - (door - x), 8.9)
        floor.block(x + 0.4 * number, 0.0, x + 0.4 * number + 1.2, 0.6)
        floor.block(x, 10.4 + 0.7 * number, x + 0.5, 11.6 + 0.7 * number)
    floor.pilasters(6.3, 0.15, (0.3, 4.2, 8.7, 13.4))
    floor.pilasters(8.7, -0.15, (3.1, 4.4, 9.0, 12.8, 17.2))
    return floor


def outdoor_floor() -> Floor:
    """Draw a square with kiosks, planters and benches."""
    floor = Floor(18.0, 18.0)
    floor.room(0.0, 0.0, 18.0, 18.0)
    for x, y, size in (*KIOSKS, *PLANTERS):
        floor.block(x, y, x + size, y + size)
    for x, y in ((1.9, 15.1), (5.6, 14.9), (8.4, 15.8), (13.2, 15.9), (16.6, 9.3), (7.6, 8.9), (12.2, 6.2)):
        floor.block(x, y, x + 1.4, y + 0.4)
    return floor


# by name: the floor plan, and the robot's likely way in each variation
HALLS: dict[str, tuple[Callable[[], Floor], tuple[Route, ...]]] = {
    "warehouse": (
        warehouse_floor,
        (
            ((1.3, 3.5), (1.3, 10.0), (12.2, 10.0), (12.2, 16.0)),
            ((15.8, 16.5), (15.8, 10.0), (5.0, 10.0), (5.0, 4.0)),
            ((5.0, 4.5), (5.0, 1.2), (15.8, 1.2), (15.8, 5.5)),
            ((12.2, 4.0), (12.2, 10.0), (8.6, 10.0), (8.6, 17.0)),
            ((18.6, 10.0), (1.3, 10.0), (1.3, 15.0)),
        ),
    ),
    "indoor": (
        indoor_floor,
        (
            ((3.4, 2.2), (1.7, 6.2), (2.6, 7.5), (14.8, 7.5), (14.9, 8.8), (16.2, 12.4)),
            ((16.4, 2.2), (16.9, 6.2), (15.2, 7.5), (3.5, 7.5), (2.5, 8.8), (2.6, 13.2)),
            ((7.4, 2.6), (6.8, 6.2), (7.6, 7.5), (15.5, 7.5), (16.9, 6.2), (15.6, 3.0)),
            ((11.8, 12.2), (10.7, 8.8), (9.6, 7.5), (3.0, 7.5), (1.7, 6.2), (2.9, 3.0)),
            ((1.2, 7.5), (15.0, 7.5)),
        ),
    ),
    "outdoor": (
        outdoor_floor,
        (
            ((1.2, 1.2), (16.6, 16.6)),
            ((16.8, 1.4), (1.2, 13.8)),
            ((9.0, 1.2), (9.2, 14.8)),
            ((1.0, 10.4), (16.9, 11.8)),
            ((4.2, 16.4), (14.4, 4.4)),
        ),
    ),
}


def hall_problem(floor: Floor, route: Route, people: int, random: Random) -> Problem:
    """Return a problem whose people walk to and fro across the robot's way and along it, each
    about a stretch of its own.
    """
    clearance = ndimage.distance_transform_edt(np.pad(floor.free, 1))[1:-1, 1:-1] * RESOLUTION
    heading = float(np.arctan2(route[1][1] - route[0][1], route[1][0] - route[0][0]))
    walkers: list[Person] = []
    for number in range(people):
        walkers.append(_draw_walker(clearance, route, (number, people), walkers, random))
    return Problem(route[0], route[-1], heading, tuple(walkers))


def _draw_walker(
    clearance: NDArray[np.float64], route: Route, place: tuple[int, int], others: list[Person], random: Random
) -> Person:
    """Draw one of so many people about its stretch of the route, apart from
    ``others``; the last tries take any stretch.
    """
    number, count = place
    for attempt in range(TRIES):
        share = (number + random.random()) / count if attempt < TRIES // 2 else random.random()
        home, along = _route_position(np.array(route), 0.12 + 0.83 * float(share))
        across = np.array((-along[1], along[0]))
        way, lane = (along, across) if (number + attempt // 50) % 2 else (across, along)
        home, reaches = home + random.uniform(-1.2, 1.2) * lane, random.uniform(0.3, 2.2, 2)
        begin, end = home - reaches[0] * way, home + reaches[1] * way
        position = begin + random.random() * (end - begin)
        walker = Person((position[0], position[1]), ((end[0], end[1]), (begin[0], begin[1])), SPEED)
        if _is_clear(clearance, begin, end) and is_spaced(Problem(route[0], route[-1], 0.0, (*others, walker))):
            return walker
    raise AssertionError(f"no room for person {number} about {route}")


def _route_position(route: NDArray[np.float64], share: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the position at a share of a route's length, and the direction there."""
    legs = np.diff(route, axis=0)
    lengths = np.hypot(*legs.T)
    ends = np.cumsum(lengths)
    leg = min(int(np.searchsorted(ends, share * ends[-1])), len(legs) - 1)
    direction = legs[leg] / lengths[leg]
    return route[leg + 1] - (ends[leg] - share * ends[-1]) * direction, direction


def _is_clear(clearance: NDArray[np.float64], begin: NDArray[np.float64], end: NDArray[np.float64]) -> bool:
    """Return whether a body has room all the way."""
    steps = np.linspace(begin, end, int(np.hypot(*(end - begin)) / RESOLUTION) + 2)
    cells = np.floor(steps[:, ::-1] / RESOLUTION).astype(int)
    inside = ((cells >= 0) & (cells < clearance.shape)).all()
    return bool(inside and clearance[tuple(cells.T)].min() > ROOM + RESOLUTION)
