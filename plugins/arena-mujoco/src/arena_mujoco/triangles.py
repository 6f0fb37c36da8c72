"""Simple polygons as convex parts: rigid bodies have to be convex."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Points = NDArray[np.float64]


def convex_parts(vertices_xy: Points) -> list[Points]:
    """Return convex polygons (V, 2) that fill a simple polygon: itself where it is convex, else triangles."""
    edges = np.roll(vertices_xy, -1, axis=0) - vertices_xy
    following = np.roll(edges, -1, axis=0)
    turns = edges[:, 0] * following[:, 1] - edges[:, 1] * following[:, 0]
    if (turns >= 0.0).all() or (turns <= 0.0).all():
        return [vertices_xy]
    from shapely import constrained_delaunay_triangles
    from shapely.geometry import Polygon

    parts = constrained_delaunay_triangles(Polygon(vertices_xy)).geoms
    return [np.asarray(part.exterior.coords)[:-1] for part in parts]
