"""Cards of many people in a hall."""

from __future__ import annotations

import math

from arena_scenarios.cards.people import Random, on_circle, uniform, walker
from arena_scenarios.problems import Person, Point, Problem

START, GOAL, CENTRE = (1.2, 6.0), (12.8, 6.0), (7.0, 6.0)
COUNTS = (4, 8, 14)


def crowd_navigation(level: int, random: Random) -> Problem:
    """Walk about the hall in all directions."""
    people = []
    for _ in range((6, 12, 20)[level]):
        places = [_place(random) for _ in range(3)]
        people.append(walker(places[0], [*places[1:], places[0]], uniform(random, 0.5, 1.1)))
    return Problem(START, GOAL, 0.0, tuple(people))


def parallel_traffic(level: int, random: Random) -> Problem:
    """Walk along the robot's way in lanes, one half with it, the other against it."""
    people = []
    for number in range(COUNTS[level]):
        y = 6.0 + (0.7 * (number // 2 + 1) - 0.35) * (1 if number % 2 else -1) * 0.55 + uniform(random, -0.2, 0.2)
        here, there = (uniform(random, 2.8, 12.6), y), (1.0 if number % 2 else 13.0, y)
        people.append(walker(here, [there, (14.0 - there[0], y)], uniform(random, 0.6, 1.1)))
    return Problem(START, GOAL, 0.0, tuple(people))


def perpendicular_traffic(level: int, random: Random) -> Problem:
    """Cross the robot's way in a stream, both ways."""
    people = []
    for number in range(COUNTS[level]):
        x = 3.6 + 6.8 * (number + uniform(random, 0.0, 0.8)) / COUNTS[level]
        south, north = (x, 0.9), (x, 11.1)
        there, back = (north, south) if number % 2 else (south, north)
        people.append(walker((x, uniform(random, 1.0, 11.0)), [there, back], uniform(random, 0.6, 1.1)))
    return Problem(START, GOAL, 0.0, tuple(people))


def circular_crossing(level: int, random: Random) -> Problem:
    """Stand on a circle with the robot, and walk to the opposite place, all at once, to and fro."""
    count = (3, 7, 11)[level]
    places = on_circle(CENTRE, 4.6, count + 1, math.pi + uniform(random, -0.2, 0.2))
    people = [_through_centre(place, uniform(random, 0.6, 1.1)) for place in places[1:]]
    return Problem(places[0], (12.8, 2.0 * CENTRE[1] - places[0][1]), 0.0, tuple(people))  # beyond who comes back


def robot_crowding(level: int, random: Random) -> Problem:
    """Come to look at the robot from all sides, and keep about it for a while."""
    people = []
    for number in range((2, 4, 8)[level]):
        place = (4.2 + 1.1 * number, 6.0 + (1.6 if number % 2 else -1.6) + uniform(random, -0.6, 0.6))
        people.append(
            walker(place, [(place[0], 12.0 - place[1]), place], uniform(random, 0.5, 0.9), reaction="curious")
        )
    return Problem(START, GOAL, 0.0, tuple(people))


def _through_centre(place: Point, speed: float) -> Person:
    return walker(place, [_opposite(place), place], speed)


def _opposite(place: Point) -> Point:
    return 2.0 * CENTRE[0] - place[0], 2.0 * CENTRE[1] - place[1]


def _place(random: Random) -> Point:
    return uniform(random, 2.6, 11.6), uniform(random, 1.0, 11.0)
