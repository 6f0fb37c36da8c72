"""People who belong together, found from how they walk and stand, and the robot among them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from arena_core import EpisodeRecord
from arena_metrics.packs.people_gaps import people_there, row_times, time_share

FloatArray = NDArray[np.float64]
CHUNK = 500_000  # pairs of people in rows that are looked at together
LEAST = 3  # people whose hull has an inside


@dataclass(frozen=True, slots=True)
class GroupRule:
    """Two belong together who, for ``share`` of the time in which both are there and for ``time`` s at least, are
    within ``distance`` m (between centres) and differ by at most ``speed`` m/s in velocity.
    """

    distance: float
    speed: float
    share: float
    time: float


@lru_cache(maxsize=2)
def group_numbers(record: EpisodeRecord, rule: GroupRule) -> NDArray[np.int64]:
    """Return the group of each person, (P,), numbered from 0; -1 for who belongs to none."""
    from scipy.sparse.csgraph import connected_components

    common, together = _times_together(record, rule)
    linked = (together >= max(rule.time, 1e-9)) & (together >= rule.share * common - 1e-9)
    np.fill_diagonal(linked, val=False)
    _, labels = connected_components(linked, directed=False)
    sizes = np.bincount(labels, minlength=1)
    alone = sizes[labels] < 2
    _, numbers = np.unique(labels[~alone], return_inverse=True)
    found = np.full(len(labels), -1, np.int64)
    found[~alone] = numbers
    return found


def _times_together(record: EpisodeRecord, rule: GroupRule) -> tuple[FloatArray, FloatArray]:
    """Return for how long each two people are both there, and how long together, (P, P), s."""
    there, times = people_there(record), row_times(record)
    states = np.concatenate((record["pedestrian_positions"], record["pedestrian_velocities"]), axis=2)
    columns = np.moveaxis(np.asarray(states, np.float32), 2, 0)
    people = there.shape[1]
    together, rows = np.zeros((people, people)), max(CHUNK // max(people**2, 1), 1)
    for k in range(0, len(there), rows):
        x, y, vx, vy = (column[k : k + rows, :, None] - column[k : k + rows, None] for column in columns)
        near = (x * x + y * y <= rule.distance**2) & (vx * vx + vy * vy <= rule.speed**2)
        together += np.einsum("t,tij->ij", times[k : k + rows], near)
    common: FloatArray = (times[:, None] * there).T @ there.astype(float)
    return common, together


def group_intrusion(record: EpisodeRecord, rule: GroupRule) -> float:
    """Return how long the robot's centre is within the convex hull of three or more people of a group, s."""
    inside = np.zeros(len(record["stamp"]), bool)
    for members in _groups(record, rule):
        inside |= _is_surrounded(members - record["pose"][:, None, :2])
    return float(row_times(record)[inside].sum())


def _groups(record: EpisodeRecord, rule: GroupRule) -> list[FloatArray]:
    """Return the positions of each group's members, (T, n, 2) m; NaN for who is not there."""
    numbers = group_numbers(record, rule)
    positions = record["pedestrian_positions"].astype(float)
    return [positions[:, numbers == group] for group in range(int(numbers.max(initial=-1)) + 1)]


def _is_surrounded(offsets: FloatArray) -> NDArray[np.bool_]:
    """Return in which rows the origin is inside the hull of points (T, n, 2): seen from there no two neighbours are
    half a turn apart.
    """
    angles = np.sort(np.arctan2(offsets[..., 1], offsets[..., 0]), axis=1)  # NaN comes last
    counts = np.isfinite(angles).sum(axis=1)
    between = np.where(np.isfinite(np.diff(angles, axis=1)), np.diff(angles, axis=1), 0.0).max(axis=1, initial=0.0)
    rows = np.arange(len(angles))
    around = 2.0 * math.pi - (angles[rows, np.maximum(counts - 1, 0)] - angles[:, 0])
    found: NDArray[np.bool_] = (counts >= LEAST) & (np.maximum(between, around) < math.pi)
    return found


@lru_cache(maxsize=2)
def group_distances(record: EpisodeRecord, rule: GroupRule) -> FloatArray | None:
    """Return the distance from the robot's circumscribed circle to the nearest group's o-space in each row, (T,) m, inf
    where no two of any group are there; None without groups.

    The o-space is the circle about the members' centre that touches the nearest of their bodies (Kendon 1990).
    """
    groups, numbers = _groups(record, rule), group_numbers(record, rule)
    if not groups:
        return None
    radii, robot = record["pedestrian_radii"].astype(float), float(record.meta["robot"]["footprint"]["radius"])
    found = [_o_space_gaps(record, members, radii[numbers == group]) for group, members in enumerate(groups)]
    nearest: FloatArray = np.maximum(np.min(found, axis=0) - robot, 0.0)
    return nearest


def _o_space_gaps(record: EpisodeRecord, members: FloatArray, radii: FloatArray) -> FloatArray:
    """Return the distance of the robot's centre to the o-space of one group in each row, (T,) m."""
    there = np.isfinite(members[..., 0])
    counts = there.sum(axis=1)
    centres = np.where(there[..., None], members, 0.0).sum(axis=1) / np.maximum(counts, 1)[:, None]
    inner = np.where(there, np.linalg.norm(members - centres[:, None], axis=2) - radii, np.inf).min(axis=1)
    gaps = np.hypot(*(record["pose"][:, :2] - centres).T) - np.maximum(inner, 0.0)
    return np.where(counts >= 2, gaps, np.inf)


def group_zone_share(record: EpisodeRecord, rule: GroupRule, low: float, high: float) -> float:
    """Return the share of time in which the nearest group's o-space is in [low, high) m; NaN without groups."""
    distances = group_distances(record, rule)
    return math.nan if distances is None else time_share(record, (distances >= low) & (distances < high))
