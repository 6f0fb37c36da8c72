"""Cut the returns that count into pieces, each of them what one convex body shows of itself."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arena_kernels.compiled import inner
from arena_kernels.scalars import Integer
from arena_navigation.columns import BEGIN, END
from arena_navigation.local_map.marks import PlacedScan
from arena_navigation.tracking.returns import Returns


class Cut(NamedTuple):
    """Where one body ends: returns ``gap`` m and ``gap_beams`` times the beams' spacing apart, or a dent ``dent`` m
    deep.

    Pieces of fewer than ``least`` returns are dropped.
    """

    gap: float
    gap_beams: float
    dent: float
    least: int


class Pieces(NamedTuple):
    """Scratch space and result: ``beams`` (B,) that count, counter-clockwise; piece k is
    ``beams[ends[k, 0]:ends[k, 1]]``.
    """

    beams: NDArray[np.int64]
    ends: NDArray[np.int64]
    hull: NDArray[np.int64]

    @staticmethod
    def room(beams: int) -> Pieces:
        """Return room for so many beams."""
        return Pieces(np.zeros(beams, np.int64), np.zeros((beams + 1, 2), np.int64), np.zeros(beams, np.int64))


class Segments(NamedTuple):
    """The returns of a scan, and the pieces they are cut into."""

    returns: Returns
    pieces: Pieces


@inner
def full_circle(beams: PlacedScan) -> bool:
    """Return whether the first beam is the neighbour of the last one."""
    return bool(abs(len(beams.ranges) * beams.angle_increment - 2.0 * math.pi) < 0.5 * beams.angle_increment)


@inner
def cut_pieces(beams: PlacedScan, returns: Returns, cut: Cut, pieces: Pieces) -> Integer:
    """Write the pieces and return their number."""
    count = _order_beams(beams, returns, pieces)
    found: Integer = np.int64(0)
    start = 0
    for k in range(1, count + 1):
        if k < count and not _are_apart(beams, returns, pieces.beams[k - 1], pieces.beams[k], cut):
            continue
        found = _cut_at_dents(Segments(returns, pieces), start, k, cut, found)
        start = k
    return found


@inner
def _order_beams(beams: PlacedScan, returns: Returns, pieces: Pieces) -> Integer:
    """Write the beams that count, beginning behind a place where none does, so that
    nothing lies astride the first beam.
    """
    total = len(beams.ranges)
    first = 0
    if full_circle(beams):
        while first < total and returns.counts[first]:
            first += 1
    count = 0
    for step in range(total):
        beam = (first + step) % total
        if returns.counts[beam]:
            pieces.beams[count] = beam
            count += 1
    return count


@inner
def _are_apart(beams: PlacedScan, returns: Returns, one: Integer, other: Integer, cut: Cut) -> bool:
    """Return whether two successive returns belong to two bodies: far from each other, or with a
    beam between them that goes on.
    """
    dx, dy = returns.x[other] - returns.x[one], returns.y[other] - returns.y[one]
    near = min(beams.ranges[one], beams.ranges[other])
    far = max(beams.ranges[one], beams.ranges[other])
    if math.sqrt(dx * dx + dy * dy) > cut.gap + cut.gap_beams * beams.angle_increment * near:
        return True
    total = len(beams.ranges)
    between = (one + 1) % total
    while between != other:
        if beams.ranges[between] > far + cut.gap:
            return True
        between = (between + 1) % total
    return False


@inner
def _cut_at_dents(segments: Segments, start: Integer, end: Integer, cut: Cut, found: Integer) -> Integer:
    """Append [start, end), cut wherever it is dented: a convex body never is, two bodies beside each other are."""
    while end - start >= cut.least:
        dent = _first_dent(segments.returns, segments.pieces, start, end, cut.dent)
        stop = end if dent < 0 else dent
        if stop - start >= cut.least:
            segments.pieces.ends[found, BEGIN], segments.pieces.ends[found, END] = start, stop
            found += 1
        start = stop
    return found


@inner
def _first_dent(returns: Returns, pieces: Pieces, start: Integer, end: Integer, depth: float) -> Integer:
    """Return the deepest point of the first dent in the hull that faces the sensor (monotone
    chain), -1 if there is none.
    """
    hull, size = pieces.hull, 0
    for k in range(start, end):
        while (
            size >= 2
            and _cross_product(returns, pieces.beams[hull[size - 2]], pieces.beams[hull[size - 1]], pieces.beams[k])
            > 0.0
        ):
            size -= 1
        hull[size] = k
        size += 1
    for side in range(size - 1):
        a, b = pieces.beams[hull[side]], pieces.beams[hull[side + 1]]
        length = math.hypot(returns.x[b] - returns.x[a], returns.y[b] - returns.y[a])
        deepest, at = depth, -1
        for k in range(hull[side] + 1, hull[side + 1]):
            below = abs(_cross_product(returns, a, b, pieces.beams[k])) / max(length, 1e-9)
            if below > deepest:
                deepest, at = below, k
        if at >= 0:
            return at
    return -1


@inner
def _cross_product(returns: Returns, a: Integer, b: Integer, c: Integer) -> float:
    """Return the cross product of a->b and b->c: positive where the way turns left, which a
    convex body's front never does.
    """
    x1, y1 = returns.x[b] - returns.x[a], returns.y[b] - returns.y[a]
    x2, y2 = returns.x[c] - returns.x[b], returns.y[c] - returns.y[b]
    return float(x1 * y2 - y1 * x2)
