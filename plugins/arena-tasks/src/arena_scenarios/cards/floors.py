"""The floor plans of the cards; measures in m. Pillars and furniture let a robot tell where along a wall it is."""

from __future__ import annotations

from arena_scenarios.floor import Floor


def corridor() -> Floor:
    """Draw a corridor of 20 by 3.2 m."""
    floor = Floor(20.0, 3.2)
    floor.room(0.0, 0.0, 20.0, 3.2)
    floor.pilasters(0.0, 0.2, (1.6, 4.1, 5.3, 8.2, 11.7, 13.0, 16.4, 18.3))
    floor.pilasters(3.2, -0.2, (0.9, 3.4, 7.0, 9.6, 12.1, 15.2, 17.5))
    return floor


def crossing() -> Floor:
    """Draw two corridors of 3 m that cross."""
    floor = Floor(14.0, 12.0)
    floor.room(0.0, 4.5, 14.0, 7.5)
    floor.room(5.5, 0.0, 8.5, 12.0)
    floor.pilasters(4.5, 0.2, (0.8, 2.3, 4.4, 9.4, 12.2))
    floor.pilasters(7.5, -0.2, (1.5, 3.8, 10.3, 11.6))
    return floor


def hallway() -> Floor:
    """Draw two halls, joined by 8 m of hallway 1.7 m wide."""
    floor = Floor(19.0, 5.0)
    floor.room(0.0, 0.0, 5.5, 5.0)
    floor.room(13.5, 0.0, 19.0, 5.0)
    floor.room(5.5, 1.65, 13.5, 3.35)
    floor.pilasters(0.0, 0.3, (0.7, 3.1, 14.6, 17.2))
    floor.pilasters(5.0, -0.3, (2.2, 4.0, 15.8))
    for x in (7.0, 9.8, 11.9):  # niches, which a scan tells apart
        floor.room(x, 3.35, x + 0.5, 3.6)
    return floor


def doorway() -> Floor:
    """Draw two rooms and a door of 1.1 m between them."""
    floor = Floor(14.3, 7.0)
    floor.room(0.0, 0.0, 7.0, 7.0)
    floor.room(7.3, 0.0, 14.3, 7.0)
    floor.room(7.0, 2.95, 7.3, 4.05)
    for x, y, width, height in (
        (2.1, 6.4, 1.5, 0.6),
        (4.9, 0.0, 1.1, 0.5),
        (9.3, 0.0, 1.8, 0.6),
        (13.7, 4.6, 0.6, 1.3),
    ):
        floor.block(x, y, x + width, y + height)
    return floor


def office() -> Floor:
    """Draw a corridor of 2.6 m, and a room behind a door of 1.2 m."""
    floor = Floor(13.0, 9.0)
    floor.room(0.0, 0.0, 13.0, 2.6)
    floor.room(3.0, 2.8, 11.0, 9.0)
    floor.room(6.2, 2.6, 7.4, 2.8)
    floor.pilasters(0.0, 0.2, (1.1, 3.6, 4.7, 8.8, 11.4))
    for x, y, width, height in (
        (3.0, 6.2, 0.6, 1.6),
        (9.2, 8.4, 1.3, 0.6),
        (10.5, 4.1, 0.5, 1.2),
        (4.6, 8.5, 1.0, 0.5),
    ):
        floor.block(x, y, x + width, y + height)
    return floor


def lobby() -> Floor:
    """Draw a lobby, and a cabin of 2.4 by 2.6 m behind a door of 1.2 m."""
    floor = Floor(11.0, 9.0)
    floor.room(0.0, 0.0, 11.0, 6.0)
    floor.room(4.3, 6.2, 6.7, 8.8)
    floor.room(4.9, 6.0, 6.1, 6.2)
    for x, y, width, height in (
        (0.0, 2.1, 0.5, 1.4),
        (10.4, 3.2, 0.6, 1.7),
        (2.4, 0.0, 1.2, 0.4),
        (7.8, 0.0, 0.9, 0.5),
    ):
        floor.block(x, y, x + width, y + height)
    return floor


def plaza() -> Floor:
    """Draw a hall of 14 by 12 m with pillars along its walls."""
    floor = Floor(14.0, 12.0)
    floor.room(0.0, 0.0, 14.0, 12.0)
    floor.pilasters(0.0, 0.3, (1.2, 3.9, 7.2, 9.6, 12.4))
    floor.pilasters(12.0, -0.3, (2.4, 5.0, 8.1, 11.7))
    for y in (2.2, 5.1, 9.3):
        floor.block(0.0, y, 0.3, y + 0.5)
        floor.block(13.7, y + 0.8, 14.0, y + 1.2)
    return floor
