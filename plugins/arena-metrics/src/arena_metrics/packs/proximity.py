"""How near the robot came to walls, obstacles and people."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from arena_core import EpisodeRecord


def _reduce_finite(values: NDArray[Any], reduce: Callable[[NDArray[Any]], Any]) -> float:
    """Reduce the finite values; NaN where there is none (nothing near at any time)."""
    finite = values[np.isfinite(values)]
    return float(reduce(finite)) if len(finite) else math.nan


def clearance_mean(record: EpisodeRecord) -> float:
    """Return the mean distance from the footprint to the nearest thing, m."""
    return _reduce_finite(record["clearance"], np.mean)


def clearance_max(record: EpisodeRecord) -> float:
    """Return the greatest distance from the footprint to the nearest thing, m."""
    return _reduce_finite(record["clearance"], np.max)


def clearance_min(record: EpisodeRecord) -> float:
    """Return the least distance from the footprint to the nearest thing, m."""
    return _reduce_finite(record["clearance"], np.min)


def clearance_normalised(record: EpisodeRecord) -> float:
    """Return the mean clearance in radii of the robot's circumscribed circle."""
    return clearance_mean(record) / float(record.meta["robot"]["footprint"]["radius"])


def clearance_people_min(record: EpisodeRecord) -> float:
    """Return the least distance from the footprint to a person, m; NaN without people."""
    return _reduce_finite(record["clearance_people"], np.min)


def clearance_people_mean(record: EpisodeRecord) -> float:
    """Return the mean distance from the footprint to the nearest person, m; NaN without people."""
    return _reduce_finite(record["clearance_people"], np.mean)


def personal_space_time(record: EpisodeRecord, personal_space: float) -> float:
    """Return the time with a person nearer than ``personal_space``, s (trapezoidal over the control steps)."""
    inside = (record["clearance_people"] < personal_space).astype(float)
    return float((np.diff(record["stamp"]) * 0.5 * (inside[1:] + inside[:-1])).sum())


def encounter_count(record: EpisodeRecord, encounter_distance: float) -> float:
    """Count how often the nearest person came nearer than ``encounter_distance``."""
    near = record["clearance_people"] < encounter_distance
    return float(near[0] + np.count_nonzero(near[1:] & ~near[:-1]))


def people_per_100m2(record: EpisodeRecord) -> float:
    """Return how many people were there, mean over the rows, per 100 m2 of the world's largest
    free region; NaN without its area.
    """
    area = float(record.meta.get("world", {}).get("free_area") or math.nan)
    there = np.isfinite(record["pedestrian_positions"]).all(axis=2).sum(axis=1)
    return 100.0 * float(there.mean()) / area
