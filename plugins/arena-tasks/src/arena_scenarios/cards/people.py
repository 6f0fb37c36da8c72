"""Who walks in the cards: people who give way to the robot."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from arena_scenarios.problems import Person, Point

Random = np.random.Generator


def walker(position: Point, waypoints: Sequence[Point], speed: float, **behaviour: float | str) -> Person:
    """Return a person who gives way; one without waypoints stands, one with a single one walks there and stays."""
    return Person(position, tuple(waypoints), speed, {"reaction": "yield", **behaviour})


def starting(zone: Point, radius: float, mode: str = "trigger_zone") -> dict[str, float | str]:
    """Return the behaviour of a person who starts once the robot is within ``radius`` m of a place."""
    return {
        "start_up_mode": mode,
        "trigger_zone_radius": radius,
        "trigger_zone_x": zone[0],
        "trigger_zone_y": zone[1],
    }


def on_circle(middle: Point, radius: float, count: int, first: float) -> list[Point]:
    """Return places evenly on a circle, the first in the direction ``first``, rad."""
    angles = first + 2.0 * np.pi * np.arange(count) / count
    return [(middle[0] + radius * float(np.cos(a)), middle[1] + radius * float(np.sin(a))) for a in angles]


def uniform(random: Random, low: float, high: float) -> float:
    """Return a number between the two."""
    return float(random.uniform(low, high))
