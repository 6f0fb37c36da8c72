"""How long what is left of a training's phase may take, by what its parts have taken: no word of it until there is
ground for one.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from math import ceil

import numpy as np
from numpy.typing import NDArray

KEPT = 300  # stretches of work, of which the latest two thirds count: in the first ones kernels are compiled
LEAST = 2  # stretches that an estimate needs, behind the first
UNKNOWN = 0.3  # share of an evaluation's episodes, at most, whose length nothing is known of yet
_LEAST_ENDED = 8  # episodes of an evaluation that have ended
_DRAWN = 100  # ways in which an evaluation may go on
_TAIL = 8  # lengths that stand for those that nothing is known of


class Pace:
    """What stretches of work have taken; the first does not count where it ``compiles``."""

    def __init__(self, *, compiles: bool = True) -> None:
        self._apart = int(compiles)
        self._seen = 0
        self._stretches: deque[tuple[float, float]] = deque(maxlen=KEPT)

    def add(self, seconds: float, work: float) -> None:
        """Take in that so much work took so long."""
        self._seen += 1
        if self._seen > self._apart:
            self._stretches.append((seconds, work))

    def seconds(self, work: float) -> float | None:
        """Return how long so much work may take, s, None where that cannot be told yet."""
        least = LEAST if self._apart else 1
        latest = list(self._stretches)[-max(least, ceil(len(self._stretches) * 2 / 3)) :]
        if len(latest) < least:
            return None
        return work * sum(taken for taken, _ in latest) / sum(done for _, done in latest)


class ImitationPace:
    """What lessons take: decisions, then learning from this lesson and all before it."""

    def __init__(self, rounds: int, decisions: int) -> None:
        self._rounds, self._decisions = rounds, decisions
        self._driving, self._learning = Pace(), Pace(compiles=False)

    def drove(self, seconds: float) -> None:
        """Take in that a decision took so long."""
        self._driving.add(seconds, 1.0)

    def learned(self, seconds: float, lessons: int) -> None:
        """Take in that learning from so many lessons took so long."""
        self._learning.add(seconds, lessons)

    def left(self, lesson: int, decisions: int) -> float | None:
        """Return how long it goes on, s, after so many ``decisions`` of the lesson of this number, from 1."""
        driving = self._driving.seconds((self._rounds - lesson + 1) * self._decisions - decisions)
        learning = self._learning.seconds(sum(range(lesson, self._rounds + 1)))
        return None if driving is None or learning is None else driving + learning


class RewardsPace:
    """What learning from rewards takes up to ``total`` steps: rollouts with their updates, and a validation every so
    many steps and at the end.
    """

    def __init__(self, steps: int, total: int, every: int) -> None:
        self._total, self._every = total, every
        self._steps = self._validated = steps
        self._rollouts = Pace()
        self._rollout, self._begun = 1, 0.0
        self._running = False
        self._validation: float | None = None

    def begin_rollout(self, time: float) -> None:
        """Take in that a rollout begins."""
        self._begun, self._running = time, True

    def end_rollout(self, time: float, steps: int) -> None:
        """Take in that a rollout and its update are over, after so many steps in all."""
        if self._running and steps > self._steps:
            self._rollout = steps - self._steps
            self._rollouts.add(time - self._begun, self._rollout)
        self._steps, self._running = steps, False

    def validate(self, seconds: float) -> None:
        """Take in that a validation is over, and how long it took."""
        self._validation, self._validated = seconds, self._steps

    def left(self, time: float, validation: tuple[float, float] | None = None) -> tuple[float, bool] | None:
        """Return how long it goes on, s, and whether validations are in that; None where nothing can be told.

        ``validation`` is one under way: how long it may take as a whole, and what is left of it, s.
        """
        rollouts = self._rollouts.seconds(self._total - self._steps)
        one = self._rollouts.seconds(self._rollout)
        if rollouts is None or one is None:
            return None
        passed = min(time - self._begun, one) if self._running else 0.0
        driving = max(0.0, rollouts - passed)
        apart = ceil(self._every / self._rollout) * self._rollout
        due = ceil((self._total - self._validated) / apart)
        whole = validation[0] if validation else self._validation
        if whole is None:
            return driving, due == 0
        return driving + (validation[1] + (due - 1) * whole if validation else due * whole), True


class EvaluationLength:
    """How many steps an evaluation still takes, whose worlds drive in step, by how long its episodes were.

    ``quota`` (N,) is how many episodes each world drives; ``earlier`` are lengths of those of the last evaluation.
    What is known of lengths is the estimator of E. L. Kaplan and P. Meier (Nonparametric estimation from incomplete
    observations, JASA 53, 1958): the short ones end first, those that run are longer. How it goes on is drawn from
    that, and ends with the slowest world.
    """

    def __init__(self, quota: NDArray[np.int64], earlier: Sequence[int] = ()) -> None:
        self._due = quota.copy()
        self._ages = np.zeros(len(quota), np.int64)
        self._earlier = list(earlier)
        self.lengths: list[int] = []

    def step(self, ended: NDArray[np.bool_]) -> None:
        """Take in that each world has made a step, and which episodes ``ended`` (N,) with it."""
        self._ages += self._due > 0
        for slot in np.flatnonzero(ended & (self._due > 0)):
            self.lengths.append(int(self._ages[slot]))
            self._ages[slot], self._due[slot] = 0, self._due[slot] - 1

    def left(self) -> float | None:
        """Return how many steps are left, None where that cannot be told yet; another thread may step meanwhile."""
        due, ages, ended = self._due.copy(), self._ages.copy(), np.array(self._earlier + self.lengths)
        if not due.any():
            return 0.0
        if len(ended) < _LEAST_ENDED:
            return None
        lengths, shares = _known_lengths(ended, ages[due > 0])
        if 1.0 - shares[:-_TAIL].sum() > UNKNOWN:
            return None
        return float(_draw_rests(lengths, np.cumsum(shares), due, ages).max(axis=1).mean())


def _known_lengths(
    ended: NDArray[np.int64], running: NDArray[np.int64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return lengths (K,), ascending, and their shares (K,), of episodes that have ``ended`` and of those that run for
    so long; the last stand for those longer than any so far.
    """
    seen = np.sort(np.concatenate((ended, running)))
    lengths, counts = np.unique(ended, return_counts=True)
    at_risk = len(seen) - np.searchsorted(seen, lengths)
    survive = np.cumprod(1.0 - counts / at_risk)
    shares = np.concatenate(([1.0], survive[:-1])) - survive
    tail = float(seen[-1]) * (1.0 + np.arange(1, _TAIL + 1) / (2 * _TAIL))
    return np.concatenate((lengths, tail)), np.concatenate((shares, np.full(_TAIL, survive[-1] / _TAIL)))


def _draw_rests(
    lengths: NDArray[np.float64], cumulated: NDArray[np.float64], due: NDArray[np.int64], ages: NDArray[np.int64]
) -> NDArray[np.float64]:
    """Return steps (M, N) that each world has left in M ways of going on: what runs, then what comes."""
    random = np.random.default_rng(0)
    rests = np.zeros((_DRAWN, len(due)))
    for slot in np.flatnonzero(due):
        before = np.searchsorted(lengths, ages[slot], side="right")
        passed = cumulated[before - 1] if before else 0.0
        draws = random.random((_DRAWN, due[slot]))
        draws[:, 0] = passed + (1.0 - passed) * draws[:, 0]
        drawn = lengths[np.minimum(np.searchsorted(cumulated, draws), len(lengths) - 1)]
        rests[:, slot] = np.maximum(drawn.sum(axis=1) - ages[slot], 1.0)
    return rests
