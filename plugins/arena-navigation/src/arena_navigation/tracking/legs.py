"""Two legs of one person are one body."""

from __future__ import annotations

import math
from typing import NamedTuple

from arena_kernels.compiled import inner
from arena_kernels.scalars import Integer
from arena_navigation.columns import BEGIN, END, X, Y
from arena_navigation.tracking.clusters import Pieces, Segments
from arena_navigation.tracking.returns import Returns


class Legs(NamedTuple):
    """A piece up to ``width`` m wide shows a leg, or two that stand together; legs up to ``apart`` m from each other
    are one person's.

    With ``apart`` 0 nothing is a leg.
    """

    width: float
    apart: float


@inner
def join_legs(  # type: ignore[no-untyped-def]
    segments: Segments, count: Integer, legs: Legs, radii: tuple[float, float], discs
) -> Integer:
    """Put one body of ``radius`` m in the place of each two legs, and of each that is alone; return how many bodies
    there are then.

    The body is in the middle of its legs. Where one hides the other it may be beside the one that is seen, by a quarter
    of ``apart``.
    """
    if legs.apart <= 0.0:
        return count
    kept: Integer = segments.pieces.ends[0, BEGIN] * 0
    for k in range(count):
        if segments.pieces.ends[k, BEGIN] == segments.pieces.ends[k, END]:
            continue  # it is a leg of a body before
        if _is_leg(segments.returns, segments.pieces, k, legs):
            _write_body(discs, k, _other_leg(segments, k, count, legs, discs), segments.pieces, legs, radii)
        _move_disc(discs, k, kept)
        kept += 1
    return kept


@inner
def _move_disc(discs, k: Integer, to: Integer) -> None:  # type: ignore[no-untyped-def]
    discs.radii[to], discs.radius_variances[to] = discs.radii[k], discs.radius_variances[k]
    discs.round[to], discs.standing[to] = discs.round[k], discs.standing[k]
    for axis in range(2):
        discs.positions[to, axis], discs.leanings[to, axis] = discs.positions[k, axis], discs.leanings[k, axis]
        for column in range(2):
            discs.covariances[to, axis, column] = discs.covariances[k, axis, column]


@inner
def _is_leg(returns: Returns, pieces: Pieces, k: Integer, legs: Legs) -> bool:
    first, last = pieces.beams[pieces.ends[k, BEGIN]], pieces.beams[pieces.ends[k, END] - 1]
    return math.hypot(returns.x[last] - returns.x[first], returns.y[last] - returns.y[first]) <= legs.width


@inner
def _other_leg(  # type: ignore[no-untyped-def]
    segments: Segments, k: Integer, count: Integer, legs: Legs, discs
) -> Integer:
    """Return the nearest leg among the pieces behind k that is near enough to be the same
    person's, -1 where there is none.
    """
    other, nearest = -1, legs.apart
    for j in range(k + 1, count):
        if segments.pieces.ends[j, BEGIN] < segments.pieces.ends[j, END] and _is_leg(
            segments.returns, segments.pieces, j, legs
        ):
            away = math.hypot(
                discs.positions[j, X] - discs.positions[k, X], discs.positions[j, Y] - discs.positions[k, Y]
            )
            if away < nearest:
                other, nearest = j, away
    return other


@inner
def _write_body(  # type: ignore[no-untyped-def]
    discs, k: Integer, other: Integer, pieces: Pieces, legs: Legs, radii: tuple[float, float]
) -> None:
    """Write the body of leg k, and of the ``other`` one (-1: none in sight), in place k."""
    radius, radius_std = radii
    discs.radii[k], discs.radius_variances[k] = radius, radius_std**2  # legs do not tell how wide a body is
    discs.leanings[k, X], discs.leanings[k, Y] = 0.0, 0.0
    discs.round[k] = 1
    if other < 0:
        for axis in range(2):
            discs.covariances[k, axis, axis] += (0.25 * legs.apart) ** 2
        return
    for axis in range(2):
        discs.positions[k, axis] = 0.5 * (discs.positions[k, axis] + discs.positions[other, axis])
        for column in range(2):
            discs.covariances[k, axis, column] = 0.5 * (
                discs.covariances[k, axis, column] + discs.covariances[other, axis, column]
            )
    discs.standing[k] &= discs.standing[other]
    pieces.ends[other, END] = pieces.ends[other, BEGIN]
