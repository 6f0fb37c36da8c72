"""How far predictions were from what people then did, and whether they were as sure as they should have been."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from arena_core import Predictions

Floats = NDArray[np.float64]
SUREST = 0.05  # m, the least standard deviation that a likelihood is taken with: a tracker's error of place
SHARES = (0.5, 0.9)  # of the truth that ellipses of these shares should hold


@dataclass(frozen=True, slots=True, eq=False)
class Scores:
    """Of N tracks at T times: ``errors`` (N, T) m of the most probable hypothesis, ``least`` (N, T) m of the hypothesis
    that is best on the whole, ``surprise`` (N, T) nats, and ``depths`` (N, T): the share of the ellipse that the truth
    lies on the edge of.
    """

    errors: Floats
    least: Floats
    surprise: Floats
    depths: Floats


@dataclass(frozen=True, slots=True)
class Summary:
    """Means over all tracks: ``ade`` and ``fde`` m of the most probable hypothesis, over all times and at the last one,
    ``min_ade`` and ``min_fde`` of the best one, ``missed``: the share of tracks of which no hypothesis ends within the
    miss distance; ``nll`` nats; ``in_50`` and ``in_90``: the share of truths within the ellipses of 50 and 90 %.
    """

    tracks: int
    ade: float
    fde: float
    min_ade: float
    min_fde: float
    missed: float
    nll: float
    in_50: float
    in_90: float


def score_predictions(said: Predictions, times: Floats, truth: Floats) -> Scores:
    """Score what was said of K tracks against where their people were at ``times`` (T,), ``truth`` (K, T, 2) m."""
    off = truth - said.at(times)
    errors = np.hypot(off[..., 0], off[..., 1])
    others = [np.hypot(*np.moveaxis(truth - way, 2, 0)) for way in alternatives_at(said, times)]
    every = np.array([errors, *others])
    best = every.mean(axis=2).argmin(axis=0)
    least = every[best, np.arange(len(errors))]
    surprise, depths = _gaussian(off, covariances_at(said, times))
    return Scores(errors, least, surprise, depths)


def alternatives_at(said: Predictions, times: Floats) -> Floats:
    """Return the places of all hypotheses at ``times``, (M, K, T, 2) m."""
    known, ways = said.times, said.alternatives
    if not len(ways):
        return np.empty((0, len(said.means), len(times), 2))
    leg = np.clip(np.searchsorted(known, times, "right") - 1, 0, max(len(known) - 2, 0))
    if len(known) == 1:
        return np.asarray(ways[:, :, leg] + said.velocities[:, None] * times[:, None])
    share = ((times - known[leg]) / (known[leg + 1] - known[leg]))[:, None]  # beyond 1 after the last time
    return np.asarray(ways[:, :, leg] + share * (ways[:, :, leg + 1] - ways[:, :, leg]))


def covariances_at(said: Predictions, times: Floats) -> Floats:
    """Return how sure the most probable places at ``times`` are, (K, T, 2, 2) m^2."""
    known = said.times
    after = np.maximum(times - known[-1], 0.0)[:, None, None]
    place, both, speed = said.spreads[:, :2, :2], said.spreads[:, :2, 2:], said.spreads[:, 2:, 2:]
    both = both + both.swapaxes(1, 2)
    later: Floats = place[:, None] + after * both[:, None] + after**2 * speed[:, None]
    if len(known) == 1:
        return later
    leg = np.clip(np.searchsorted(known, times, "right") - 1, 0, len(known) - 2)
    share = np.clip((times - known[leg]) / (known[leg + 1] - known[leg]), 0.0, 1.0)[:, None, None]
    before = said.covariances[:, leg] + share * (said.covariances[:, leg + 1] - said.covariances[:, leg])
    return np.asarray(np.where((times > known[-1])[:, None, None], later, before))


def _gaussian(off: Floats, covariances: Floats) -> tuple[Floats, Floats]:
    """Return minus the logarithm of the density of errors (K, T, 2), and which share of the ellipse they lie on."""
    wide = covariances + SUREST**2 * np.eye(2)
    xx, xy, yy = wide[..., 0, 0], 0.5 * (wide[..., 0, 1] + wide[..., 1, 0]), wide[..., 1, 1]
    area = xx * yy - xy * xy
    x, y = off[..., 0], off[..., 1]
    squared = (yy * x * x - 2.0 * xy * x * y + xx * y * y) / area
    return 0.5 * squared + 0.5 * np.log(area) + math.log(2.0 * math.pi), 1.0 - np.exp(-0.5 * squared)


def join_scores(parts: list[Scores]) -> Scores:
    """Return the scores of all parts together."""
    return Scores(*(np.concatenate([getattr(part, each.name) for part in parts]) for each in fields(Scores)))


def summarise(scores: Scores, miss: float) -> Summary:
    """Return the means of scores; a track is missed whose hypotheses all end farther than ``miss`` m from the truth."""
    last = scores.least[:, -1]
    return Summary(
        len(scores.errors),
        float(scores.errors.mean()),
        float(scores.errors[:, -1].mean()),
        float(scores.least.mean()),
        float(last.mean()),
        float((last > miss).mean()),
        float(scores.surprise.mean()),
        *(float((scores.depths <= share).mean()) for share in SHARES),
    )
