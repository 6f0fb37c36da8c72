"""A robot's outline in its rolling window: how far it is from what stands there, and the window without what moves."""

from __future__ import annotations

import math
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from arena_kernels.compiled import borrowing
from arena_kernels.distance import distance_field

LETHAL = 254  # the cost of a cell that holds an obstacle, as in costmap_2d
HALF_DIAGONAL = 0.7072  # of a cell, rounded up
CLOSE = 0.02  # m, from which on a robot keeps the gap that it has, where it does not drive quite what was planned
NEARER = 0.005  # m, by which a robot that touches something may come nearer to it
BORDER = 0.3  # m, how far inside a robot's window the local goal of a planner lies
OUTLINE_SPACING = 0.05  # m, the side of a usual costmap cell: no cell slips between two points


Stand = tuple[float, float, float, float]  # x, y (m, map) and cosine and sine of the heading


class CostmapWindow(NamedTuple):
    """A rolling costmap, axis-aligned in ``map``: ``costs`` (H, W), ``distance`` (H, W) m, and its lower left corner,
    m.

    ``distance`` is that of a cell's centre to the nearest lethal cell's centre, infinite everywhere when no cell is
    lethal.
    """

    costs: NDArray[np.uint8]
    distance: NDArray[np.float32]
    resolution: float
    origin_x: float
    origin_y: float


class Outline(NamedTuple):
    """A footprint: points (S, 2) m along a polygon's edges, none for a circle, and its radii, m."""

    radius: float
    inscribed_radius: float
    points_xy: NDArray[np.float64]


class CostmapFields(Protocol):
    """What a window is made of: the fields of ``arena_core.Costmap``."""

    @property
    def costs(self) -> NDArray[np.uint8]:
        """The costs (H, W)."""

    @property
    def distance(self) -> NDArray[np.float32]:
        """The distances (H, W), m."""

    @property
    def resolution(self) -> float:
        """The side of a cell, m."""

    @property
    def origin_xy(self) -> NDArray[np.float64]:
        """The lower left corner (2,), m."""


class FootprintFields(Protocol):
    """What an outline is made of: the fields of ``arena_core.Footprint``."""

    @property
    def is_circle(self) -> bool:
        """Whether it is a circle."""

    @property
    def vertices_xy(self) -> NDArray[np.float64]:
        """A polygon's corners (N, 2), m."""

    @property
    def radius(self) -> float:
        """The radius of the circle about it, m."""

    @property
    def inscribed_radius(self) -> float:
        """The radius of the circle inside it, m."""


def window_of(costmap: CostmapFields) -> CostmapWindow:
    """Return a costmap as kernels take it."""
    x, y = costmap.origin_xy.tolist()
    costs, distance = np.ascontiguousarray(costmap.costs, np.uint8), np.ascontiguousarray(costmap.distance, np.float32)
    return CostmapWindow(costs, distance, float(costmap.resolution), x, y)


def footprint_outline(footprint: FootprintFields) -> Outline:
    """Return a robot's outline, with points ``OUTLINE_SPACING`` m apart at most."""
    vertices = None if footprint.is_circle else footprint.vertices_xy
    return outline_of(vertices, footprint.radius, footprint.inscribed_radius, OUTLINE_SPACING)


def outline_of(
    vertices_xy: NDArray[np.float64] | None, radius: float, inscribed_radius: float, spacing: float
) -> Outline:
    """Return a circle's outline, or a polygon's with points at most ``spacing`` m apart."""
    points = np.empty((0, 2)) if vertices_xy is None else points_along(vertices_xy, spacing)
    return Outline(float(radius), float(inscribed_radius), points)


def points_along(vertices_xy: NDArray[np.float64], spacing: float) -> NDArray[np.float64]:
    """Return points along a polygon's edges, at most ``spacing`` m apart, (S, 2)."""
    edges = zip(vertices_xy, np.roll(vertices_xy, -1, axis=0), strict=True)
    return np.concatenate([_edge_points(start, end, spacing) for start, end in edges])


def _edge_points(start: NDArray[np.float64], end: NDArray[np.float64], spacing: float) -> NDArray[np.float64]:
    parts = max(1, math.ceil(math.dist(start, end) / spacing))
    return np.linspace(start, end, parts, endpoint=False)


def without_discs(
    window: CostmapWindow, positions_xy: NDArray[np.float64], radii: NDArray[np.float64], margin: float
) -> CostmapWindow:
    """Return the window without the lethal cells of discs that are ``margin`` m larger than ``radii`` (K,) at
    ``positions_xy`` (K, 2).

    What a tracker follows as moving must not stand in the way as well. The distance field is made again; costs of the
    cells taken out are 0, those around them stay.
    """
    if len(radii) == 0:
        return window
    costs = window.costs.copy()
    if clear_discs(costs, window.resolution, window.origin_x, window.origin_y, positions_xy, radii, float(margin)) == 0:
        return window
    distance = distance_field(costs >= LETHAL, window.resolution)
    # as in the window that a planner is shown: kernels are compiled once
    costs.flags.writeable = distance.flags.writeable = False
    return window._replace(costs=costs, distance=distance)


@borrowing
def clear_discs(
    costs: NDArray[np.uint8],
    resolution: float,
    origin_x: float,
    origin_y: float,
    positions_xy: NDArray[np.float64],
    radii: NDArray[np.float64],
    margin: float,
) -> int:
    """Set the lethal cells whose square touches a disc to 0 and return how many there were."""
    rows, columns = costs.shape
    cleared = 0
    for k in range(len(radii)):
        reach = radii[k] + margin + HALF_DIAGONAL * resolution
        u, v = (positions_xy[k, 0] - origin_x) / resolution - 0.5, (positions_xy[k, 1] - origin_y) / resolution - 0.5
        cells = reach / resolution
        for row in range(max(0, math.ceil(v - cells)), min(rows - 1, math.floor(v + cells)) + 1):
            for column in range(max(0, math.ceil(u - cells)), min(columns - 1, math.floor(u + cells)) + 1):
                if costs[row, column] >= LETHAL and (row - v) ** 2 + (column - u) ** 2 <= cells**2:
                    costs[row, column] = 0
                    cleared += 1
    return cleared


@borrowing
def distance_at(window: CostmapWindow, x: float, y: float) -> float:
    """Return the distance from a position to the nearest lethal cell's edge, m, interpolated
    between cells; outside the window -inf.
    """
    rows, columns = window.distance.shape
    u, v = (x - window.origin_x) / window.resolution - 0.5, (y - window.origin_y) / window.resolution - 0.5
    if u < -0.5 or v < -0.5 or u >= columns - 0.5 or v >= rows - 0.5:
        return -math.inf
    if math.isinf(window.distance[0, 0]):  # a field is infinite everywhere or nowhere
        return math.inf
    column, row = min(max(int(u), 0), columns - 2), min(max(int(v), 0), rows - 2)
    u, v = min(max(u - column, 0.0), 1.0), min(max(v - row, 0.0), 1.0)
    below = window.distance[row, column] * (1.0 - u) + window.distance[row, column + 1] * u
    above = window.distance[row + 1, column] * (1.0 - u) + window.distance[row + 1, column + 1] * u
    return below * (1.0 - v) + above * v - 0.5 * window.resolution  # type: ignore[no-any-return]


@borrowing
def outline_clearance(window: CostmapWindow, outline: Outline, stand: Stand, enough: float) -> float:
    """Return how far an outline at a pose is from the nearest lethal cell, m, negative in collision, -inf with its
    middle outside.

    Beyond ``enough`` a lower bound will do, which spares the look along a polygon's edges.
    """
    x, y, cosine, sine = stand
    centre = distance_at(window, x, y)
    if len(outline.points_xy) == 0 or centre - outline.radius > enough:
        return centre - outline.radius
    least = centre - outline.inscribed_radius
    for i in range(len(outline.points_xy)):
        px, py = outline.points_xy[i]
        least = min(least, distance_at(window, x + cosine * px - sine * py, y + sine * px + cosine * py))
    return least


def close_gap(turn_radius: float) -> float:
    """Return the gap, m, from which on a robot comes no nearer: CLOSE, or 0 for a car, which has a turning radius (m).

    A car steers away from one wall by swinging its front towards the other: in a passage it needs what room there is.
    """
    return CLOSE if turn_radius == 0.0 else 0.0


@borrowing
def allowed_gap(now: float, wanted: float, close: float) -> float:
    """Return how near to an obstacle a motion may lead, m: the ``wanted`` gap, or less where the robot is nearer
    ``now``.

    One motion may use up half of a gap, down to ``close`` m; from there on the robot comes no nearer: what it drives is
    not quite what was planned. What touches, or seems to because a noisy scan marked the cell beside it, may come
    NEARER, so that it can turn away.
    """
    if now <= 0.0:
        return min(wanted, now - NEARER)
    return min(wanted, max(0.5 * now, min(close, 0.9 * now)))


@borrowing
def keeps_from_walls(
    window: CostmapWindow, outline: Outline, now: Stand, then: Stand, wanted: float, close: float
) -> bool:
    """Return whether an outline keeps the ``wanted`` gap, m, ``then``, or what is allowed from where it is ``now``.

    Where it touches something now it is judged point by point: a mark of noise at one corner must not let another
    corner touch a wall.
    """
    x, y, cosine, sine = then
    nearest = outline_clearance(window, outline, (now[0], now[1], now[2], now[3]), wanted)
    if nearest > 0.0:
        gap = outline_clearance(window, outline, (x, y, cosine, sine), wanted)
        return gap == -math.inf or gap >= allowed_gap(nearest, wanted, close)
    radius = outline.radius if len(outline.points_xy) == 0 else outline.inscribed_radius
    centre = distance_at(window, x, y) - radius
    if -math.inf < centre < allowed_gap(distance_at(window, now[0], now[1]) - radius, wanted, close):
        return False
    for i in range(len(outline.points_xy)):
        px, py = outline.points_xy[i]
        gap = distance_at(window, x + cosine * px - sine * py, y + sine * px + cosine * py)
        if -math.inf < gap < wanted:
            before = distance_at(window, now[0] + now[2] * px - now[3] * py, now[1] + now[3] * px + now[2] * py)
            if gap < allowed_gap(before, wanted, close):
                return False
    return True
