"""Collision courses with people: how soon robot and person touch if both keep their velocity,
and how far off the robot reacts.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from arena_core import EpisodeRecord
from arena_metrics.packs.footprints import outline_distances, times_to_contact
from arena_metrics.packs.outcome import PERSON

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]


@dataclass(frozen=True, slots=True)
class ReactionRule:
    """Who is about to touch within ``horizon`` s for ``shortest`` s has to react: to put that off by ``gain`` s."""

    horizon: float
    shortest: float
    gain: float


def time_to_collision_min(record: EpisodeRecord, course_horizon: float) -> float:
    """Return the least time to a collision with a person, s, at most ``course_horizon``; 0 if one was
    touched, NaN without people.
    """
    if not np.isfinite(record["pedestrian_positions"]).any():
        return math.nan
    if (record["contact_kind"] == PERSON).any():
        return 0.0
    return float(min(times_to_collision(record, course_horizon).min(), course_horizon))


def times_to_collision(record: EpisodeRecord, horizon: float) -> FloatArray:
    """Return how soon each row leads to contact with each person, (T, P), s; inf where not within the horizon."""
    return _contact_times(record, robot_velocities(record)[:, None], slice(None), slice(None), horizon)


def reaction_distance(
    record: EpisodeRecord, course_horizon: float, course_time: float, reaction_gain: float, standing_speed: float
) -> float:
    """Return how far off people were when the robot first reacted to them, m, mean over those whom it had to react to;
    NaN without any.

    It has to once it moves and has been about to touch the person within ``course_horizon`` s for ``course_time`` s. It
    reacts in the first row in which its velocity puts the contact off by ``reaction_gain`` s or more, against the
    velocity with which that began. 0 where it touched the person first.
    """
    times = times_to_collision(record, course_horizon)
    moving = np.hypot(*robot_velocities(record).T) > standing_speed
    threats = np.isfinite(times) & moving[:, None]
    people = np.flatnonzero(threats.any(axis=0)).tolist()
    rule = ReactionRule(course_horizon, course_time, reaction_gain)
    found = [_first_reaction(record, p, times[:, p], threats[:, p], rule) for p in people]
    known = [distance for distance in found if distance is not None]
    return float(np.mean(known)) if known else math.nan


def _first_reaction(
    record: EpisodeRecord, person: int, times: FloatArray, threats: BoolArray, rule: ReactionRule
) -> float | None:
    """Return the distance to one person at the first reaction; None where every course ended by
    itself, or with the episode.
    """
    end, touched = _rows_before_contact(record, person)
    stamps = record["stamp"]
    begun = _first_row(threats[:end], 0)
    while begun is not None:
        unchanged = _contact_times(record, robot_velocities(record)[begun], slice(begun, end), person, rule.horizon)
        over, reacted = (
            _first_row(~np.isfinite(unchanged), begun),
            _first_row(times[begun:end] >= unchanged + rule.gain, begun),
        )
        if over is None and reacted is None:
            return 0.0 if touched else None
        left = min(row for row in (over, reacted) if row is not None)
        if left != over and stamps[left] - stamps[begun] >= rule.shortest - 1e-9:
            return _person_distance(record, left, person)
        begun = _first_row(threats[left:end], left)
    return None


def _person_distance(record: EpisodeRecord, row: int, person: int) -> float:
    """Return the distance from the footprint to a person's body in one row, m."""
    offsets = people_offsets(record, slice(row, row + 1), person)
    return max(
        0.0,
        float(outline_distances(record.meta["robot"]["footprint"], offsets)[0])
        - float(record["pedestrian_radii"][person]),
    )


def _rows_before_contact(record: EpisodeRecord, person: int) -> tuple[int, bool]:
    """Return the number of rows before a person was first touched, and whether that happened."""
    of_person = (record["contact_kind"] == PERSON) & (record["contact_person"] == record["pedestrian_ids"][person])
    stamps = record["contact_stamp"][of_person]
    return (int(np.searchsorted(record["stamp"], stamps.min())), True) if len(stamps) else (len(record["stamp"]), False)


def _contact_times(
    record: EpisodeRecord, velocities: FloatArray, rows: slice, people: slice | int, horizon: float
) -> FloatArray:
    """Return the times to contact if the robot had these velocities in ``map``, inf beyond the horizon."""
    relative = record["pedestrian_velocities"][rows, people].astype(float) - velocities
    turned = rotate_vectors(relative, -record["pose"][rows, 2])
    radii = record["pedestrian_radii"][people]
    found = times_to_contact(
        record.meta["robot"]["footprint"], people_offsets(record, rows, people), turned, radii, horizon
    )
    return np.where(found <= horizon, found, np.inf)


def people_offsets(record: EpisodeRecord, rows: slice, people: slice | int) -> FloatArray:
    """Return where people are in the robot's frame, m; NaN where they are not in the world."""
    positions = record["pedestrian_positions"][rows, people].astype(float)
    here = record["pose"][rows, :2]
    return rotate_vectors(positions - (here if positions.ndim == 2 else here[:, None]), -record["pose"][rows, 2])


def rotate_vectors(vectors: FloatArray, angles: FloatArray) -> FloatArray:
    """Turn vectors (T, ..., 2) by an angle a row."""
    shape = (len(angles),) + (1,) * (vectors.ndim - 2)
    c, s = np.cos(angles).reshape(shape), np.sin(angles).reshape(shape)
    return np.stack((c * vectors[..., 0] - s * vectors[..., 1], s * vectors[..., 0] + c * vectors[..., 1]), axis=-1)


def robot_velocities(record: EpisodeRecord) -> FloatArray:
    """Return the true velocity in ``map``, (T, 2), m/s."""
    return rotate_vectors(record["twist"][:, :2], record["pose"][:, 2])


def _first_row(rows: BoolArray, offset: int) -> int | None:
    """Return the first true row, counted from ``offset``."""
    return offset + int(np.argmax(rows)) if rows.any() else None
