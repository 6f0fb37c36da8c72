"""How the robot and people pass each other: foreseen distances, who gives way, on which side, and how intertwined."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from arena_core import EpisodeRecord, wrap_angle
from arena_metrics.packs.collision_courses import people_offsets, robot_velocities
from arena_metrics.packs.people_gaps import any_people, people_there, relative_velocities, time_share, to_people

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]
Side = Literal["left", "right"]


def closest_approach(away: FloatArray, velocities: FloatArray, horizon: float) -> FloatArray:
    """Return the least distance within ``horizon`` s of points that are ``away`` (..., 2) m and go on with constant
    relative ``velocities`` m/s; NaN where either is.
    """
    squares = (velocities**2).sum(axis=-1)
    times = -(away * velocities).sum(axis=-1) / np.where(squares > 0.0, squares, 1.0)
    times = np.clip(times, 0.0, horizon)
    found: FloatArray = np.linalg.norm(away + times[..., None] * velocities, axis=-1)
    return found


def _reaches(record: EpisodeRecord) -> FloatArray:
    """Return the sums of the robot's circumscribed radius and each person's, (P,), m."""
    return record["pedestrian_radii"].astype(float) + float(record.meta["robot"]["footprint"]["radius"])


def min_predicted_distance(record: EpisodeRecord, course_horizon: float) -> float:
    """Return the least distance of circumscribed circle and body within ``course_horizon`` s of any row if both kept
    their velocities, m, 0 at least; NaN without people.
    """
    if not any_people(record):
        return math.nan
    nearest = closest_approach(to_people(record), relative_velocities(record), course_horizon) - _reaches(record)
    return max(float(np.nanmin(nearest)), 0.0)


def future_intrusion(record: EpisodeRecord, future_horizon: float) -> float:
    """Return the share of time in which the robot's circumscribed circle overlaps where a person's body will be within
    ``future_horizon`` s, as recorded; NaN without people.
    """
    if not any_people(record):
        return math.nan
    stamps, robot = record["stamp"], record["pose"][:, None, :2]
    positions, reaches = record["pedestrian_positions"].astype(float), _reaches(record)
    inside = np.zeros(len(stamps), bool)
    for ahead in range(len(stamps)):
        now = len(stamps) - ahead
        soon = stamps[ahead:] - stamps[:now] <= future_horizon + 1e-9
        if not soon.any():
            break
        distances = np.linalg.norm(positions[ahead:] - robot[:now], axis=2)
        inside[:now] |= soon & (distances < reaches).any(axis=1)
    return time_share(record, inside)


def yield_score(record: EpisodeRecord, course_horizon: float) -> float:
    """Return the robot's share of what robot and people together did about collision courses, 0 to 1; NaN where nobody
    did anything.

    A course is a row in which the circumscribed circle and a body would touch within ``course_horizon`` s. What each
    did about it is by how much its change of velocity to the next row, the other's kept, widens the foreseen distance.
    """
    away, relative = to_people(record)[:-1], relative_velocities(record)
    before = closest_approach(away, relative[:-1], course_horizon)
    robots = np.diff(robot_velocities(record), axis=0)[:, None]
    people = np.diff(record["pedestrian_velocities"].astype(float), axis=0)
    by_robot = closest_approach(away, relative[:-1] - robots, course_horizon) - before
    by_people = closest_approach(away, relative[:-1] + people, course_horizon) - before
    course = (before < _reaches(record)) & np.isfinite(by_people)
    own, theirs = (float(np.maximum(part, 0.0)[course].sum()) for part in (by_robot, by_people))
    return own / (own + theirs) if own + theirs > 0.0 else math.nan


def passes(record: EpisodeRecord, side: Side, pass_distance: float) -> float:
    """Count the people who came from ahead of the robot to behind it on this side of it, within ``pass_distance`` m of
    its middle.
    """
    offsets = people_offsets(record, slice(None), slice(None))
    ahead, behind = offsets[:-1], offsets[1:]
    with np.errstate(invalid="ignore", divide="ignore"):
        passed = (ahead[..., 0] > 0.0) & (behind[..., 0] <= 0.0)
        share = ahead[..., 0] / (ahead[..., 0] - behind[..., 0])
        beside = ahead[..., 1] + share * (behind[..., 1] - ahead[..., 1])
        near = passed & (np.abs(beside) <= pass_distance)
        return float(np.count_nonzero(near & (beside > 0.0 if side == "left" else beside < 0.0)))


def topological_complexity(record: EpisodeRecord) -> float:
    """Return by how many turns the robot and each person wound about each other, mean over people; NaN where nobody
    is there for two rows.
    """
    vectors, there = to_people(record), people_there(record)
    angles = np.arctan2(vectors[..., 1], vectors[..., 0])
    turns = wrap_angle(np.diff(angles, axis=0))
    known = there[1:] & there[:-1]
    wound = np.abs(np.where(known, turns, 0.0).sum(axis=0)) / (2.0 * math.pi)
    seen = known.any(axis=0)
    return float(wound[seen].mean()) if seen.any() else math.nan
