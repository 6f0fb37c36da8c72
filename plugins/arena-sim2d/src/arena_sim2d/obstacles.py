"""Static obstacles of a scenario, checked and tabled for the kernels."""

from __future__ import annotations

import numpy as np
from shapely.geometry import Polygon
from shapely.validation import explain_validity

from arena_core import ImpossibleScenario, Obstacle, Scenario
from arena_sim2d.bodies import OBSTACLE, Floats, Rows


def table_obstacles(scenario: Scenario) -> tuple[Rows, Floats]:
    """Return a scenario's obstacles (O,) and the sides (S, 2, 2) of all its polygons.

    Raises ImpossibleScenario for an outline that is no simple polygon.
    """
    table = np.zeros(len(scenario.obstacles), OBSTACLE)
    sides = [np.empty((0, 2, 2)), *(_sides(scenario, obstacle) for obstacle in scenario.obstacles)]
    ends = np.cumsum([len(part) for part in sides])
    for row, obstacle in enumerate(scenario.obstacles):
        table[row] = (*_disc(obstacle), ends[row], ends[row + 1])
    return table, np.concatenate(sides)


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
