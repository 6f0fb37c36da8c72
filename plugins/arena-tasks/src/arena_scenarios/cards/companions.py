"""Cards of tasks with people: following, leading, accompanying, and groups."""

from __future__ import annotations

import math

from arena_scenarios.cards.people import Random, on_circle, uniform, walker
from arena_scenarios.problems import Course, Problem

SPEEDS = (0.18, 0.5, 0.9)  # m/s, of the person; the TurtleBot3 drives 0.22 m/s
START, AHEAD, END = (1.2, 1.3), (2.8, 1.3), (10.7, 11.0)
SPACING = 1.5  # m along the circle of people who talk
# asks the robot to lead, at once and for as long as it takes (docs/pedestrians.md, states 19 and 20)
FOLLOWER: dict[str, float | str] = {"requesting_guide_probability": 1.0, "requesting_guide_base_time": 1e6}
PLAZA = (9.0, 6.0)


def following_human(level: int, random: Random) -> Problem:
    """Walk round a corner ahead of the robot, which is to follow 1 to 2 m behind."""
    person = walker(
        (AHEAD[0] + uniform(random, 0.0, 0.4), AHEAD[1]), [END], SPEEDS[level] * uniform(random, 0.95, 1.05)
    )
    company = {"manner": "follow", "person": 0, "nearest": 1.0, "farthest": 2.0}
    return Problem(START, END, 0.0, (person,), Course(company=company))


def leading_human(level: int, random: Random) -> Problem:
    """Follow the robot, which is to go to its goal round a corner and to wait where the person falls behind."""
    person = walker(
        (START[0] + uniform(random, 0.0, 0.6), START[1]), [END], SPEEDS[level] * uniform(random, 0.95, 1.05), **FOLLOWER
    )
    company = {"manner": "lead", "person": 0, "nearest": 1.0, "farthest": 4.5}
    return Problem((3.4, 1.3), END, 0.0, (person,), Course(company=company))


def accompanying_peer(level: int, random: Random) -> Problem:
    """Walk through a hall with the robot, which is to stay at the person's side."""
    y = 6.0 + uniform(random, -1.5, 1.5)
    person = walker((2.4, y), [(12.2, y)], SPEEDS[level] * uniform(random, 0.95, 1.05))
    company = {"manner": "accompany", "person": 0, "nearest": 0.8, "farthest": 1.6}
    return Problem((1.6, y - 1.4), (12.2, y), 0.0, (person,), Course(company=company))


def join_group(level: int, random: Random) -> Problem:
    """Stand and talk; the robot is to take the free place in the circle, from outside."""
    members, turn = (2, 3, 5)[level], uniform(random, 0.0, 2.0 * math.pi)
    places = on_circle(PLAZA, SPACING * (members + 1) / (2.0 * math.pi), members + 1, turn)
    people = [walker(place, [], 1.0, group="talk") for place in places[1:]]
    return Problem((1.4, 6.0 + uniform(random, -3.0, 3.0)), places[0], 0.0, tuple(people))


def leave_group(level: int, random: Random) -> Problem:
    """Stand and talk with the robot, which is to leave the circle without cutting through it."""
    members, turn = (2, 3, 5)[level], uniform(random, -1.0, 1.0)
    places = on_circle(PLAZA, SPACING * (members + 1) / (2.0 * math.pi), members + 1, turn)
    people = [walker(place, [], 1.0, group="talk") for place in places[1:]]
    return Problem(places[0], (1.4, 6.0 + uniform(random, -3.0, 3.0)), turn + math.pi, tuple(people))
