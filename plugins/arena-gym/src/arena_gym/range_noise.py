"""Range noise beyond the robot's own, as strong as each episode draws it."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from arena_core import Lidar
from arena_gym.episodes import Episode
from arena_kernels.compiled import borrowing
from arena_kernels.random import fill_normals

Ranges = NDArray[np.float32]


class RangeNoise:
    """Adds Gaussian noise to the ranges of N robots; a number depends on the episode, the step and the beam alone."""

    def __init__(self, lidar: Lidar, worlds: int) -> None:
        self._bounds = float(lidar.range_min), float(lidar.range_max)
        self._stds = np.zeros(worlds)
        self._keys = np.zeros(worlds, np.uint64)
        self._normals = np.empty(lidar.beams)

    def begin(self, slots: NDArray[np.int64], episodes: Sequence[Episode]) -> None:
        """Begin episodes in these slots."""
        self._stds[slots] = [episode.noise for episode in episodes]
        self._keys[slots] = [episode.noise_key for episode in episodes]

    def add_noise(self, ranges: Ranges, steps: NDArray[np.int64]) -> Ranges:
        """Return the ranges (N, B) with noise; the same array where there is none."""
        if not self._stds.any():
            return ranges
        noisy = ranges.copy()
        _add_noise(noisy, steps, self._stds, self._keys, self._bounds, self._normals)
        return noisy


@borrowing
def _add_noise(
    ranges: Ranges,
    steps: NDArray[np.int64],
    stds: NDArray[np.float64],
    keys: NDArray[np.uint64],
    bounds: tuple[float, float],
    scratch: NDArray[np.float64],
) -> None:
    for k in range(len(ranges)):
        if stds[k] > 0.0:
            fill_normals(keys[k], steps[k], scratch)
            for b in range(ranges.shape[1]):
                if ranges[k, b] < math.inf:
                    ranges[k, b] = min(max(ranges[k, b] + stds[k] * scratch[b], bounds[0]), bounds[1])
