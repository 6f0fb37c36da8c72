"""How far each person is from the robot's outline in each row, and how long each row lasts."""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from arena_core import EpisodeRecord
from arena_metrics.packs.collision_courses import people_offsets, robot_velocities
from arena_metrics.packs.footprints import outline_distances

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]


@lru_cache(maxsize=2)
def people_gaps(record: EpisodeRecord) -> FloatArray:
    """Return the distance from the footprint to each person's body, (T, P), m; inf for who is not there."""
    offsets = people_offsets(record, slice(None), slice(None))
    there = np.isfinite(offsets).all(axis=2)
    gaps = np.full(there.shape, np.inf)
    radii = np.broadcast_to(record["pedestrian_radii"], there.shape)[there]
    gaps[there] = np.maximum(outline_distances(record.meta["robot"]["footprint"], offsets[there]) - radii, 0.0)
    return gaps


def people_there(record: EpisodeRecord) -> BoolArray:
    """Return who is in the world in each row, (T, P)."""
    there: BoolArray = np.isfinite(record["pedestrian_positions"]).all(axis=2)
    return there


def any_people(record: EpisodeRecord) -> bool:
    """Return whether a person is there in any row."""
    return bool(people_there(record).any())


def to_people(record: EpisodeRecord) -> FloatArray:
    """Return the vectors from the robot to each person in ``map``, (T, P, 2), m; NaN for who is not there."""
    found: FloatArray = record["pedestrian_positions"].astype(float) - record["pose"][:, None, :2]
    return found


def relative_velocities(record: EpisodeRecord) -> FloatArray:
    """Return each person's velocity less the robot's in ``map``, (T, P, 2), m/s."""
    found: FloatArray = record["pedestrian_velocities"].astype(float) - robot_velocities(record)[:, None]
    return found


def row_times(record: EpisodeRecord) -> FloatArray:
    """Return how long each row counts in a trapezoidal sum, (T,), s; together they are the episode's duration."""
    halves = 0.5 * np.diff(record["stamp"])
    return np.concatenate((halves, [0.0])) + np.concatenate(([0.0], halves))


def time_share(record: EpisodeRecord, rows: BoolArray) -> float:
    """Return the share of time of some rows (T,), trapezoidal; NaN for an episode of no duration."""
    times = row_times(record)
    total = float(times.sum())
    return float(times[rows].sum()) / total if total > 0.0 else math.nan


def rising_edges(rows: BoolArray) -> BoolArray:
    """Return where each column of (T, P) becomes true; one that begins true does in its first row."""
    edges = rows.copy()
    edges[1:] &= ~rows[:-1]
    return edges
