"""Motions between two poses: whether the body can make them, what they cost, and the poses along them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arena_kernels.compiled import borrowing, inner
from arena_ompl.curves import Pieces, pose_along, shortest_curve
from arena_ompl.ground import Discs, Field, body_clearance, interpolate_field

Poses = NDArray[np.float64]
PlanarPose = Sequence[float]  # x, y (m), heading (rad)
Figures = NDArray[np.float64]

# of the clearance, less a cell, that is driven before the next look: the field falls by at most sqrt(2) per metre
_LEAP = 0.7
_LEAST_LEAP = 0.125  # cells
_STEP = 0.4  # of an elastic band's unbalanced force that a point gives way to at once
_NOTHING = 1e-9  # m: shorter pieces of curves are none


class Rules(NamedTuple):
    """What a query's motions are judged by.

    ``field``, ``prices`` and ``discs`` are those of ``ground``, ``resolution`` is a cell's side, m. A metre costs what
    it does under the middle disc. Within ``reach`` m of the start (x, y) the body may come as near to obstacles as a
    clearance of ``allowed`` m, which is not positive. ``kind`` (of ``curves``) and turning ``radius`` (m) are those of
    the curve that joins two poses.
    """

    field: Field
    prices: Field
    discs: Discs
    resolution: float
    reach: float
    allowed: float
    start_x: float
    start_y: float
    kind: float
    radius: float


class Motions:
    """The kernels below under one set of rules; counts what it was asked."""

    def __init__(self, rules: Rules) -> None:
        self.rules = rules
        self.evaluations = 0
        # numbers go in one array, arrays by themselves: to unpack a named tuple takes longer than to check a motion
        self._rules = rules.field, rules.prices, rules.discs, np.array(rules[3:], np.float64), np.empty((5, 2))

    def is_free(self, x: float, y: float, theta: float) -> bool:
        """Return whether the body may be at a pose."""
        self.evaluations += 1
        return is_free(*self._rules, x, y, theta)

    def can_move(self, first: PlanarPose, second: PlanarPose) -> bool:
        """Return whether the body can make the motion between two poses."""
        self.evaluations += 1
        return can_move(*self._rules, *first, *second)

    def cost(self, first: PlanarPose, second: PlanarPose) -> float:
        """Return what the motion between two poses costs, m."""
        self.evaluations += 1
        return motion_cost(*self._rules, *first, *second)

    def poses(self, path: Poses, spacing: float) -> Poses:
        """Return poses (M, 3) at most ``spacing`` m apart along the motions that join those of a path (K, 3)."""
        poses = np.empty((poses_along(*self._rules, path, spacing, np.empty((0, 3))), 3))
        poses_along(*self._rules, path, spacing, poses)
        return poses

    def shorten(self, path: Poses) -> Poses:
        """Return the cheapest of the paths that leave out some poses of a path (K, 3)."""
        before = np.empty(len(path), np.int64)
        cheapest_chain(*self._rules, path, np.empty(len(path)), before)
        chain = [len(path) - 1]
        while chain[-1] > 0:
            chain.append(int(before[chain[-1]]))
        return path[chain[::-1]]

    def relax(self, path: Poses, rounds: int) -> Poses:
        """Return a path of straight lines (K, 3) pulled tight and away from obstacles; its ends stay."""
        relaxed = path.copy()
        relax_path(*self._rules, relaxed, rounds)
        return relaxed


@inner
def _make_rules(field: Field, prices: Field, discs: Discs, figures: Figures) -> Rules:
    f = figures
    return Rules(field, prices, discs, f[0], f[1], f[2], f[3], f[4], f[5], f[6])


@inner
def _required_clearance(rules: Rules, x: float, y: float) -> float:
    """Return the clearance that is asked of a pose, m."""
    near = rules.reach > 0.0 and math.hypot(x - rules.start_x, y - rules.start_y) <= rules.reach
    return rules.allowed if near else 0.0


@borrowing
def is_free(
    field: Field, prices: Field, discs: Discs, figures: Figures, pieces: Pieces, x: float, y: float, theta: float
) -> bool:
    """Return whether the body may be at a pose."""
    rules = _make_rules(field, prices, discs, figures)
    return bool(body_clearance(field, discs, rules.resolution, (x, y, theta)) > _required_clearance(rules, x, y))


@borrowing
def can_move(
    field: Field,
    prices: Field,
    discs: Discs,
    figures: Figures,
    pieces: Pieces,
    x0: float,
    y0: float,
    theta0: float,
    x1: float,
    y1: float,
    theta1: float,
) -> bool:
    """March along the motion between two poses, as far each time as the clearance surely allows;
    False where it is blocked.
    """
    rules = _make_rules(field, prices, discs, figures)
    heading = shortest_curve(int(rules.kind), rules.radius, (x0, y0, theta0), (x1, y1, theta1), pieces)
    return _is_curve_free(rules, pieces, x0, y0, heading)


@inner
def _is_curve_free(rules: Rules, pieces: Pieces, x: float, y: float, theta: float) -> bool:
    # how much farther than the origin a disc moves on the narrowest turn
    swing = _disc_reach(rules.discs) / rules.radius
    for k in range(len(pieces)):
        length = abs(pieces[k, 1])
        if length < _NOTHING and k > 0:
            continue
        done = 0.0
        while True:
            px, py, heading = pose_along(rules.radius, (x, y, theta), pieces[k, 0], math.copysign(done, pieces[k, 1]))
            clear = body_clearance(rules.field, rules.discs, rules.resolution, (px, py, heading))
            spare = clear - _required_clearance(rules, px, py)
            if spare <= 0.0:
                return False
            if done >= length:
                break
            leap = _LEAP * (min(spare, abs(clear)) - rules.resolution)
            done = min(done + max(leap / (1.0 + swing), _LEAST_LEAP * rules.resolution), length)
        x, y, theta = px, py, heading
    return True


@inner
def _disc_reach(discs: Discs) -> float:
    """Return how far from the origin the farthest disc's centre is, m."""
    farthest = 0.0
    for i in range(len(discs)):
        farthest = max(farthest, math.hypot(discs[i, 0], discs[i, 1]))
    return farthest


@borrowing
def motion_cost(
    field: Field,
    prices: Field,
    discs: Discs,
    figures: Figures,
    pieces: Pieces,
    x0: float,
    y0: float,
    theta0: float,
    x1: float,
    y1: float,
    theta1: float,
) -> float:
    """Return the integral of the price along the motion between two poses."""
    rules = _make_rules(field, prices, discs, figures)
    heading = shortest_curve(int(rules.kind), rules.radius, (x0, y0, theta0), (x1, y1, theta1), pieces)
    return _cost_integral(rules, pieces, x0, y0, heading)


@inner
def _cost_integral(rules: Rules, pieces: Pieces, x: float, y: float, theta: float) -> float:
    """Sum the price in the middles of steps of about two cells.

    The price is interpolated: on the border of two cells rounding alone would choose one, and not the same there as
    back.
    """
    middle = len(rules.discs) // 2
    ahead, aside = rules.discs[middle, 0], rules.discs[middle, 1]
    total = 0.0
    for k in range(len(pieces)):
        length = abs(pieces[k, 1])
        if length < _NOTHING:
            continue
        steps = math.ceil(0.5 * length / rules.resolution)
        step, turning = pieces[k, 1] / steps, pieces[k, 0] / rules.radius
        c, s = math.cos(theta), math.sin(theta)
        for i in range(steps):
            done = (i + 0.5) * step
            px, py = x + done * c, y + done * s
            if turning != 0.0:
                px, py, heading = pose_along(rules.radius, (x, y, theta), pieces[k, 0], done)
                c, s = math.cos(heading), math.sin(heading)
            total += abs(step) * interpolate_field(
                rules.prices, rules.resolution, px + ahead * c - aside * s, py + ahead * s + aside * c
            )
        x, y, theta = pose_along(rules.radius, (x, y, theta), pieces[k, 0], pieces[k, 1])
    return total


@borrowing
def poses_along(
    field: Field,
    prices: Field,
    discs: Discs,
    figures: Figures,
    pieces: Pieces,
    path: Poses,
    spacing: float,
    poses: Poses,
) -> int:
    """Divide every piece of every motion evenly, its ends included; return how many poses that
    makes, and write as many as fit.
    """
    rules = _make_rules(field, prices, discs, figures)
    count = 0
    _write_pose(poses, count, path[0, 0], path[0, 1], path[0, 2])
    for i in range(1, len(path)):
        theta = _shortest_between(rules, path, i - 1, i, pieces)
        x, y = path[i - 1, 0], path[i - 1, 1]
        for k in range(len(pieces)):
            parts = _part_count(abs(pieces[k, 1]), spacing)
            px, py, heading = x, y, theta
            for part in range(1, parts + 1):
                px, py, heading = pose_along(rules.radius, (x, y, theta), pieces[k, 0], pieces[k, 1] * part / parts)
                count += 1
                _write_pose(poses, count, px, py, heading)
            x, y, theta = px, py, heading
    _write_pose(poses, count, path[-1, 0], path[-1, 1], theta)
    return count + 1


@inner
def _write_pose(poses: Poses, i: int, x: float, y: float, theta: float) -> None:
    if i < len(poses):
        poses[i, 0], poses[i, 1], poses[i, 2] = x, y, theta


@inner
def _shortest_between(rules: Rules, path: Poses, i: int, j: int, pieces: Pieces) -> float:
    kind, radius = int(rules.kind), rules.radius
    return shortest_curve(
        kind, radius, (path[i, 0], path[i, 1], path[i, 2]), (path[j, 0], path[j, 1], path[j, 2]), pieces
    )


@inner
def _part_count(length: float, spacing: float) -> int:
    return 0 if length < _NOTHING else max(1, math.ceil(length / spacing - _NOTHING))


@borrowing
def cheapest_chain(
    field: Field,
    prices: Field,
    discs: Discs,
    figures: Figures,
    pieces: Pieces,
    path: Poses,
    costs: NDArray[np.float64],
    before: NDArray[np.int64],
) -> None:
    """Write, for each pose of a path (K, 3), the cost (K,) of the cheapest chain of motions to it and the pose before
    it there (K,).

    Each pose may be followed by any later one that a free motion leads to, and always by the next: dynamic programming
    over all pairs.
    """
    rules = _make_rules(field, prices, discs, figures)
    costs[0], before[0] = 0.0, -1
    for j in range(1, len(path)):
        costs[j] = math.inf
        for i in range(j - 1, -1, -1):
            if costs[i] + math.hypot(path[j, 0] - path[i, 0], path[j, 1] - path[i, 1]) > costs[j] + _NOTHING:
                continue
            heading = _shortest_between(rules, path, i, j, pieces)
            total = costs[i] + _cost_integral(rules, pieces, path[i, 0], path[i, 1], heading)
            if total <= costs[j] + _NOTHING and (
                i == j - 1 or _is_curve_free(rules, pieces, path[i, 0], path[i, 1], heading)
            ):
                costs[j], before[j] = total, i


@borrowing
def relax_path(
    field: Field, prices: Field, discs: Discs, figures: Figures, pieces: Pieces, path: Poses, rounds: int
) -> None:
    """Move every inner point of a path of straight lines towards the cheapest curve nearby, round by round, where it
    stays free.

    An elastic band (Quinlan and Khatib, ICRA 1993): a point is pulled by its neighbours and pushed off by the slope of
    the price.
    """
    rules = _make_rules(field, prices, discs, figures)
    for _ in range(rounds):
        for i in range(1, len(path) - 1):
            x, y = path[i, 0], path[i, 1]
            dx, dy = path[i + 1, 0] - path[i - 1, 0], path[i + 1, 1] - path[i - 1, 1]
            push_x, push_y = _cost_slope(rules, x, y, dx, dy)
            square = 0.25 * (dx * dx + dy * dy)
            path[i, 0] += _STEP * (path[i - 1, 0] + path[i + 1, 0] - 2.0 * x + square * push_x)
            path[i, 1] += _STEP * (path[i - 1, 1] + path[i + 1, 1] - 2.0 * y + square * push_y)
            free = True
            for j in range(i, i + 2):
                heading = _shortest_between(rules, path, j - 1, j, pieces)
                free = free and _is_curve_free(rules, pieces, path[j - 1, 0], path[j - 1, 1], heading)
            if not free:
                path[i, 0], path[i, 1] = x, y


@inner
def _cost_slope(rules: Rules, x: float, y: float, dx: float, dy: float) -> tuple[float, float]:
    """Return minus the slope of the logarithm of the price, across the direction (dx, dy), 1/m."""
    prices, h = rules.prices, rules.resolution
    price = interpolate_field(prices, h, x, y)
    gx = (interpolate_field(prices, h, x - h, y) - interpolate_field(prices, h, x + h, y)) / (2.0 * h * price)
    gy = (interpolate_field(prices, h, x, y - h) - interpolate_field(prices, h, x, y + h)) / (2.0 * h * price)
    square = dx * dx + dy * dy
    along_it = (gx * dx + gy * dy) / square if square > 0.0 else 0.0
    return gx - along_it * dx, gy - along_it * dy
