"""The floor plans of the situations; measures in m."""

from __future__ import annotations

from arena_scenarios.floor import Floor


def ring_floor(length: float, depth: float, corridor: float) -> Floor:
    """Draw a corridor all around a block, so that people go round and round and all of them the same way."""
    floor = Floor(length, depth)
    floor.room(0.0, 0.0, length, depth)
    floor.block(corridor, corridor, length - corridor, depth - corridor)
    places = tuple(length * share for share in (0.08, 0.19, 0.27, 0.41, 0.5, 0.63, 0.71, 0.86))
    floor.pilasters(0.0, 0.2, places)
    floor.pilasters(depth, -0.2, places)
    floor.pilasters(corridor, -0.15, tuple(x for x in (5.1, 8.7, 10.4, 14.2) if x < length - corridor - 0.5))
    return floor


def junctions_floor() -> Floor:
    """Draw a corridor of 3.5 m that three others of 2.5 m cross."""
    floor = Floor(20.0, 11.5)
    floor.room(0.0, 4.0, 20.0, 7.5)
    for x in (5.0, 10.0, 15.0):
        floor.room(x - 1.25, 0.0, x + 1.25, 11.5)
    floor.pilasters(4.0, 0.2, (0.7, 2.4, 7.1, 12.6, 17.3))
    floor.pilasters(7.5, -0.2, (1.6, 7.8, 8.3, 13.1, 18.4))
    return floor


def rooms_floor() -> Floor:
    """Draw two rooms with shelves, and one door of 1.5 m between them."""
    floor = Floor(16.3, 8.0)
    floor.room(0.0, 0.0, 8.0, 8.0)
    floor.room(8.3, 0.0, 16.3, 8.0)
    floor.room(8.0, 3.25, 8.3, 4.75)
    for x, y, width, height in (
        (2.4, 7.4, 1.6, 0.6),
        (5.2, 0.0, 1.2, 0.5),
        (0.0, 5.6, 0.5, 1.4),
        (10.6, 0.0, 1.9, 0.6),
    ):
        floor.block(x, y, x + width, y + height)
    for x, y, width, height in (
        (12.9, 7.5, 1.3, 0.5),
        (15.8, 4.9, 0.5, 1.1),
        (7.6, 6.4, 0.4, 0.9),
        (8.3, 0.9, 0.4, 1.2),
    ):
        floor.block(x, y, x + width, y + height)
    return floor


def corner_floor() -> Floor:
    """Draw two corridors of 2.6 m that meet at a right angle, behind which no one sees."""
    floor = Floor(12.0, 12.0)
    floor.room(0.0, 0.0, 12.0, 2.6)
    floor.room(9.4, 0.0, 12.0, 12.0)
    floor.pilasters(0.0, 0.15, (1.9, 4.3, 5.4, 8.1))
    for y in (4.2, 6.6, 7.7, 10.3):
        floor.block(11.85, y, 12.0, y + 0.4)
    return floor


def counter_hall() -> Floor:
    """Draw a hall with a counter along its upper wall and pillars."""
    floor = Floor(15.0, 9.0)
    floor.room(0.0, 0.0, 15.0, 9.0)
    floor.block(4.0, 8.2, 11.5, 9.0)
    for x, y in ((2.6, 5.9), (3.4, 1.2), (11.9, 5.4), (12.6, 1.5)):
        floor.block(x, y, x + 0.5, y + 0.5)
    floor.pilasters(0.0, 0.25, (1.3, 5.2, 7.6, 8.7, 10.4, 13.5))
    return floor
