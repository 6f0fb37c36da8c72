"""The control sequence between two control steps: velocities at the ends of the model's steps, moved on by
the time that has passed.
"""

from __future__ import annotations

import numpy as np

from arena_mppi.parameters import Doubles, Floats
from arena_mppi.sampling import HISTORY


class ControlSequence:
    """Remembers the velocities planned last (T, 3), and those driven before.

    The model's step and the control period need not agree: both are read off the planned velocities at the times
    wanted.
    """

    def __init__(self, time_steps: int, dt: float, feedback: float) -> None:
        self._steps = time_steps
        self._dt = dt
        self._feedback = feedback
        self.clear()

    def clear(self) -> None:
        """Begin at rest."""
        self._times: Doubles = np.zeros(1)
        self._velocities: Floats = np.zeros((1, 3), np.float32)
        self._stamp: float | None = None

    def store_sequence(self, mean: Floats, now: Floats, stamp: float, period: float) -> Floats:
        """Remember ``mean`` (T, 3), planned at ``stamp`` from ``now`` (3,) on; return the
        velocity to be reached in ``period`` s.
        """
        before = self._steps_at(1 - HISTORY, 0)
        past = self._velocities_at(before + self._elapsed_time(stamp))
        self._times = self._steps_at(1 - HISTORY, self._steps + 1)
        self._velocities, self._stamp = np.vstack((past, now[None], mean)), stamp
        command: Floats = self._velocities_at(np.array((period,)))[0]
        return command

    def velocity_at(self, measured: Floats, stamp: float) -> Floats:
        """Return the velocity (3,) at ``stamp``: the planned one, led towards the ``measured``; that one alone without
        a plan.

        A robot does what it is told within its limits; what encoders tell of one short period is noisier than that.
        """
        if self._stamp is None:
            return measured
        planned: Floats = self._velocities_at(np.array((self._elapsed_time(stamp),)))[0]
        return planned + np.float32(self._feedback) * (measured - planned)

    def shifted_sequence(self, now: Floats, stamp: float) -> Floats:
        """Return the sequence (T, 3) as it is seen at ``stamp``; without one, ``now`` goes on."""
        if self._stamp is None:
            return np.tile(now, (self._steps, 1))
        return self._velocities_at(self._steps_at(1, self._steps + 1) + self._elapsed_time(stamp))

    def past_velocities(self, now: Floats, stamp: float) -> Floats:
        """Return the velocities at the model's last steps, (HISTORY, 3), the last of them ``now``."""
        if self._stamp is None:
            return np.tile(now, (HISTORY, 1))
        return np.vstack((self._velocities_at(self._steps_at(1 - HISTORY, 0) + self._elapsed_time(stamp)), now[None]))

    def _elapsed_time(self, stamp: float) -> float:
        return 0.0 if self._stamp is None else stamp - self._stamp

    def _steps_at(self, first: int, end: int) -> Doubles:
        return np.arange(first, end, dtype=np.float64) * self._dt

    def _velocities_at(self, times: Doubles) -> Floats:
        return np.column_stack([np.interp(times, self._times, axis) for axis in self._velocities.T]).astype(np.float32)
