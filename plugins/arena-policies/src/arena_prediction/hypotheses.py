"""What a network's answers mean: several ways of each track, how likely each is, and how sure."""

from __future__ import annotations

from math import exp
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arena_core import Predictions, Tracks
from arena_kernels.compiled import TypedDispatch, borrowing, inner

Floats = NDArray[np.float64]
Singles = NDArray[np.float32]

SCALE_TIME = 0.5  # s: at t s an answer of 1 is the track's speed scale times t + SCALE_TIME, m
WIDEST = 4.0  # logarithm of a standard deviation on that scale, at most and at least


def answer_size(hypotheses: int, steps: int) -> int:
    """Return how many numbers a network answers for a track: weights, then the ways, then how sure they are."""
    return hypotheses * (1 + 4 * steps)


class Guesses(NamedTuple):
    """What is expected of K tracks at H times, the first of them now: ``means`` (K, H, 2), ``covariances`` (K, H, 2,
    2), and from then on ``velocities`` (K, 2) and ``spreads`` (K, 4, 4); ``alternatives`` (M, K, H, 2), ``weights`` (M,
    K).
    """

    means: Floats
    covariances: Floats
    velocities: Floats
    spreads: Floats
    alternatives: Floats
    weights: Floats


class Answered(NamedTuple):
    """What was answered of K tracks: their ``places`` and ``velocities`` (K, 2), ``covariances`` (K, 4, 4) and
    ``frames`` (K, 4), the ``answers`` (K, A), the ``times`` (H,) that they are about and the ``widths`` (H,) by which
    deviations are multiplied. The most probable way is off the straight line by a share ``trust`` of what it says.
    """

    places: Floats
    velocities: Floats
    covariances: Floats
    frames: Floats
    answers: Singles
    times: Floats
    widths: Floats
    trust: float


class AnswerReader:
    """Turns answers into predictions at ``times`` (H,), the first of them 0 s; deviations are multiplied by
    ``widths`` (H,).
    """

    def __init__(self, times: Floats, hypotheses: int, widths: Floats) -> None:
        self._times, self._hypotheses, self._widths = times, hypotheses, widths
        self._read = TypedDispatch(read_answers)

    def predictions(self, tracks: Tracks, frames: Floats, answers: Singles, trust: float = 1.0) -> Predictions:
        """Return what ``answers`` (K, A) in ``frames`` (K, 4) mean for tracks, the most probable way by a share."""
        count, steps = len(tracks.ids), len(self._times)
        several = self._hypotheses
        guesses = Guesses(
            np.empty((count, steps, 2)),
            np.empty((count, steps, 2, 2)),
            np.empty((count, 2)),
            np.zeros((count, 4, 4)),
            np.empty((several, count, steps, 2)),
            np.empty((several, count)),
        )
        places, velocities = np.array(tracks.positions, np.float64), np.array(tracks.velocities, np.float64)
        covariances = np.array(tracks.covariances, np.float64)
        told = Answered(places, velocities, covariances, frames, answers, self._times, self._widths, trust)
        self._read(told, guesses)
        return Predictions(self._times, *guesses)


@borrowing
def read_answers(told: Answered, guesses: Guesses) -> None:
    """Write the ways of all hypotheses, the most probable one, and its mean square error if the mixture is right."""
    for k in range(len(told.places)):
        best = _write_weights(told.answers, guesses, k)
        for h in range(len(told.times)):
            _write_places(told, guesses, k, h, best)
            for i in range(2):
                guesses.means[k, h, i] = guesses.alternatives[best, k, h, i]
                for j in range(2):
                    guesses.covariances[k, h, i, j] = told.covariances[k, i, j]
            if h:
                _write_covariance(told, guesses, k, h)
        _write_onwards(guesses, k, told.times)


@inner
def _write_weights(answers: Singles, guesses: Guesses, k: int) -> int:
    """Write how likely each hypothesis is, and return the most probable one."""
    best, total = 0, 0.0
    for m in range(len(guesses.weights)):
        if answers[k, m] > answers[k, best]:
            best = m
    for m in range(len(guesses.weights)):
        guesses.weights[m, k] = exp(float(answers[k, m]) - float(answers[k, best]))
        total += guesses.weights[m, k]
    for m in range(len(guesses.weights)):
        guesses.weights[m, k] /= total
    return best


@inner
def _write_places(told: Answered, guesses: Guesses, k: int, h: int, best: int) -> None:
    """Write where each hypothesis is at a time: off where the track would be at its velocity."""
    several, steps, time, answers = len(guesses.weights), len(told.times) - 1, told.times[h], told.answers
    c, s, reach = told.frames[k, 0], told.frames[k, 1], told.frames[k, 2] * (time + SCALE_TIME)
    x, y = told.places[k, 0] + time * told.velocities[k, 0], told.places[k, 1] + time * told.velocities[k, 1]
    for m in range(several):
        u, v = 0.0, 0.0
        if h:
            at = several + 2 * (m * steps + h - 1)
            share = reach * (told.trust if m == best else 1.0)
            u, v = share * float(answers[k, at]), share * float(answers[k, at + 1])
        guesses.alternatives[m, k, h, 0], guesses.alternatives[m, k, h, 1] = x + c * u - s * v, y + s * u + c * v


@inner
def _write_covariance(told: Answered, guesses: Guesses, k: int, h: int) -> None:
    """Write the mean square error of the most probable place, over all hypotheses."""
    several, steps, answers, square = len(guesses.weights), len(told.times) - 1, told.answers, told.widths[h] ** 2
    c, s, reach = told.frames[k, 0], told.frames[k, 1], told.frames[k, 2] * (told.times[h] + SCALE_TIME)
    xx, xy, yy = 0.0, 0.0, 0.0
    for m in range(several):
        weight, at = guesses.weights[m, k], several + 2 * (several * steps + m * steps + h - 1)
        along = reach * reach * exp(2.0 * min(max(float(answers[k, at]), -WIDEST), WIDEST))
        across = reach * reach * exp(2.0 * min(max(float(answers[k, at + 1]), -WIDEST), WIDEST))
        dx = guesses.alternatives[m, k, h, 0] - guesses.means[k, h, 0]
        dy = guesses.alternatives[m, k, h, 1] - guesses.means[k, h, 1]
        xx += weight * (c * c * along + s * s * across + dx * dx)
        xy += weight * (c * s * (along - across) + dx * dy)
        yy += weight * (s * s * along + c * c * across + dy * dy)
    guesses.covariances[k, h, 0, 0], guesses.covariances[k, h, 1, 1] = square * xx, square * yy
    guesses.covariances[k, h, 0, 1] = guesses.covariances[k, h, 1, 0] = square * xy


@inner
def _write_onwards(guesses: Guesses, k: int, times: Floats) -> None:
    """Write with which velocity a track goes on after the last time: that of the last leg, over which its deviation has
    grown by a ``pace``, a share of it each second, as it goes on to.
    """
    last = len(times) - 1
    lapse = times[last] - times[last - 1]
    wide = guesses.covariances[k, last, 0, 0] + guesses.covariances[k, last, 1, 1]
    before = guesses.covariances[k, last - 1, 0, 0] + guesses.covariances[k, last - 1, 1, 1]
    pace = max(0.5 * (wide - before) / (lapse * max(wide, 1e-12)), 0.0)
    for i in range(2):
        guesses.velocities[k, i] = (guesses.means[k, last, i] - guesses.means[k, last - 1, i]) / lapse
        for j in range(2):
            square = guesses.covariances[k, last, i, j]
            guesses.spreads[k, i, j], guesses.spreads[k, i + 2, j + 2] = square, pace * pace * square
            guesses.spreads[k, i, j + 2] = guesses.spreads[k, i + 2, j] = pace * square
