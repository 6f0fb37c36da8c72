"""Static obstacles of N scenarios, checked and tabled for the kernels."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from shapely.geometry import Polygon
from shapely.validation import explain_validity

from arena_core import ImpossibleScenario, Obstacle, Scenario
from arena_sim2d.bodies import OBSTACLE, Floats, Rows


def table_obstacles(scenarios: Sequence[Scenario]) -> tuple[Rows, Floats]:
    """Return the obstacles (N, O) of N scenarios and the sides (S, 2, 2) of all polygons; O is the most that one scenario has.

    Raises ImpossibleScenario for an outline that is no simple polygon.
    """
    table = np.zeros((len(scenarios), max((len(scenario.obstacles) for scenario in scenarios), default=0)), OBSTACLE)
    sides: list[Floats] = []
    for rows, scenario in zip(table, scenarios, strict=True):
        for place, obstacle in enumerate(scenario.obstacles):
            added = _sides(scenario, obstacle)
            first = sum(map(len, sides))
            rows[place] = (*_disc(obstacle), first, first + len(added))
            sides.append(added)
    return table, np.concatenate([np.empty((0, 2, 2)), *sides])


def _disc(obstacle: Obstacle) -> tuple[float, float, float]:
    """Return a disc, or the one about a polygon's bounding box."""
    vertices = obstacle.vertices_xy
    x, y = (vertices.min(axis=0) + vertices.max(axis=0)) / 2.0
    return float(x), float(y), float(np.hypot(*(vertices - (x, y)).T).max()) + obstacle.radius


def _sides(scenario: Scenario, obstacle: Obstacle) -> Floats:
    """Return a polygon's sides, none for a disc, or raise ImpossibleScenario."""
    vertices = np.asarray(obstacle.vertices_xy, dtype=np.float64)
    if len(vertices) == 1:
        return np.empty((0, 2, 2))
    reason = explain_validity(Polygon(vertices)) if len(vertices) > 2 else "fewer than 3 vertices"
    if reason != "Valid Geometry":
        raise ImpossibleScenario(f"{scenario.name}: obstacle {vertices.tolist()} is no simple polygon ({reason})")
    return np.stack((vertices, np.roll(vertices, -1, axis=0)), axis=1)
