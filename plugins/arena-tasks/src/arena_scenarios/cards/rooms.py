"""Cards of a room and of an elevator, whose doors open after a while: who comes out, goes first."""

from __future__ import annotations

from arena_scenarios.cards.people import Random, starting, uniform, walker
from arena_scenarios.problems import Course, Doorway, Problem

DOOR, CORRIDOR = (6.8, 2.7), 1.3  # m
LIFT, CABIN = (5.5, 6.1), (5.5, 7.5)
OPENS = (4.0, 7.0)  # s, when a door opens first
STAYS, PERIOD = 10.0, 20.0  # s, an elevator's door is open so long, and again in each period


def entering_room(level: int, random: Random) -> Problem:
    """Leave the room through its door as the robot comes to enter."""
    people = []
    for number in range((1, 2, 3)[level]):
        place = (DOOR[0] + (0.0, 0.8, -0.8)[number] + uniform(random, -0.2, 0.2), 5.0 + 0.6 * number)
        end = (12.0 - 0.9 * number, CORRIDOR)
        people.append(walker(place, [end], uniform(random, 0.6, 1.0), **starting(DOOR, 2.6)))
    return Problem((1.2, CORRIDOR), (8.6, 7.0), 0.0, tuple(people), Course(door=_room_door(random)))


def exiting_room(level: int, random: Random) -> Problem:
    """Come along the corridor and enter the room as the robot leaves it."""
    people = []
    for number in range((1, 2, 3)[level]):
        place = (8.5 + 0.9 * number, CORRIDOR + uniform(random, -0.4, 0.4))
        end = (4.6 + 0.9 * number, 7.8)
        people.append(walker(place, [end], uniform(random, 0.6, 1.0), **starting(DOOR, 3.8)))
    return Problem((8.6, 7.0), (1.2, CORRIDOR), -2.2, tuple(people), Course(door=_room_door(random)))


def entering_elevator(level: int, random: Random) -> Problem:
    """Leave the cabin as the robot comes to enter it."""
    people = []
    for number in range((1, 2, 3)[level]):
        place = (
            CABIN[0] + (0.0, 0.7, -0.7)[number] + uniform(random, -0.12, 0.12),
            7.0 + 0.75 * (number > 0) + uniform(random, -0.1, 0.1),
        )
        end = (1.4 + 0.9 * number, 4.6)
        people.append(walker(place, [end], uniform(random, 0.6, 0.9), **starting(LIFT, 2.8)))
    return Problem((8.6, 1.6), CABIN, 2.0, tuple(people), Course(door=_elevator_door(random)))


def exiting_elevator(level: int, random: Random) -> Problem:
    """Wait before the cabin until the robot has left it, then enter."""
    people = []
    outside = starting((8.6, 2.0), 1.6)
    for number in range((1, 2, 3)[level]):
        place = (LIFT[0] + (-1.3, 1.4, -2.2)[number], 4.7 + uniform(random, -0.2, 0.2))
        end = (CABIN[0] + 0.7 * (number - 1), 7.9)
        people.append(walker(place, [end], uniform(random, 0.6, 0.9), **outside))
    return Problem((CABIN[0], 7.3), (8.6, 1.6), -1.57, tuple(people), Course(door=_elevator_door(random)))


def _room_door(random: Random) -> Doorway:
    """Return the door of the room, which opens once and stays open."""
    return Doorway((6.2, 2.65), (7.4, 2.75), (uniform(random, *OPENS),))


def _elevator_door(random: Random) -> Doorway:
    """Return the door of the cabin, which opens in each period."""
    first = uniform(random, *OPENS)
    return Doorway((4.9, 6.05), (6.1, 6.15), (first, first + STAYS), PERIOD)
