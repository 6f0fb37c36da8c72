"""How soon a watcher would have known where the robot goes (Dragan, Lee and Srinivasa 2013)."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from arena_core import EpisodeRecord

FloatArray = NDArray[np.float64]


def legibility(record: EpisodeRecord, other_goals: Sequence[Sequence[float]]) -> float:
    """Return the mean over time of how probable the robot's goal is among it and ``other_goals`` (x, y in ``map``),
    early rows weighing more (T - t); NaN without other goals, or for no duration.

    The way so far to p makes a goal exp(-(its length + |goal - p|)) / exp(-|goal - start|) probable, lengths in m.
    """
    stamps, positions = record["stamp"], record["pose"][:, :2]
    left = stamps[-1] - stamps
    weights = left * np.concatenate((np.diff(stamps), [0.0]))
    if not len(other_goals) or weights.sum() <= 0.0:
        return math.nan
    goals = np.array([record.meta["scenario"]["goal"][:2], *other_goals], float)
    still = np.linalg.norm(goals - positions[:, None], axis=2)
    evidence = still[0] - still  # the length of the way so far is the same for all goals
    chances = np.exp(evidence - evidence.max(axis=1, keepdims=True))
    return float((weights * chances[:, 0] / chances.sum(axis=1)).sum() / weights.sum())
