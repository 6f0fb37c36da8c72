"""Static obstacles of N scenarios, checked and packed for the kernels."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from shapely.geometry import Polygon
from shapely.validation import explain_validity

from arena_core import ImpossibleScenario, Obstacle, Scenario
from arena_sim2d.scene import Floats, Obstacles, Offsets


def pack_obstacles(scenarios: Sequence[Scenario]) -> Obstacles:
    """Pack the obstacles of N scenarios; raise ImpossibleScenario for an outline that is no simple polygon."""
    discs = [[o for o in scenario.obstacles if len(o.vertices_xy) == 1] for scenario in scenarios]
    rings = [[_ring(scenario, o) for o in scenario.obstacles if len(o.vertices_xy) != 1] for scenario in scenarios]
    all_discs = [disc for world in discs for disc in world]
    all_rings = [ring for world in rings for ring in world]
    return Obstacles(
        np.array([disc.vertices_xy[0] for disc in all_discs], np.float64).reshape(-1, 2),
        np.array([disc.radius for disc in all_discs], np.float64),
        _starts([len(world) for world in discs]),
        np.concatenate([np.empty((0, 2)), *all_rings]),
        _starts([len(ring) for ring in all_rings]),
        np.array([_bound(ring) for ring in all_rings], np.float64).reshape(-1, 3),
        _starts([len(world) for world in rings]),
        np.concatenate([np.empty((0, 4)), *(_edges(ring) for ring in all_rings)]),
        _starts([sum(len(ring) - 1 for ring in world) for world in rings]),
    )


def _starts(lengths: Sequence[int]) -> Offsets:
    return np.cumsum([0, *lengths], dtype=np.int64)


def _ring(scenario: Scenario, obstacle: Obstacle) -> Floats:
    """Return a polygon's outline, its first vertex again at the end, or raise ImpossibleScenario."""
    vertices = np.asarray(obstacle.vertices_xy, dtype=np.float64)
    reason = explain_validity(Polygon(vertices)) if len(vertices) > 2 else "fewer than 3 vertices"
    if reason != "Valid Geometry":
        raise ImpossibleScenario(f"{scenario.name}: obstacle {vertices.tolist()} is no simple polygon ({reason})")
    return np.vstack((vertices, vertices[:1]))


def _bound(ring: Floats) -> tuple[float, float, float]:
    x, y = (ring.min(axis=0) + ring.max(axis=0)) / 2.0
    return x, y, float(np.hypot(ring[:, 0] - x, ring[:, 1] - y).max())


def _edges(ring: Floats) -> Floats:
    return np.hstack((ring[:-1], ring[1:]))
