"""What a member costs in a while: seconds."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arena_gym.forks.settings import CostSettings

Floats = NDArray[np.float64]
TERMS = ("lost", "collisions", "discomfort")  # s, a number, m s


class Outcomes(NamedTuple):
    """What became of K members: how long each drove until it arrived or the time was over, s; m that are left of the
    way; collisions; m s nearer to people than allowed. (K,) each.
    """

    times: Floats
    left: Floats
    collisions: Floats
    discomforts: Floats


def intrusions(gaps: Floats, near: float, period: float) -> Floats:
    """Return by how much ``gaps`` (K,) m to people are below ``near`` m for ``period`` s, m s; 0 without people."""
    return np.asarray(np.maximum(near - np.where(np.isfinite(gaps), gaps, np.inf), 0.0) * period)


def outcome_terms(outcomes: Outcomes, way: float, full_speed: float) -> Floats:
    """Return the terms (K, 3) in the order of TERMS, of which the first is the time that was lost: what was spent less
    what ``full_speed`` m/s would have taken for what of the ``way`` (m) was made.
    """
    lost = outcomes.times - (way - outcomes.left) / full_speed
    return np.stack((lost, outcomes.collisions, outcomes.discomforts), axis=1)


def total_costs(terms: Floats, settings: CostSettings) -> Floats:
    """Return the costs (..., K) s of terms (..., K, 3)."""
    return np.asarray(terms @ np.array((1.0, settings.collision, settings.discomfort)))


def regrets(costs: Floats) -> Floats:
    """Return by how much each member (N, K) costs more than the best one of the same state, s."""
    return np.asarray(costs - costs.min(axis=1, keepdims=True))
