"""A robot's outline, a disc or a convex polygon, against moving points with discs around them;
everything in the robot's frame.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]


def times_to_contact(
    footprint: Mapping[str, Any], offsets: FloatArray, velocities: FloatArray, radii: FloatArray, horizon: float
) -> FloatArray:
    """Return when discs of ``radii`` at ``offsets`` (..., 2) with relative ``velocities`` first touch the outline, s;
    inf for never.

    Exact for constant velocities while the outline does not turn: a polygon's outline at a disc's distance is made of
    its sides, moved outward, and of arcs about its corners. Only those who come within the circumscribed circle by the
    horizon are looked at so.
    """
    radii = np.broadcast_to(radii, offsets.shape[:-1])
    outer = _times_to_circle(offsets, velocities, footprint["radius"] + radii)
    vertices = np.asarray(footprint["vertices_xy"], dtype=float).reshape(-1, 2)
    if not len(vertices):
        return outer
    near = (outer <= horizon) | (np.hypot(offsets[..., 0], offsets[..., 1]) <= footprint["radius"] + radii)
    found = np.full(outer.shape, np.inf)
    found[near] = _times_to_polygon(vertices, offsets[near], velocities[near], radii[near])
    return found


def _times_to_polygon(
    vertices: FloatArray, offsets: FloatArray, velocities: FloatArray, radii: FloatArray
) -> FloatArray:
    """Return the times of K discs to the polygon (V, 2), counter-clockwise, (K,), s."""
    corners = _times_to_circle(offsets[:, None] - vertices, velocities[:, None], radii[:, None])
    soonest: FloatArray = np.minimum(corners, _times_to_sides(vertices, offsets, velocities, radii)).min(axis=1)
    return soonest


def _times_to_circle(offsets: FloatArray, velocities: FloatArray, radii: FloatArray) -> FloatArray:
    """Return when points come within ``radii`` of the origin, s: 0 where they are and come
    nearer, inf where they never do.
    """
    a, b = (velocities**2).sum(axis=-1), (offsets * velocities).sum(axis=-1)
    c = (offsets**2).sum(axis=-1) - radii**2
    root = np.sqrt(np.maximum(b**2 - a * c, 0.0))
    time = _safe_divide(np.maximum(c, 0.0), root - b, root - b > 0.0)
    return np.where((b < 0.0) & (b**2 >= a * c), time, np.inf)


def _times_to_sides(vertices: FloatArray, offsets: FloatArray, velocities: FloatArray, radii: FloatArray) -> FloatArray:
    """Return when discs touch each straight side, (K, V), s; inf where they pass it by."""
    along, lengths = _side_vectors(vertices)
    outward = np.stack((along[:, 1], -along[:, 0]), axis=1)
    relative = offsets[:, None] - vertices
    height, closing = (relative * outward).sum(axis=2) - radii[:, None], -(velocities @ outward.T)
    outside = height > -radii[:, None]
    time = _safe_divide(np.maximum(height, 0.0), closing, (closing > 0.0) & outside)
    reached = (relative * along).sum(axis=2) + np.where(np.isfinite(time), time, 0.0) * (velocities @ along.T)
    touching: FloatArray = np.where((reached >= 0.0) & (reached <= lengths), time, np.inf)
    return touching


def _safe_divide(distance: FloatArray, speed: FloatArray, where: NDArray[np.bool_]) -> FloatArray:
    """Return distance / speed, inf elsewhere and at speeds so small that it overflows."""
    with np.errstate(over="ignore"):
        time: FloatArray = np.divide(distance, speed, out=np.full(np.shape(distance), np.inf), where=where)
    return time


def outline_distances(footprint: Mapping[str, Any], points: FloatArray) -> FloatArray:
    """Return how far points (K, 2) are from the outline, m; 0 inside it."""
    vertices = np.asarray(footprint["vertices_xy"], dtype=float).reshape(-1, 2)
    if not len(vertices):
        gaps: FloatArray = np.maximum(np.hypot(points[:, 0], points[:, 1]) - footprint["radius"], 0.0)
        return gaps
    along, lengths = _side_vectors(vertices)
    relative = points[:, None] - vertices
    nearest = np.clip((relative * along).sum(axis=2), 0.0, lengths)[:, :, None] * along
    heights = relative[:, :, 0] * along[:, 1] - relative[:, :, 1] * along[:, 0]
    return np.where((heights <= 0.0).all(axis=1), 0.0, np.hypot(*np.moveaxis(relative - nearest, 2, 0)).min(axis=1))


def _side_vectors(vertices: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return unit vectors along the sides, (V, 2), and their lengths, (V,), m; side k begins at vertex k."""
    sides = np.roll(vertices, -1, axis=0) - vertices
    lengths = np.hypot(*sides.T)
    return sides / lengths[:, None], lengths
