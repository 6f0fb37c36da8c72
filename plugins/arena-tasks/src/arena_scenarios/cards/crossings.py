"""Cards of an intersection and a blind corner."""

from __future__ import annotations

from arena_scenarios.cards.people import Random, starting, uniform, walker
from arena_scenarios.problems import Problem

CENTRE = (7.0, 6.0)  # m, of the crossing
START, GOAL = (1.0, CENTRE[1]), (13.0, CENTRE[1])


def intersection_no_gesture(level: int, random: Random) -> Problem:
    """Cross the robot's way at the intersection, to and fro, without a sign."""
    people = []
    for number in range((1, 2, 4)[level]):
        x = CENTRE[0] + uniform(random, -0.9, 0.9)
        south, north = (x, 0.9), (x, 11.1)
        here = (x, CENTRE[1] + (-1.0, 1.0)[number % 2] * (uniform(random, 2.1, 2.9) + 1.1 * (number // 2)))
        ways = [north, south] if number % 2 == 0 else [south, north]
        people.append(walker(here, ways, uniform(random, 0.6, 1.1)))
    return Problem(START, GOAL, 0.0, tuple(people))


def intersection_wait(level: int, random: Random) -> Problem:
    """Stand at the intersection with a raised hand, and cross ahead of the robot once it is near."""
    signal = starting(CENTRE, 3.6, "signal_wait")
    people = []
    for number in range((1, 2, 3)[level]):
        place = (CENTRE[0] + uniform(random, -0.3, 0.3), 4.1 - 0.9 * number)
        people.append(walker(place, [(place[0], 11.0 - 0.9 * number)], uniform(random, 0.5, 0.8), **signal))
    return Problem(START, GOAL, 0.0, tuple(people))


def intersection_proceed(level: int, random: Random) -> Problem:
    """Stand at the intersection and wave the robot on, and cross once it has passed."""
    signal = starting((CENTRE[0] + 2.6, CENTRE[1]), 1.2, "signal_proceed")
    people = []
    for number in range((1, 2, 3)[level]):
        place = (CENTRE[0] + uniform(random, -0.3, 0.3), 3.8 - 0.9 * number)
        people.append(walker(place, [(place[0], 11.0 - 0.9 * number)], uniform(random, 0.6, 1.0), **signal))
    return Problem(START, GOAL, 0.0, tuple(people))


def blind_corner(level: int, random: Random) -> Problem:
    """Come round a corner that hides them until the robot is near, to and fro."""
    people = []
    for number in range((1, 2, 3)[level]):
        lane = uniform(random, -0.5, 0.5)
        turn, far, hidden = (10.7 + lane, 1.3 + lane), (3.4 + 0.9 * number, 1.3 + lane), (10.7 + lane, 10.2)
        start = (10.7 + lane, 5.0 + 1.4 * number)
        zone = starting((9.2, 1.3), 4.0)
        people.append(walker(start, [turn, far, turn, hidden], uniform(random, 0.6, 1.1), **zone))
    return Problem((1.2, 1.3), (10.7, 11.0), 0.0, tuple(people))
