"""What a record holds only where it is asked for: the tracker's tracks, and what the planner
considered (docs/records.md).
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from arena_core.base.errors import InvalidCandidates
from arena_core.values.candidate import Candidate
from arena_core.values.sensing import NO_TRACKS, Tracks

MOST, LONGEST = 24, 16  # candidates that are kept of a step, points that are kept of a candidate
POINT_PLACES, TRACK_PLACES = 7, 10  # binary places that are kept, m and m/s
Arrays = dict[str, NDArray[np.generic]]


def kept_candidates(candidates: Sequence[Candidate] | None, planner: str) -> list[Candidate]:
    """Return those of a step's candidates that a record keeps, a chosen one first, each with as few points as it keeps.

    Raises InvalidCandidates where one of them is none.
    """
    given = [_check_candidate(candidate, planner) for candidate in candidates or ()]
    ranked = sorted(given, key=lambda one: (not one.chosen, math.isnan(one.cost), one.cost))
    kept = [ranked[k] for k in _evenly_spaced(len(ranked), MOST)]
    return [Candidate(one.points_xy[_evenly_spaced(len(one.points_xy), LONGEST)], one.cost, one.chosen) for one in kept]


def candidate_arrays(steps: Sequence[Sequence[Candidate]]) -> Arrays:
    """Return the ragged arrays of what was kept of each step."""
    flat = [candidate for step in steps for candidate in step]
    points = np.concatenate([one.points_xy for one in flat]) if flat else np.empty((0, 2))
    return {
        "considered_rows": np.cumsum([0, *map(len, steps)], dtype=np.int64),
        "considered_offsets": np.cumsum([0, *(len(one.points_xy) for one in flat)], dtype=np.int64),
        "considered_points": _round_float32(points, POINT_PLACES),
        "considered_costs": np.array([one.cost for one in flat], dtype=np.float32),
        "considered_chosen": np.array([one.chosen for one in flat], dtype=np.bool_),
    }


def track_arrays(steps: Sequence[Tracks | None]) -> Arrays:
    """Return the ragged arrays of the tracks of each step; there are none where no one asked for them."""
    known = [NO_TRACKS if tracks is None else tracks for tracks in steps] or [NO_TRACKS]
    return {
        "track_rows": np.cumsum([0, *(len(tracks.ids) for tracks in known[: len(steps)])], dtype=np.int64),
        "track_ids": np.concatenate([tracks.ids for tracks in known]).astype(np.int32),
        "track_positions": _round_float32(np.concatenate([tracks.positions for tracks in known]), TRACK_PLACES),
        "track_velocities": _round_float32(np.concatenate([tracks.velocities for tracks in known]), TRACK_PLACES),
        "track_radii": _round_float32(np.concatenate([tracks.radii for tracks in known]), TRACK_PLACES),
    }


def _check_candidate(candidate: object, planner: str) -> Candidate:
    if not isinstance(candidate, Candidate):
        raise InvalidCandidates(f"{planner}.considered returned {type(candidate).__name__}; allowed: Candidates")
    points = np.asarray(candidate.points_xy)
    if points.ndim != 2 or points.shape[1] != 2 or points.dtype.kind not in "fiu" or not np.isfinite(points).all():
        raise InvalidCandidates(
            f"{planner}.considered returned points {points.dtype} {points.shape}; allowed: (M, 2), finite"
        )
    return Candidate(points.astype(np.float64), float(candidate.cost), bool(candidate.chosen))


def _evenly_spaced(count: int, most: int) -> NDArray[np.int64]:
    """Return which of ``count`` are kept: all, or the first, the last and others at even distances."""
    return (
        np.unique(np.linspace(0, count - 1, min(count, most)).round().astype(np.int64))
        if count
        else np.empty(0, np.int64)
    )


def _round_float32(values: NDArray[np.float64], places: int) -> NDArray[np.float32]:
    return (np.ldexp(np.rint(np.ldexp(values, places)), -places) + 0.0).astype(np.float32)
