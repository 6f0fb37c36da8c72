"""Automatic resizing of a band: intervals stay near a reference time and no longer than a spacing."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from arena_kernels.compiled import compiled
from arena_teb.columns import THETA, TIME, X, Y
from arena_teb.problem import FloatArray
from arena_teb.terms import wrap_to_pi

ROUNDS = 100  # at most so many passes (teb_local_planner)


class Sampling(NamedTuple):
    """How densely a band is sampled: ``dt_ref`` and ``dt_hysteresis`` s, numbers of poses,
    ``spacing`` m between two (inf: any).
    """

    dt_ref: float
    dt_hysteresis: float
    fewest: int
    most: int
    spacing: float


@compiled
def resize_band(band: FloatArray, sampling: Sampling) -> FloatArray:
    """Return the band (M, 4) with long intervals halved and short ones joined (Roesmann et al. 2012, section 3)."""
    poses = np.empty((max(sampling.most, len(band)) + 1, 4))
    count = len(band)
    poses[:count] = band
    for _ in range(ROUNDS):
        before = count
        count = halve_long(poses, count, sampling)
        halved = count != before
        joined = count
        count = join_short(poses, count, sampling)
        if not halved and count == joined:
            break
    return poses[:count].copy()


@compiled
def is_too_long(poses: FloatArray, k: int, sampling: Sampling) -> bool:
    """Return whether interval ``k`` should be two."""
    length = math.hypot(poses[k + 1, X] - poses[k, X], poses[k + 1, Y] - poses[k, Y])
    return bool(poses[k, TIME] > sampling.dt_ref + sampling.dt_hysteresis or length > sampling.spacing)


@compiled
def halve_long(poses: FloatArray, count: int, sampling: Sampling) -> int:
    """Put a pose into the middle of every interval that is too long; return the number of poses."""
    k = 0
    while k < count - 1 and count < sampling.most:
        if not is_too_long(poses, k, sampling):
            k += 1
            continue
        poses[k + 2 : count + 1] = poses[k + 1 : count].copy()
        count += 1
        poses[k, TIME] *= 0.5
        poses[k + 1, X], poses[k + 1, Y] = 0.5 * (poses[k, X] + poses[k + 2, X]), 0.5 * (poses[k, Y] + poses[k + 2, Y])
        poses[k + 1, THETA] = poses[k, THETA] + 0.5 * wrap_to_pi(poses[k + 2, THETA] - poses[k, THETA])
        poses[k + 1, TIME] = poses[k, TIME]
        k += 2
    return count


@compiled
def join_short(poses: FloatArray, count: int, sampling: Sampling) -> int:
    """Take out the pose after every interval that is too short, unless the sum were too long;
    return the number of poses.
    """
    k = 0
    while k < count - 2 and count > sampling.fewest:
        length = math.hypot(poses[k + 2, X] - poses[k, X], poses[k + 2, Y] - poses[k, Y])
        time = poses[k, TIME] + poses[k + 1, TIME]
        short = (
            poses[k, TIME] < sampling.dt_ref - sampling.dt_hysteresis
            and time <= sampling.dt_ref + sampling.dt_hysteresis
        )
        if short and length < 0.9 * sampling.spacing:
            poses[k, TIME] = time
            poses[k + 1 : count - 1] = poses[k + 2 : count].copy()
            count -= 1
        k += 1
    return count
