"""How far N robots have come along their paths."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from arena_core import Path, PathBatch
from arena_gym.pool import Problem
from arena_kernels.paths import lengths_left, update_progress

REACH = 1.0  # m of path that are searched ahead and behind: more than a robot drives in a control period
Floats = NDArray[np.float64]


class PathTracking:
    """Paths and progress: ``progress`` (N, 2) is the way left along each path and the distance beside it, m.

    A robot's place moves along its path only, so that it does not leap to where the path passes near itself.
    """

    def __init__(self, worlds: int) -> None:
        self.progress = np.zeros((worlds, 2))
        self._ways: list[tuple[Path, Floats] | None] = [None] * worlds
        self._places = np.zeros(worlds, np.int64)
        self._paths: PathBatch
        self._left = np.empty(0)

    def begin(self, slots: NDArray[np.int64], problems: Sequence[Problem]) -> None:
        """Put robots in these slots at the beginning of their paths."""
        for slot, problem in zip(slots.tolist(), problems, strict=True):
            start = problem.scenario.start
            self._place_robot(slot, problem.path, problem.left, (start.x, start.y))
        self._pack_paths()

    def replace_paths(self, paths: dict[int, Path], poses: Floats) -> None:
        """Put the robots of some slots, which are at ``poses`` (N, 3), at the beginning of new paths."""
        for slot, path in paths.items():
            packed, left = PathBatch.of([path]), np.empty(len(path.poses))
            lengths_left(packed.poses, packed.offsets, left)
            self._place_robot(slot, path, left, (poses[slot, 0], poses[slot, 1]))
        self._pack_paths()

    def follow(self, poses: Floats) -> None:
        """Take in where the robots are now, ``poses`` (N, 3)."""
        update_progress(self._paths.poses, self._paths.offsets, self._left, poses, REACH, self._places, self.progress)

    def _place_robot(self, slot: int, path: Path, left: Floats, position: tuple[float, float]) -> None:
        first = path.poses[0]
        self._ways[slot] = path, left
        self.progress[slot] = left[0], np.hypot(first[0] - position[0], first[1] - position[1])
        self._places[slot] = 0

    def _pack_paths(self) -> None:
        present = [way for way in self._ways if way is not None]
        self._paths = PathBatch.of([path for path, _ in present])
        self._left = np.concatenate([left for _, left in present])
