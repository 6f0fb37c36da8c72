"""Cards of a corridor, a hallway and a door: one robot and few people who come, go or stand."""

from __future__ import annotations

from arena_scenarios.cards.people import Random, uniform, walker
from arena_scenarios.problems import Problem

MIDDLE = 1.6  # m, of the corridor
START, GOAL = (2.5, MIDDLE), (16.5, MIDDLE)


def frontal_approach(level: int, random: Random) -> Problem:
    """Come towards the robot."""
    people = []
    for number in range((1, 2, 4)[level]):
        y = MIDDLE + uniform(random, -0.6, 0.6)
        people.append(walker((13.0 + 1.3 * number, y), [(0.8, y)], uniform(random, 0.7, 1.2)))
    return Problem(START, GOAL, 0.0, tuple(people))


def pedestrian_obstruction(level: int, random: Random) -> Problem:
    """Stand in the robot's way, now nearer to one wall, now to the other."""
    people = []
    for number in range((1, 2, 3)[level]):
        side = 0.45 if number % 2 else -0.45
        place = (7.0 + 3.0 * number + uniform(random, -0.5, 0.5), MIDDLE + side + uniform(random, -0.15, 0.15))
        people.append(walker(place, [], 1.0))
    return Problem(START, GOAL, 0.0, tuple(people))


def pedestrian_overtaking(level: int, random: Random) -> Problem:
    """Come from behind, faster than most robots."""
    people = []
    for number in range((1, 2, 3)[level]):
        y = MIDDLE + (0.7, -0.7, 0.0)[number] + uniform(random, -0.15, 0.15)
        people.append(walker((2.6 - 0.9 * number, y), [(18.6, y)], uniform(random, 1.2, 1.6)))
    return Problem((4.5, MIDDLE), (17.0, MIDDLE), 0.0, tuple(people))


def robot_overtaking(level: int, random: Random) -> Problem:
    """Walk ahead of the robot, more slowly than any."""
    people = []
    for number in range((1, 2, 3)[level]):
        y = MIDDLE + uniform(random, -0.5, 0.5)
        people.append(walker((4.5 + 2.2 * number, y), [(18.5, y)], uniform(random, 0.08, 0.14)))
    return Problem(START, GOAL, 0.0, tuple(people))


def down_path(level: int, random: Random) -> Problem:
    """Walk beside the robot, the same way."""
    people = []
    for number in range((1, 2, 3)[level]):
        y = 2.4 + uniform(random, -0.15, 0.15)
        people.append(walker((3.3 + 1.2 * number, y), [(18.5, y)], uniform(random, 0.4, 0.9)))
    return Problem((2.5, 0.9), (16.5, 0.9), 0.0, tuple(people))


def narrow_hallway(level: int, random: Random) -> Problem:
    """Come through the hallway, in which two can just pass each other, to and fro."""
    people = []
    for number in range((1, 2, 3)[level]):
        y = 2.5 + uniform(random, -0.3, 0.3)
        here, there = (16.4 - 1.2 * number, y), (2.6, 0.9 + 1.4 * number)
        people.append(walker(here, [there, here], uniform(random, 0.6, 1.0)))
    return Problem((1.2, 2.5), (17.8, 2.5), 0.0, tuple(people))


def narrow_doorway(level: int, random: Random) -> Problem:
    """Come through the door, through which only one fits at a time, to and fro."""
    people = []
    for number in range((1, 2, 4)[level]):
        here = (11.8 - 0.9 * (number // 2), 2.2 + 2.4 * (number % 2) + uniform(random, -0.3, 0.3))
        there = (4.6 - 0.8 * (number // 2), 5.2 - 3.2 * (number % 2))
        people.append(walker(here, [there, here], uniform(random, 0.6, 1.0)))
    return Problem((1.6, 3.5), (12.9, 3.5), 0.0, tuple(people))
