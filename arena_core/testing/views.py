"""What a planner sees, made by hand: a window with boxes in it, people on their way, an observation of both."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from arena_core.values.geometry import FloatArray, Pose, Twist
from arena_core.values.sensing import NO_TRACKS, LaserScan, Observation, Tracks
from arena_core.values.world import LETHAL, Costmap, Path

Box = tuple[float, float, float, float]  # x_min, x_max, y_min, y_max in m
AHEAD = tuple((0.1 * k, 0.0) for k in range(26))  # a straight path along x


def boxes_costmap(*boxes: Box, cells: int = 121, resolution: float = 0.05) -> Costmap:
    """Return a square window about the origin, 6 m wide, whose cells are lethal where their
    centres lie in a box, else free.
    """
    centres: FloatArray = (np.arange(cells, dtype=np.float64) - 0.5 * (cells - 1)) * resolution
    distance = np.full((cells, cells), np.inf)
    for x_min, x_max, y_min, y_max in boxes:
        across, along = _distance_to(centres, x_min, x_max), _distance_to(centres, y_min, y_max)
        distance = np.minimum(distance, np.hypot(across[None, :], along[:, None]))
    costs = np.where(distance == 0.0, LETHAL, 0).astype(np.uint8)
    return Costmap(costs, distance.astype(np.float32), resolution, np.full(2, -0.5 * resolution * cells))


def _distance_to(centres: FloatArray, low: float, high: float) -> FloatArray:
    """Return how far each centre lies from the nearest of those in [low, high]; inf where there is none."""
    inside = centres[(centres >= low) & (centres <= high)]
    if len(inside) == 0:
        return np.full(len(centres), np.inf)
    outside: FloatArray = np.maximum(inside[0] - centres, centres - inside[-1])
    return outside.clip(min=0.0)


def tracked(*rows: Sequence[float], radius: float = 0.3, variance: float = 0.0) -> Tracks:
    """Return tracks of people from rows (x, y, vx, vy) in m and m/s, each with this variance."""
    table, count = np.array(rows, dtype=np.float64).reshape(-1, 4), len(rows)
    ids = np.arange(count, dtype=np.int32)
    return Tracks(
        ids,
        table[:, :2].copy(),
        table[:, 2:].copy(),
        np.full(count, radius),
        np.tile(variance * np.eye(4), (count, 1, 1)),
    )


def view(
    costmap: Costmap | None = None,
    pose: Pose | None = None,
    path_xy: ArrayLike = AHEAD,
    twist: Twist | None = None,
    stamp: float = 0.0,
    tracks: Tracks = NO_TRACKS,
) -> Observation:
    """Return the observation of a costmap (free unless given) and tracks, without a map and with a scan that saw
    nothing.

    ``path_xy`` (M, 2) m ends at the goal, which is the waypoint too; a path may be empty.
    """
    rows = np.asarray(path_xy, dtype=np.float64).reshape(-1, 2)
    path = Path(np.column_stack((rows, np.zeros(len(rows)))))
    goal = Pose.of(path.poses[-1]) if len(rows) else Pose(2.5, 0.0)
    scan = LaserScan(stamp, 0.0, 0.1, 0.12, 3.5, np.full(4, np.inf, np.float32), Pose(0.0, 0.0))
    window = costmap or boxes_costmap()
    at, speed = pose or Pose(0.0, 0.0), twist or Twist(0.0)
    return Observation(stamp, at, np.zeros((3, 3)), speed, scan, goal, goal, path, None, lambda: window, lambda: tracks)
