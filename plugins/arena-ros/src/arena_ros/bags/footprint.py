"""How far points are from a robot's footprint: what a scan says of clearance, without a map and without
knowing where the robot is.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from arena_core import Footprint, LaserScan, Pose


def point_clearances(footprint: Footprint, points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the distance of points (..., 2) in ``base_link`` to a convex footprint, m; 0 inside."""
    vertices = np.asarray(footprint.vertices_xy, np.float64).reshape(-1, 2)
    if len(vertices) < 3:
        centre = vertices[0] if len(vertices) else np.zeros(2)
        gaps: NDArray[np.float64] = np.maximum(
            np.hypot(points[..., 0] - centre[0], points[..., 1] - centre[1]) - footprint.radius, 0.0
        )
        return gaps
    first, edges = vertices, np.roll(vertices, -1, axis=0) - vertices
    relative = points[..., None, :] - first
    along = np.clip((relative * edges).sum(axis=-1) / (edges**2).sum(axis=-1), 0.0, 1.0)
    gap = relative - along[..., None] * edges
    distance = np.hypot(gap[..., 0], gap[..., 1]).min(axis=-1)
    turn = edges[:, 0] * relative[..., 1] - edges[:, 1] * relative[..., 0]
    inside = (turn >= 0.0).all(axis=-1) | (turn <= 0.0).all(axis=-1)
    result: NDArray[np.float64] = np.where(inside, 0.0, distance)
    return result


def nearest_return(footprint: Footprint, scan: LaserScan) -> tuple[float, float]:
    """Return the nearest return of a scan and the distance of the nearest one to the footprint,
    m; inf where nothing was hit.
    """
    least = float(np.min(scan.ranges, initial=np.inf, where=np.isfinite(scan.ranges)))
    if not np.isfinite(least):
        return float("inf"), float("inf")
    beams = np.flatnonzero(scan.ranges <= least + _mount_margin(footprint, scan.mount))
    ranges = scan.ranges[beams].astype(np.float64)
    angles = scan.angle_min + scan.angle_increment * beams + scan.mount.theta
    points = np.stack((scan.mount.x + ranges * np.cos(angles), scan.mount.y + ranges * np.sin(angles)), axis=1)
    return least, float(point_clearances(footprint, points).min())


def _mount_margin(footprint: Footprint, mount: Pose) -> float:
    """Return by how much more than another a return may be away from the laser and yet be nearer
    to the footprint, m, at most.
    """
    return 2.0 * (footprint.radius + float(np.hypot(mount.x, mount.y)))
