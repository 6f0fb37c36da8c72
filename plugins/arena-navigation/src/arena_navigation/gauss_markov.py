"""A localiser that errs as a particle filter does, at a thousandth of its cost: what policies are trained with."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arena_core import ReferenceLocalizer
from arena_core.parameters import NonNegative, Positive
from arena_kernels.compiled import borrowing
from arena_kernels.random import normal
from arena_navigation.columns import ACROSS, ALONG, THETA, TURN, X, Y

Floats = NDArray[np.float64]
Slots = NDArray[np.int64]
Keys = NDArray[np.uint64]


class _State(NamedTuple):
    """Of N robots: keys of their random streams, how many estimates were asked for, last true
    poses (N, 3), errors (N, 3).
    """

    keys: Keys
    counts: NDArray[np.int64]
    poses: Floats
    errors: Floats

    @staticmethod
    def of(total: int) -> _State:
        """Make the state of robots that have not begun."""
        return _State(np.zeros(total, np.uint64), np.zeros(total, np.int64), np.zeros((total, 3)), np.zeros((total, 3)))


class GaussMarkovLocalizer(ReferenceLocalizer):
    """The true pose and an error of it in the robot's frame: three first-order Gauss-Markov processes over the way
    driven.

    Each error is normal with standard deviation ``std`` (along and across in m, heading in rad) and is forgotten, to a
    share of 1/e, within ``length`` m of way, of which turning by a radian counts as ``turn`` m: a robot that stands
    learns nothing new of where it is.
    """

    def __init__(
        self,
        std: tuple[NonNegative, NonNegative, NonNegative],
        length: tuple[Positive, Positive, Positive],
        turn: NonNegative,
    ) -> None:
        self._std, self._length, self._turn = np.array(std, np.float64), np.array(length, np.float64), float(turn)
        self._state = _State.of(1)

    def begin(self, keys: Keys, slots: Slots, total: int) -> None:
        """Begin episodes in K ``slots`` of ``total``, each with the key (K,) of its random stream."""
        if len(self._state.keys) != total:
            self._state = _State.of(total)
        self._state.keys[slots], self._state.counts[slots] = keys, 0

    def estimates(self, poses: Floats, slots: Slots) -> Floats:
        """Return the poses (K, 3) with the errors that these robots have now."""
        estimates = np.empty((len(slots), 3))
        _advance_errors(self._state, slots, poses, self._std, self._length, self._turn, estimates)
        return estimates

    def covariance(self, pose: Floats) -> Floats:
        """Return the covariance (3, 3) of an estimate (3,) in ``map``."""
        c, s = math.cos(pose[THETA]), math.sin(pose[THETA])
        turned = np.array(((c, -s, 0.0), (s, c, 0.0), (0.0, 0.0, 1.0)))
        covariance: Floats = turned @ np.diag(self._std**2) @ turned.T
        return covariance


@borrowing
def _advance_errors(
    state: _State, slots: Slots, poses: Floats, std: Floats, length: Floats, turn: float, estimates: Floats
) -> None:
    """Move each robot's error on by the way that it drove since it was last asked for."""
    for k in range(len(slots)):
        slot = slots[k]
        x, y, heading = poses[k, X], poses[k, Y], poses[k, THETA]
        turned = (heading - state.poses[slot, THETA] + math.pi) % (2.0 * math.pi) - math.pi
        way = math.hypot(x - state.poses[slot, X], y - state.poses[slot, Y]) + turn * abs(turned)
        for axis in range(3):
            kept = math.exp(-way / length[axis]) if state.counts[slot] > 0 else 0.0
            fresh = math.sqrt(1.0 - kept * kept) * std[axis] * normal(state.keys[slot], state.counts[slot], axis)
            state.errors[slot, axis] = kept * state.errors[slot, axis] + fresh
            state.poses[slot, axis] = poses[k, axis]
        state.counts[slot] += 1
        c, s = math.cos(heading), math.sin(heading)
        along, across = state.errors[slot, ALONG], state.errors[slot, ACROSS]
        estimates[k, X], estimates[k, Y] = x + c * along - s * across, y + s * along + c * across
        estimates[k, THETA] = heading + state.errors[slot, TURN]
