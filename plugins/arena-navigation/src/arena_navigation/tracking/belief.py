"""All tracks at one instant, and how their number changes: birth, joining, leaving."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from arena_kernels.compiled import borrowing, inner
from arena_kernels.scalars import Integer
from arena_navigation.columns import REACH, X, Y
from arena_navigation.tracking.discs import Discs
from arena_navigation.tracking.filter import VELOCITY, predict_tracks
from arena_navigation.tracking.visibility import GONE, SEEN

COUNT, NEXT_ID = 0, 1  # of the numbers of a belief


class Belief(NamedTuple):
    """Tracks in ``map``: ids (N,), states (N, 4) x, y, vx, vy, covariances (N, 4, 4), radii and their variances (N,).

    ``hits`` counts the scans that showed it, ``misses`` those since the last hit that should have; ``born_at`` and
    ``seen_at`` are the stamps of the first and the last hit. Of a room the first ``numbers[COUNT]`` rows are tracks;
    ``numbers[NEXT_ID]`` is the next one's id.
    """

    numbers: NDArray[np.int64]
    ids: NDArray[np.int32]
    states: NDArray[np.float64]
    covariances: NDArray[np.float64]
    radii: NDArray[np.float64]
    radius_variances: NDArray[np.float64]
    hits: NDArray[np.int64]
    misses: NDArray[np.int64]
    born_at: NDArray[np.float64]
    seen_at: NDArray[np.float64]

    @staticmethod
    def room(count: int) -> Belief:
        """Return room for so many tracks, and none in it."""
        radii, variances, born_at, seen_at = np.zeros((4, count))
        hits, misses = np.zeros((2, count), np.int64)
        states, covariances = np.zeros((count, 4)), np.zeros((count, 4, 4))
        ids = np.zeros(count, np.int32)
        return Belief(np.zeros(2, np.int64), ids, states, covariances, radii, variances, hits, misses, born_at, seen_at)

    def with_room(self, count: int) -> Belief:
        """Return the same tracks with room for so many."""
        larger = Belief.room(count)
        arrays: Iterable[tuple[NDArray[Any], NDArray[Any]]] = zip(self, larger, strict=True)
        for old, new in arrays:
            new[: len(old)] = old
        return larger


class PublishedTracks(NamedTuple):
    """The tracks that are told of: ids (K,), states (K, 4), covariances (K, 4, 4), radii (K,)."""

    ids: NDArray[np.int32]
    states: NDArray[np.float64]
    covariances: NDArray[np.float64]
    radii: NDArray[np.float64]

    @staticmethod
    def room(count: int) -> PublishedTracks:
        """Return room for so many."""
        return PublishedTracks(
            np.empty(count, np.int32), np.empty((count, 4)), np.empty((count, 4, 4)), np.empty(count)
        )


class LifeSpan(NamedTuple):
    """When a track is believed and when it ends, see ``tracker.Life``, and how fast new ones may be, m/s."""

    confirm_hits: int
    misses: int
    hidden_for: float
    position_variance: float
    speed_std: float
    standing_std: float


@inner
def present_tracks(belief: Belief) -> Belief:
    """Return the tracks without the room behind them."""
    n = belief.numbers[COUNT]
    return Belief(
        belief.numbers,
        belief.ids[:n],
        belief.states[:n],
        belief.covariances[:n],
        belief.radii[:n],
        belief.radius_variances[:n],
        belief.hits[:n],
        belief.misses[:n],
        belief.born_at[:n],
        belief.seen_at[:n],
    )


@inner
def write_bodies(tracks: Belief, margin: float, bodies: NDArray[np.float64]) -> None:
    """Write x, y and reach of all tracks, (N, 3)."""
    for k in range(len(tracks.ids)):
        bodies[k, X], bodies[k, Y], bodies[k, REACH] = (
            tracks.states[k, X],
            tracks.states[k, Y],
            tracks.radii[k] + margin,
        )


@inner
def end_tracks(belief: Belief, stamp: float, sight: NDArray[np.uint8], life: LifeSpan) -> None:
    """Count hits and misses by how each track was seen at ``stamp``, and drop those that have ended."""
    kept = 0
    for k in range(belief.numbers[COUNT]):
        if sight[k] == SEEN:
            belief.hits[k], belief.misses[k], belief.seen_at[k] = belief.hits[k] + 1, 0, stamp
        if sight[k] == GONE:
            belief.misses[k] += 1
        allowed = life.misses if belief.hits[k] >= life.confirm_hits else 1
        uncertain = max(belief.covariances[k, X, X], belief.covariances[k, Y, Y]) > life.position_variance
        hidden = stamp - belief.seen_at[k] > min(life.hidden_for, belief.seen_at[k] - belief.born_at[k])
        if belief.misses[k] >= allowed or hidden or uncertain:
            continue
        belief.ids[kept], belief.hits[kept], belief.misses[kept] = belief.ids[k], belief.hits[k], belief.misses[k]
        belief.radii[kept], belief.radius_variances[kept] = belief.radii[k], belief.radius_variances[k]
        belief.born_at[kept], belief.seen_at[kept] = belief.born_at[k], belief.seen_at[k]
        for row in range(4):
            belief.states[kept, row] = belief.states[k, row]
            for column in range(4):
                belief.covariances[kept, row, column] = belief.covariances[k, row, column]
        kept += 1
    belief.numbers[COUNT] = kept


@inner
def begin_tracks(belief: Belief, stamp: float, discs: Discs, taken: NDArray[np.uint8], life: LifeSpan) -> Integer:
    """Begin a resting track at every disc that is not ``taken`` and has its middle in no body that was seen now: that
    is its other side.

    Return how many tracks are told of then.
    """
    count, told = belief.numbers[COUNT], np.int64(0)
    for k in range(count):
        told += belief.hits[k] >= life.confirm_hits
        if belief.seen_at[k] == stamp:
            for m in range(len(discs.radii)):
                away = np.hypot(
                    discs.positions[m, X] - belief.states[k, X], discs.positions[m, Y] - belief.states[k, Y]
                )
                taken[m] |= away < belief.radii[k]
    for m in range(len(discs.radii)):
        if taken[m]:
            continue
        k = belief.numbers[COUNT]
        belief.ids[k] = belief.numbers[NEXT_ID]
        belief.numbers[COUNT], belief.numbers[NEXT_ID] = k + 1, belief.numbers[NEXT_ID] + 1
        speed_std = life.speed_std if discs.round[m] else life.standing_std
        belief.states[k], belief.covariances[k] = 0.0, 0.0
        for row in range(2):
            belief.states[k, row] = discs.positions[m, row]
            belief.covariances[k, VELOCITY + row, VELOCITY + row] = speed_std**2
            for column in range(2):
                belief.covariances[k, row, column] = discs.covariances[m, row, column]
        belief.radii[k], belief.radius_variances[k] = discs.radii[m], discs.radius_variances[m]
        belief.hits[k], belief.misses[k] = 1, 0
        belief.born_at[k], belief.seen_at[k] = stamp, stamp
        told += life.confirm_hits <= 1
    return told


@borrowing
def write_published(belief: Belief, confirm_hits: int, dt: float, density: float, written: PublishedTracks) -> None:
    """Write the tracks that are told of, moved by ``dt`` s as in ``predict_tracks``."""
    to = 0
    for k in range(belief.numbers[COUNT]):
        if belief.hits[k] < confirm_hits:
            continue
        written.ids[to], written.radii[to] = belief.ids[k], belief.radii[k]
        for row in range(4):
            written.states[to, row] = belief.states[k, row]
            for column in range(4):
                written.covariances[to, row, column] = belief.covariances[k, row, column]
        to += 1
    if dt > 0.0:
        predict_tracks(written.states, written.covariances, dt, density)
