"""Static obstacles of a scenario, the solids of furniture and doors, checked and tabled for the kernels."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from shapely.geometry import Polygon
from shapely.validation import explain_validity

from arena_core import ImpossibleScenario, Obstacle, Scenario
from arena_core.scenes import furniture_outlines
from arena_sim2d.bodies import BEAMS, OBSTACLE, PEOPLE, ROBOTS, Floats, Rows

TALL = 2.0  # m; people meet all of furniture that is lower


@dataclass(frozen=True, slots=True)
class Reach:
    """At which heights a robot meets what stands, m: its lidar at ``lidar``, its body from ``bottom`` to ``top``."""

    lidar: float
    bottom: float
    top: float


def table_obstacles(scenario: Scenario, reach: Reach) -> tuple[Rows, Floats]:
    """Return a scenario's obstacles, the solids of its furniture and last its doors (O,), and the sides (S, 2, 2) of
    all polygons.

    Raises ImpossibleScenario for an outline that is no simple polygon.
    """
    things = list(_iterate_obstacles(scenario, reach))
    table = np.zeros(len(things), OBSTACLE)
    sides = [np.empty((0, 2, 2)), *(_polygon_sides(scenario, obstacle) for obstacle, _ in things)]
    ends = np.cumsum([len(part) for part in sides])
    for row, (obstacle, meets) in enumerate(things):
        table[row] = (*_bounding_disc(obstacle), ends[row], ends[row + 1], meets)
    return table, np.concatenate(sides)


def _iterate_obstacles(scenario: Scenario, reach: Reach) -> Iterator[tuple[Obstacle, int]]:
    """Yield what stands on no map, and who meets it."""
    for obstacle in scenario.obstacles:
        yield obstacle, BEAMS | ROBOTS | PEOPLE
    pieces = scenario.world.furniture
    for met, low, high in ((BEAMS, reach.lidar, reach.lidar), (ROBOTS, reach.bottom, reach.top), (PEOPLE, 0.0, TALL)):
        for outline in furniture_outlines(pieces, low, high):
            yield outline, met
    for door in scenario.doors:
        yield Obstacle(door.vertices_xy), BEAMS | ROBOTS | PEOPLE


def _bounding_disc(obstacle: Obstacle) -> tuple[float, float, float]:
    """Return a disc, or the one about a polygon's bounding box."""
    vertices = obstacle.vertices_xy
    x, y = (vertices.min(axis=0) + vertices.max(axis=0)) / 2.0
    return float(x), float(y), float(np.hypot(*(vertices - (x, y)).T).max()) + obstacle.radius


def _polygon_sides(scenario: Scenario, obstacle: Obstacle) -> Floats:
    """Return a polygon's sides, none for a disc, or raise ImpossibleScenario."""
    vertices = np.asarray(obstacle.vertices_xy, dtype=np.float64)
    if len(vertices) == 1:
        return np.empty((0, 2, 2))
    reason = explain_validity(Polygon(vertices)) if len(vertices) > 2 else "fewer than 3 vertices"
    if reason != "Valid Geometry":
        raise ImpossibleScenario(f"{scenario.name}: obstacle {vertices.tolist()} is no simple polygon ({reason})")
    return np.stack((vertices, np.roll(vertices, -1, axis=0)), axis=1)
