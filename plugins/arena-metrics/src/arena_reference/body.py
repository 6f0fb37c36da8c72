"""Where a robot's body meets nothing: exact outlines among the ground's distances and people as discs."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from arena_core import Footprint
from arena_kernels.compiled import borrowing, inner
from arena_reference.arrays import Floats
from arena_reference.terrain import Terrain

SPACING = 0.02  # m between the points of an outline that are held against the ground


class Body(NamedTuple):
    """A convex outline: ``corners`` (V, 2) and ``points`` (M, 2) along its sides in ``base_link`` m, none for a disc;
    the radii of the discs about its origin that it holds, and that hold it, m.
    """

    corners: Floats
    points: Floats
    inscribed: float
    radius: float


class Walkers(NamedTuple):
    """People's positions (K, P, 2) in ``map``, ``period`` s apart from ``start`` s on, and their ``radii`` (P,), m."""

    positions: Floats
    radii: Floats
    start: float
    period: float


class Moving(NamedTuple):
    """People on a grid, in cells, and what they keep a disc from: ``radii`` (P,) are the sums of both, in cells, and
    shrink by ``speed`` cells a second away from an instant: so far the disc may have come from elsewhere, or get away.
    """

    people: Walkers
    radii: Floats
    speed: float


class Nearby(NamedTuple):
    """Those of the people, by number (N,), whom a body may meet at ``time`` s; it has to be farther than ``margin`` m
    from them.
    """

    walkers: Walkers
    numbers: Floats
    time: float
    margin: float


Pose = tuple[float, float, float]  # x, y (m) and theta (rad) in ``map``


def body_of(footprint: Footprint) -> Body:
    """Return a footprint as these kernels read it."""
    corners = np.ascontiguousarray(footprint.vertices_xy, np.float64).reshape(-1, 2)
    sides = zip(corners, np.roll(corners, -1, axis=0), strict=True)
    points = [a + share * (b - a) for a, b in sides for share in _shares(float(np.hypot(*(b - a))))]
    return Body(corners, np.array(points).reshape(-1, 2), float(footprint.inscribed_radius), float(footprint.radius))


def _shares(length: float) -> Floats:
    count = max(1, math.ceil(length / SPACING))
    return np.arange(count) / count


@borrowing
def distance_at(ground: Terrain, x: float, y: float) -> float:
    """Return how far a point is from what stands, m, between the centres of four cells; 0 outside the grid."""
    rows, columns = ground.distance.shape
    dx, dy = (x - ground.x) / ground.cell, (y - ground.y) / ground.cell
    u = ground.cosine * dx + ground.sine * dy - 0.5
    v = ground.cosine * dy - ground.sine * dx - 0.5
    if not (0.0 <= u < columns - 1 and 0.0 <= v < rows - 1):
        return 0.0
    column, row = int(u), int(v)
    a, b = u - column, v - row
    field = ground.distance
    low = field[row, column] * (1.0 - a) + field[row, column + 1] * a
    high = field[row + 1, column] * (1.0 - a) + field[row + 1, column + 1] * a
    return float(low * (1.0 - b) + high * b)


@borrowing
def stands_free(ground: Terrain, body: Body, pose: Pose, margin: float) -> bool:
    """Return whether a body at a pose is farther than ``margin`` from all that stands, m."""
    x, y, theta = pose
    room = distance_at(ground, x, y)
    if room > body.radius + margin:
        return True
    if room <= body.inscribed + margin or len(body.points) == 0:
        return False
    c, s = math.cos(theta), math.sin(theta)
    for i in range(len(body.points)):
        px, py = body.points[i, 0], body.points[i, 1]
        if distance_at(ground, x + c * px - s * py, y + s * px + c * py) <= margin:
            return False
    return True


@borrowing
def place_of(walkers: Walkers, p: int, t: float) -> tuple[float, float]:
    """Return where person ``p`` is at ``t`` s, straight between two positions; NaN where absent."""
    place = min(max((t - walkers.start) / walkers.period, 0.0), len(walkers.positions) - 1.0)
    k = int(place)
    x, y = walkers.positions[k, p, 0], walkers.positions[k, p, 1]
    if place > k:
        x += (place - k) * (walkers.positions[k + 1, p, 0] - x)
        y += (place - k) * (walkers.positions[k + 1, p, 1] - y)
    return x, y


@borrowing
def meets_nobody(nearby: Nearby, body: Body, pose: Pose) -> bool:
    """Return whether a body at a pose is far enough from those nearby."""
    walkers, near, (x, y, theta) = nearby.walkers, nearby.numbers, pose
    for i in range(len(near)):
        p = int(near[i])
        px, py = place_of(walkers, p, nearby.time)
        dx, dy, reach = px - x, py - y, walkers.radii[p] + nearby.margin
        away = dx * dx + dy * dy
        if not away < (body.radius + reach) ** 2:
            continue  # far away, or absent
        if away < (body.inscribed + reach) ** 2 or len(body.corners) == 0:
            return False
        c, s = math.cos(theta), math.sin(theta)
        if _gap_to_outline(body.corners, c * dx + s * dy, c * dy - s * dx) < reach:
            return False
    return True


@inner
def _gap_to_outline(corners: Floats, x: float, y: float) -> float:
    """Return how far a point is from a convex outline, counter-clockwise; 0 inside."""
    nearest, inside, before = np.inf, True, len(corners) - 1
    for i in range(len(corners)):
        ax, ay = corners[before, 0], corners[before, 1]
        dx, dy = corners[i, 0] - ax, corners[i, 1] - ay
        inside &= dx * (y - ay) - dy * (x - ax) >= 0.0
        along = min(max(((x - ax) * dx + (y - ay) * dy) / (dx * dx + dy * dy), 0.0), 1.0)
        nearest = min(nearest, (x - ax - along * dx) ** 2 + (y - ay - along * dy) ** 2)
        before = i
    return 0.0 if inside else math.sqrt(nearest)
