"""The disc of which a piece shows an arc: centre and radius with their covariance."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arena_kernels.compiled import borrowing, inner
from arena_kernels.scalars import Integer
from arena_navigation.columns import BEGIN, END, THETA, X, Y
from arena_navigation.local_map.marks import PlacedScan
from arena_navigation.tracking.clusters import Cut, Pieces, Segments, cut_pieces, full_circle
from arena_navigation.tracking.legs import Legs, join_legs
from arena_navigation.tracking.returns import NEW, OLD, PastScans, Returns, ReturnTolerance, note_unknown

_STEPS = 8  # of Gauss-Newton at most; three are usual
_CONVERGED = 1e-5  # m
_HARDLY = 0.1


class Shape(NamedTuple):
    """What is known of bodies before they are seen: radii (m), the noise of ranges (m), and when
    an arc is no arc (rms, m).
    """

    radius: float
    radius_std: float
    radius_min: float
    radius_max: float
    noise: float
    misfit: float


class PoseNoise(NamedTuple):
    """Standard deviations of the robot's own pose from scan to scan: ``position`` m, ``heading`` rad."""

    position: float
    heading: float


class Discs(NamedTuple):
    """Bodies as one scan shows them, in ``map``: positions (M, 2), covariances (M, 2, 2), radii (M,), radius_variances
    (M,).

    ``leanings`` (M, 2) is the covariance of position and radius: a larger disc lies farther away. ``round`` (M,): it
    looks like a disc; ``standing`` (M,): it is where it was in past scans.
    """

    positions: NDArray[np.float64]
    covariances: NDArray[np.float64]
    radii: NDArray[np.float64]
    radius_variances: NDArray[np.float64]
    leanings: NDArray[np.float64]
    round: NDArray[np.uint8]
    standing: NDArray[np.uint8]

    @staticmethod
    def room(count: int) -> Discs:
        """Return room for so many bodies."""
        flags = np.zeros((2, count), np.uint8)
        return Discs(
            np.zeros((count, 2)),
            np.zeros((count, 2, 2)),
            np.zeros(count),
            np.zeros(count),
            np.zeros((count, 2)),
            flags[0],
            flags[1],
        )

    def first(self, count: int) -> Discs:
        """Return views of the first ``count`` bodies."""
        return Discs._make(values[:count] for values in self)


class BodyRules(NamedTuple):
    """What a body is: returns up to ``farthest`` m, those within ``body`` m of the robot's centre left out,
    and the steps' own figures.
    """

    farthest: float
    body: float
    doubt: ReturnTolerance
    cut: Cut
    shape: Shape
    pose_doubt: PoseNoise
    legs: Legs


class Scratch(NamedTuple):
    """What the steps write, one after the other."""

    returns: Returns
    pieces: Pieces
    discs: Discs

    @staticmethod
    def room(beams: int) -> Scratch:
        """Return room for scans of so many beams."""
        return Scratch(Returns.room(beams), Pieces.room(beams), Discs.room(beams))


@inner
def first_discs(discs: Discs, count: Integer) -> Discs:
    """Return views of the first ``count`` bodies, in a kernel."""
    return Discs(
        discs.positions[:count],
        discs.covariances[:count],
        discs.radii[:count],
        discs.radius_variances[:count],
        discs.leanings[:count],
        discs.round[:count],
        discs.standing[:count],
    )


@borrowing
def find_discs(
    beams: PlacedScan, past: PastScans, tracks: NDArray[np.float64], rules: BodyRules, scratch: Scratch
) -> Integer:
    """Write the bodies that the map does not explain and return their number; returns are placed,
    ``tracks`` as in ``note_unknown``.
    """
    note_unknown(beams, past, tracks, rules.doubt, rules.farthest, rules.body, scratch.returns)
    count = cut_pieces(beams, scratch.returns, rules.cut, scratch.pieces)
    for k in range(count):
        fit_disc(beams, scratch.returns, scratch.pieces, k, rules.cut.gap, rules.shape, rules.pose_doubt, scratch.discs)
        scratch.discs.standing[k] = _is_standing(scratch.returns, scratch.pieces, k, rules.cut.least)
    return join_legs(
        Segments(scratch.returns, scratch.pieces),
        count,
        rules.legs,
        (rules.shape.radius, rules.shape.radius_std),
        scratch.discs,
    )


@inner
def fit_disc(
    beams: PlacedScan,
    returns: Returns,
    pieces: Pieces,
    k: Integer,
    gap: float,
    shape: Shape,
    pose_doubt: PoseNoise,
    discs: Discs,
) -> None:
    """Write the most likely disc behind piece ``k``, by Gauss-Newton over centre and radius.

    Its returns lie on the circle, the radius is about the expected one, and beyond an edge of the piece where the next
    beam goes on, the middle between the two beams touches the circle: this is what tells the radius of a short arc, and
    with it the centre.
    """
    begin, end = pieces.ends[k, BEGIN], pieces.ends[k, END]
    first, last = pieces.beams[begin], pieces.beams[end - 1]
    right = _passes_behind(beams, first, -1, gap)
    left = _passes_behind(beams, last, 1, gap)
    x, y = 0.0, 0.0
    for i in range(begin, end):
        x += returns.x[pieces.beams[i]]
        y += returns.y[pieces.beams[i]]
    x, y = x / (end - begin), y / (end - begin)
    away = math.hypot(x, y)
    x, y, radius = x * (1.0 + 0.5 * shape.radius / away), y * (1.0 + 0.5 * shape.radius / away), shape.radius
    misfit = 0.0
    for _ in range(_STEPS):
        # normal equations a (symmetric, 3 x 3) d = b over x, y and radius
        weight = 1.0 / shape.radius_std**2
        axx, axy, ayy, axr, ayr, arr = 0.0, 0.0, 0.0, 0.0, 0.0, weight
        bx, by, br = 0.0, 0.0, weight * (shape.radius - radius)
        weight = 1.0 / shape.noise**2
        misfit = 0.0
        for i in range(begin, end):
            dx, dy = returns.x[pieces.beams[i]] - x, returns.y[pieces.beams[i]] - y
            to_centre = max(math.sqrt(dx * dx + dy * dy), 1e-9)
            nx, ny = dx / to_centre, dy / to_centre
            off = to_centre - radius
            misfit += off * off
            axx += weight * nx * nx
            axy += weight * nx * ny
            ayy += weight * ny * ny
            axr += weight * nx
            ayr += weight * ny
            arr += weight
            bx += weight * nx * off
            by += weight * ny * off
            br += weight * off
        spread = max(beams.angle_increment * math.sqrt(x * x + y * y) / math.sqrt(12.0), 0.5 * shape.noise)
        weight = 1.0 / spread**2
        for side in range(-1, 2, 2):
            if (side < 0 and not right) or (side > 0 and not left):
                continue
            beam = first if side < 0 else last
            angle = beams.sensor[THETA] + beams.angle_min + (beam + 0.5 * side) * beams.angle_increment
            nx, ny = side * math.sin(angle), -side * math.cos(angle)
            off = radius - (nx * x + ny * y)
            axx += weight * nx * nx
            axy += weight * nx * ny
            ayy += weight * ny * ny
            axr -= weight * nx
            ayr -= weight * ny
            arr += weight
            bx += weight * nx * off
            by += weight * ny * off
            br -= weight * off
        # the inverse, by cofactors
        cxx, cxy, cxr = ayy * arr - ayr * ayr, axr * ayr - axy * arr, axy * ayr - ayy * axr
        cyy, cyr, crr = axx * arr - axr * axr, axy * axr - axx * ayr, axx * ayy - axy * axy
        det = axx * cxx + axy * cxy + axr * cxr
        if not det > 0.0:
            break
        step_x = (cxx * bx + cxy * by + cxr * br) / det
        step_y = (cxy * bx + cyy * by + cyr * br) / det
        step_r = (cxr * bx + cyr * by + crr * br) / det
        x, y = x + step_x, y + step_y
        radius = min(max(radius + step_r, shape.radius_min), shape.radius_max)
        if abs(step_x) + abs(step_y) + abs(step_r) < _CONVERGED:
            break
    misfit = math.sqrt(misfit / (end - begin))
    discs.round[k] = misfit <= shape.misfit and det > 0.0
    if discs.round[k]:
        discs.covariances[k, X, X], discs.covariances[k, Y, Y] = cxx / det, cyy / det
        discs.covariances[k, X, Y] = cxy / det
        discs.leanings[k, X], discs.leanings[k, Y] = cxr / det, cyr / det
        discs.radii[k], discs.radius_variances[k] = radius, crr / det
    else:
        x, y = _write_middle(returns, pieces, k, shape, discs)
    _add_pose_noise(discs, k, x, y, pose_doubt)
    discs.positions[k, X], discs.positions[k, Y] = beams.sensor[X] + x, beams.sensor[Y] + y


@inner
def _is_standing(returns: Returns, pieces: Pieces, k: Integer, least: int) -> bool:
    """Return whether past scans saw piece k where it is now: at least ``least``
    returns are old, and hardly one is new.
    """
    old, new = 0, 0
    for i in range(pieces.ends[k, BEGIN], pieces.ends[k, END]):
        old += returns.past[pieces.beams[i]] == OLD
        new += returns.past[pieces.beams[i]] == NEW
    return old >= least and new <= _HARDLY * old


@inner
def _passes_behind(beams: PlacedScan, edge: Integer, step: int, gap: float) -> bool:
    """Return whether the beam beside an edge surely goes on behind it; one that hit nothing does only where
    the body is well in reach.
    """
    beside = edge + step
    if full_circle(beams):
        beside %= len(beams.ranges)
    if not 0 <= beside < len(beams.ranges):
        return False
    behind = beams.ranges[edge] + gap
    return bool(beams.ranges[beside] > behind and behind < beams.range_max)


@inner
def _write_middle(returns: Returns, pieces: Pieces, k: Integer, shape: Shape, discs: Discs) -> tuple[float, float]:
    """Describe what is no disc: the middle between its edges, uncertain by a quarter of its width."""
    first, last = pieces.beams[pieces.ends[k, BEGIN]], pieces.beams[pieces.ends[k, END] - 1]
    width = math.hypot(returns.x[last] - returns.x[first], returns.y[last] - returns.y[first])
    discs.covariances[k, X, X], discs.covariances[k, Y, Y] = (0.25 * width) ** 2, (0.25 * width) ** 2
    discs.covariances[k, X, Y] = 0.0
    discs.leanings[k, X], discs.leanings[k, Y] = 0.0, 0.0
    discs.radii[k], discs.radius_variances[k] = (
        min(max(0.5 * width, shape.radius_min), shape.radius_max),
        shape.radius_std**2,
    )
    return 0.5 * (returns.x[first] + returns.x[last]), 0.5 * (returns.y[first] + returns.y[last])


@inner
def _add_pose_noise(discs: Discs, k: Integer, x: float, y: float, doubt: PoseNoise) -> None:
    """Add what the robot's own position and heading leave open."""
    discs.covariances[k, X, X] += doubt.position**2 + doubt.heading**2 * y * y
    discs.covariances[k, Y, Y] += doubt.position**2 + doubt.heading**2 * x * x
    discs.covariances[k, X, Y] -= doubt.heading**2 * x * y
    discs.covariances[k, Y, X] = discs.covariances[k, X, Y]
