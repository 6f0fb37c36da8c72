"""How far N robots have come along their paths."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from arena_core import PathBatch
from arena_gym.pool import Problem
from arena_kernels.paths import follow

REACH = 1.0  # m of path that are searched ahead and behind: more than a robot drives in a control period


class PathTracking:
    """Paths and progress: ``progress`` (N, 2) is the way left along each path and the distance beside it, m.

    A robot's place moves along its path only, so that it does not leap to where the path passes near itself.
    """

    paths: PathBatch

    def __init__(self, worlds: int) -> None:
        self.progress = np.zeros((worlds, 2))
        self._problems: list[Problem | None] = [None] * worlds
        self._places = np.zeros(worlds, np.int64)
        self._left = np.empty(0)

    def begin(self, slots: NDArray[np.int64], problems: Sequence[Problem]) -> None:
        """Put robots in these slots at the beginning of their paths."""
        for slot, problem in zip(slots.tolist(), problems, strict=True):
            self._problems[slot] = problem
            first, start = problem.path.poses[0], problem.scenario.start
            self.progress[slot] = problem.left[0], np.hypot(first[0] - start.x, first[1] - start.y)
        self._places[slots] = 0
        present = [problem for problem in self._problems if problem is not None]
        self.paths = PathBatch.of([problem.path for problem in present])
        self._left = np.concatenate([problem.left for problem in present])

    def follow(self, poses: NDArray[np.float64]) -> None:
        """Take in where the robots are now, ``poses`` (N, 3)."""
        follow(self.paths.poses, self.paths.offsets, self._left, poses, REACH, self._places, self.progress)
