"""The situations of the pack: who walks where, in three densities. Metres, m/s; every number here is ours.

Each function returns the people of one variation. All walk rounds, so that a robot that comes late meets them too; some
wait until the robot is near, so that one that comes early does.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from arena_scenarios.problems import Person, Point, Problem

Random = np.random.Generator
APART, KEEP_OFF = 0.65, 1.5  # m, least distances at the start: between people, and of people from the robot
DENSITIES = {"low": 0, "medium": 1, "high": 2}


def crossing_problem(density: int, random: Random) -> Problem:
    """People cross the robot's corridor at three junctions, both ways."""
    people = []
    for number in range((3, 6, 12)[density]):
        x = 5.0 * (number % 3 + 1) + float(random.uniform(-0.7, 0.7))
        upwards = (number // 3 + number % 3) % 2 == 0
        ends = ((x, 1.8), (x, 9.7)) if upwards else ((x, 9.7), (x, 1.8))
        share = float(random.uniform(0.06, 0.2)) + 0.3 * (number // 6)
        position = (x, ends[0][1] + share * (ends[1][1] - ends[0][1]))
        people.append(
            Person(
                position,
                (ends[1], ends[0]),
                float(random.uniform(0.5, 0.9)),
                _wait_behaviour(6.0, waits=number % 3 != 0 and number < 6),
            )
        )
    return Problem((1.5, 5.75), (18.5, 5.75), 0.0, tuple(people))


def head_on(density: int, random: Random) -> Problem:
    """People come towards the robot in a corridor of 3 m, one after the other, and come round again."""
    count = (2, 4, 8)[density]
    places = [0.3 + 0.62 * number / count for number in range(count)]
    people = [
        _ring_walker(RING, place, float(random.uniform(-0.75, 0.75)), -float(random.uniform(0.4, 0.8)))
        for place in places
    ]
    return Problem((3.2, 1.5), (16.8, 1.5), 0.0, tuple(people))


def overtaking_problem(density: int, random: Random) -> Problem:
    """Slow people go ahead of the robot, faster ones come from behind: one of the two overtakes the other."""
    pairs = (1, 2, 4)[density]
    ahead = [0.14 + 0.17 * (number + random.uniform(0.0, 0.5)) / pairs for number in range(pairs)]
    behind = [0.93 - 0.3 * (number + random.uniform(0.0, 0.3)) / pairs for number in range(pairs)]
    people = [
        _ring_walker(RING, float(place), float(random.uniform(-0.8, 0.8)), float(random.uniform(0.3, 0.4)))
        for place in ahead
    ]
    people += [
        _ring_walker(RING, float(place), float(random.uniform(-0.8, 0.8)), float(random.uniform(0.5, 0.9)))
        for place in behind
    ]
    return Problem((3.2, 1.5), (16.8, 1.5), 0.0, tuple(people))


def moving_group(density: int, random: Random) -> Problem:
    """Groups of two and three walk abreast through a corridor of 4 m towards the robot."""
    people: list[Person] = []
    for number in range((1, 2, 4)[density]):
        place = (0.27, 0.42, 0.61, 0.8)[number] + float(random.uniform(-0.03, 0.03))
        speed, members = float(random.uniform(0.35, 0.6)), 3 - number % 2
        side = float(random.choice((-0.3, 0.3)))
        for member in range(members):
            lane = side + 0.75 * (member - (members - 1) / 2)
            people.append(_ring_walker(PROMENADE, place, lane, -speed, {"group": f"group {number}"}))
    return Problem((4.2, 2.0), (19.8, 2.0), 0.0, tuple(people))


def doorway_problem(density: int, random: Random) -> Problem:
    """People go to and fro through the one door that the robot needs."""
    people = []
    for number in range((2, 4, 7)[density]):
        here = (float(random.uniform(4.3, 6.9)), 0.9 + 6.2 * ((0.37 * number + random.uniform(0.0, 0.3)) % 1.0))
        there = (float(random.uniform(9.6, 12.2)), 1.3 + 5.6 * ((0.61 * number + random.uniform(0.0, 0.3)) % 1.0))
        near, far = (7.4, 4.0 + float(random.uniform(-0.3, 0.3))), (8.9, 4.0 + float(random.uniform(-0.3, 0.3)))
        rounds = (near, far, there, far, near, here) if number % 2 else (far, near, here, near, far, there)
        position = here if number % 2 else there
        people.append(
            Person(position, rounds, float(random.uniform(0.4, 0.7)), _wait_behaviour(5.5, waits=number == 0))
        )
    y = float(random.uniform(2.2, 5.8))
    return Problem((1.5, y), (14.8, 8.0 - y), 0.0, tuple(people))


def blind_corner(density: int, random: Random) -> Problem:
    """People come round a corner that hides them until the robot is there."""
    people = []
    for number in range((2, 3, 5)[density]):
        lane = float(random.uniform(-0.6, 0.6))
        turn, hidden, far = (
            (10.7 + lane, 1.3 + lane),
            (10.7 + lane, 10.4 - 0.2 * number),
            (3.6 + 0.8 * number, 1.3 + lane),
        )
        position = (10.7 + lane, 4.0 + 1.3 * number)
        people.append(
            Person(
                position,
                (turn, far, turn, hidden),
                float(random.uniform(0.4, 0.8)),
                _wait_behaviour(4.5 + number, waits=number < 2),
            )
        )
    return Problem((1.2, 1.3), (10.7, 11.0), 0.0, tuple(people))


def queue_problem(density: int, random: Random) -> Problem:
    """People queue at a counter across the robot's way, are served, walk away and queue again."""
    people: list[Person] = []
    heads = ([7.5], [7.5], [5.8, 9.6])[density]
    for number, x in enumerate(heads):
        for place in range((5, 8, 7)[density]):
            position = (x + float(random.uniform(-0.1, 0.1)), 7.6 - 0.9 * place)
            away = ((x + 1.6, 6.6), (x + float(random.uniform(1.2, 2.0)), 1.2))
            line: dict[str, float | str] = {"queue": f"queue {number}", "queue_waypoint": 0, "queue_heading": 1.57}
            people.append(Person(position, ((x, 7.6), *away), float(random.uniform(0.4, 0.7)), line))
    y = float(random.uniform(3.2, 4.4))
    return Problem((1.4, y), (13.6, y), 0.0, tuple(people))


def draw_spaced(
    draw: Callable[[int, Random], Problem], density: int, random: Random, keep_off: float = KEEP_OFF
) -> Problem:
    """Draw until people are spaced."""
    while not is_spaced(problem := draw(density, random), keep_off):
        pass
    return problem


def is_spaced(problem: Problem, keep_off: float = KEEP_OFF) -> bool:
    """Return whether no one stands in another or at the robot's start."""
    places = np.array([person.position for person in problem.people])
    gaps = np.hypot(*(places[:, None] - places[None]).transpose(2, 0, 1)) + np.diag(np.full(len(places), np.inf))
    return bool(gaps.min() >= APART and np.hypot(*(places - problem.start).T).min() >= keep_off)


SITUATIONS: dict[str, tuple[str, Callable[[int, Random], Problem]]] = {  # by name: the floor plan, and who is there
    "crossing": ("junctions", crossing_problem),
    "overtaking": ("ring", overtaking_problem),
    "head_on": ("ring", head_on),
    "doorway": ("rooms", doorway_problem),
    "blind_corner": ("corner", blind_corner),
    "queue": ("counter_hall", queue_problem),
    "moving_group": ("promenade", moving_group),
}

Round = Sequence[Point]
RING: Round = ((1.5, 1.5), (18.5, 1.5), (18.5, 7.5), (1.5, 7.5))
PROMENADE: Round = ((2.0, 2.0), (22.0, 2.0), (22.0, 11.0), (2.0, 11.0))


def _ring_walker(
    middle: Round, place: float, lane: float, velocity: float, behaviour: dict[str, float | str] | None = None
) -> Person:
    """Return a person who goes round a ring at ``velocity`` m/s, clockwise if that is negative.

    ``middle`` are the corners of the ring's middle line, counterclockwise from its first straight's begin; ``place`` is
    the share of the line at which the person starts, ``lane`` how far outside the line it walks, m.
    """
    line = np.array(middle)
    ends = np.cumsum(np.hypot(*(np.roll(line, -1, axis=0) - line).T))
    side = int(np.searchsorted(ends, place * ends[-1], side="right"))
    share = (place * ends[-1] - (ends[side - 1] if side else 0.0)) / (ends[side] - (ends[side - 1] if side else 0.0))
    corners = line + lane * np.sign(line - line.mean(axis=0))
    position = (1.0 - share) * corners[side] + share * corners[(side + 1) % len(corners)]
    order = [(side + 1 + k) % 4 for k in range(4)] if velocity > 0.0 else [(side - k) % 4 for k in range(4)]
    return Person(_as_point(position), tuple(_as_point(corners[k]) for k in order), abs(velocity), behaviour or {})


def _as_point(position: np.ndarray) -> Point:
    return float(position[0]), float(position[1])


def _wait_behaviour(radius: float, *, waits: bool) -> dict[str, float | str]:
    """Return the behaviour of someone who starts once the robot is within ``radius`` m, if it waits at all."""
    return {"start_up_mode": "trigger_zone", "trigger_zone_radius": radius} if waits else {}
