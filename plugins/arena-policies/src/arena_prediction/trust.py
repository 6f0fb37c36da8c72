"""How far the people of an episode do what a network expects of them: learned while they are watched."""

from __future__ import annotations

from dataclasses import dataclass
from math import exp, isfinite
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arena_core import Tracks
from arena_core.parameters import Positive
from arena_kernels.compiled import TypedDispatch, borrowing
from arena_prediction.hypotheses import SCALE_TIME

Floats = NDArray[np.float64]
Singles = NDArray[np.float32]
LATE = 0.06  # s, by which a look may come later than what it judges
PENDING = 1024  # expectations that wait for their time, at most


@dataclass(frozen=True, slots=True)
class TrustRules:
    """How trust is learned: from what was expected ``lag`` s ago, forgotten in ``memory`` s; ``prior`` is what full
    trust weighs beside that, s^2: squared ways off the straight line, over the speed.
    """

    lag: Positive
    memory: Positive
    prior: Positive


class Pending(NamedTuple):
    """What was expected of tracks: ``ids`` (E,), -1 where there is nothing, when it is ``due`` (E,) s, where the
    ``straight`` line leads (E, 2) m, how far ``off`` it the network said (E, 2) m, and the speed ``scales`` (E,) m/s.
    """

    ids: NDArray[np.int64]
    due: Floats
    straight: Floats
    off: Floats
    scales: Floats


class Expected(NamedTuple):
    """K tracks with what a network answered of them, in their frames: its ``several`` hypotheses."""

    ids: NDArray[np.int64]
    places: Floats
    velocities: Floats
    frames: Floats
    answers: Singles
    several: int


class Reached(NamedTuple):
    """Which of the answers' ``steps`` times is judged, ``step``, ``lag`` s ahead."""

    steps: int
    step: int
    lag: float


class Trust:
    """By which share of what a network says people leave their straight lines, 0 .. 1.

    It is the least-squares share: of how far people were off their lines, in how far they were expected to be.
    """

    def __init__(self, rules: TrustRules, times: Floats, hypotheses: int) -> None:
        self._rules, self._hypotheses = rules, hypotheses
        step = int(np.abs(times[1:] - rules.lag).argmin())
        self._reached = Reached(len(times) - 1, step, float(times[1 + step]))
        self._judge, self._note = TypedDispatch(judge_expectations), TypedDispatch(note_expectations)
        self.reset()

    def reset(self) -> None:
        """Begin an episode, with full trust."""
        nothing = np.zeros((PENDING, 2))
        self._pending = Pending(np.full(PENDING, -1), np.zeros(PENDING), nothing, nothing.copy(), np.zeros(PENDING))
        self._sums, self._stamp, self._next = np.zeros(2), -np.inf, 0

    def judge(self, tracks: Tracks, stamp: float) -> float:
        """Take in where tracks are now and return the share."""
        rules, lapse = self._rules, max(stamp - self._stamp, 0.0)
        self._stamp = stamp
        self._sums *= exp(-lapse / rules.memory)
        ids, places = tracks.ids.astype(np.int64), np.array(tracks.positions, np.float64)
        self._judge(self._pending, ids, places, float(stamp), self._sums)
        share = (rules.prior + self._sums[0]) / (rules.prior + self._sums[1])
        return min(max(float(share), 0.0), 1.0)

    def expect(self, tracks: Tracks, stamp: float, frames: Floats, answers: Singles) -> None:
        """Note what the most probable hypothesis says of each track, to be judged when its time has come."""
        places, velocities = np.array(tracks.positions, np.float64), np.array(tracks.velocities, np.float64)
        given = Expected(tracks.ids.astype(np.int64), places, velocities, frames, answers, self._hypotheses)
        self._next = self._note(self._pending, given, float(stamp), self._reached, self._next)


@borrowing
def note_expectations(pending: Pending, given: Expected, stamp: float, reached: Reached, entry: int) -> int:
    """Write what is expected of tracks over the oldest entries from ``entry`` on; return the next one."""
    for k in range(len(given.ids)):
        best = 0
        for m in range(given.several):
            if given.answers[k, m] > given.answers[k, best]:
                best = m
        at = given.several + 2 * (best * reached.steps + reached.step)
        c, s, scale = given.frames[k, 0], given.frames[k, 1], given.frames[k, 2]
        reach = scale * (reached.lag + SCALE_TIME)
        u, v = reach * float(given.answers[k, at]), reach * float(given.answers[k, at + 1])
        pending.ids[entry], pending.due[entry], pending.scales[entry] = given.ids[k], stamp + reached.lag, scale
        pending.off[entry, 0], pending.off[entry, 1] = c * u - s * v, s * u + c * v
        for axis in range(2):
            pending.straight[entry, axis] = given.places[k, axis] + reached.lag * given.velocities[k, axis]
        entry = (entry + 1) % len(pending.ids)
    return entry


@borrowing
def judge_expectations(pending: Pending, ids: NDArray[np.int64], places: Floats, stamp: float, sums: Floats) -> None:
    """Add to ``sums`` (2,) what expectations that are due have to do with where the tracks are, and their size."""
    for e in range(len(pending.ids)):
        if pending.ids[e] < 0 or pending.due[e] > stamp + 1e-6:
            continue
        for k in range(len(ids)):
            if ids[k] != pending.ids[e] or stamp - pending.due[e] > LATE:
                continue
            x, y = places[k, 0] - pending.straight[e, 0], places[k, 1] - pending.straight[e, 1]
            u, v, square = pending.off[e, 0], pending.off[e, 1], pending.scales[e] * pending.scales[e]
            if isfinite(x + y):
                sums[0] += (x * u + y * v) / square
                sums[1] += (u * u + v * v) / square
        pending.ids[e] = -1
