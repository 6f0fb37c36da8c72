"""Commands that act some control steps after they were given."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


class LateCommands:
    """Delays the commands of N robots by up to ``longest`` control steps each; until the first one acts, a robot stands."""

    def __init__(self, worlds: int, longest: int) -> None:
        self._given = np.zeros((longest + 1, worlds, 3))  # the newest first
        self._latency = np.zeros(worlds, np.int64)
        self._slots = np.arange(worlds)

    def begin(self, slots: NDArray[np.int64], latency: Sequence[int]) -> None:
        """Begin episodes in these slots with so much latency each, in control steps."""
        self._latency[slots] = latency
        self._given[:, slots] = 0.0

    def acting(self, commands: Floats) -> Floats:
        """Take in the commands (N, 3) given now; return those that act now."""
        if len(self._given) == 1:
            return commands
        self._given = np.concatenate((commands[None], self._given[:-1]))
        return self._given[self._latency, self._slots]
