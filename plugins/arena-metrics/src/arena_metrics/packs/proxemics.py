"""In whose space the robot was, for how long, and who came nearer."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from arena_core import EpisodeRecord
from arena_metrics.packs.collision_courses import robot_velocities
from arena_metrics.packs.people_gaps import (
    any_people,
    people_gaps,
    people_there,
    rising_edges,
    row_times,
    time_share,
    to_people,
)

FloatArray = NDArray[np.float64]
INTIMATE, PERSONAL, SOCIAL = 0.45, 1.2, 3.6  # m, outer limits of distances between bodies (Hall 1966, chapter X)
STANDING = 0.02  # m/s: who is slower has no heading
LEAST_SIGMA, SIDE, REAR = 0.5, 2.0 / 3.0, 0.5  # m and shares of the front's (Kirby 2010, section 3.2)
Approacher = Literal["robot", "person"]


def zone_share(record: EpisodeRecord, low: float, high: float) -> float:
    """Return the share of time in which the nearest person's distance is in [low, high) m; NaN without people."""
    nearest = record["clearance_people"]
    return time_share(record, (nearest >= low) & (nearest < high)) if any_people(record) else math.nan


def space_compliance(record: EpisodeRecord, compliance_radius: float) -> float:
    """Return the share of time in which nobody is nearer than ``compliance_radius`` m; NaN without people."""
    if not any_people(record):
        return math.nan
    return time_share(record, record["clearance_people"] >= compliance_radius)


def proxemic_intrusion(record: EpisodeRecord) -> float:
    """Return the time integral of how deep the robot is in the personal space of all people together, m s."""
    depths = np.maximum(PERSONAL - people_gaps(record), 0.0).sum(axis=1)
    return float((row_times(record) * depths).sum())


def near_misses(record: EpisodeRecord, near_miss: float) -> float:
    """Count how often a person and the robot came nearer to each other than ``near_miss`` m."""
    return float(np.count_nonzero(rising_edges(people_gaps(record) < near_miss)))


def intrusions(record: EpisodeRecord, by: Approacher) -> float:
    """Count how often the robot and a person came within intimate distance where this one of the two came nearer
    faster; the robot where both did alike. Who appears there, or where neither came nearer, counts for none.
    """
    edges = rising_edges(people_gaps(record) < INTIMATE)
    away = to_people(record)
    with np.errstate(invalid="ignore"):
        towards = away / np.linalg.norm(away, axis=2, keepdims=True)
        robots = (towards * robot_velocities(record)[:, None]).sum(axis=2)
        people = -(towards * record["pedestrian_velocities"]).sum(axis=2)
        caused = (robots > 0.0) & (robots >= people) if by == "robot" else (people > 0.0) & (people > robots)
    return float(np.count_nonzero(edges & caused))


def personal_space_values(record: EpisodeRecord) -> FloatArray:
    """Return the height of each person's asymmetric Gaussian at the robot's place, (T, P), 1 at the person; 0 for who
    is not there. Who stands has no heading: a circle with the side's width.
    """
    there = people_there(record)
    away = np.where(there[..., None], to_people(record), 0.0)
    velocities = np.where(there[..., None], record["pedestrian_velocities"].astype(float), 0.0)
    speeds = np.linalg.norm(velocities, axis=2)
    heading = velocities / np.maximum(speeds, STANDING)[..., None]
    ahead = -(away * heading).sum(axis=2)
    aside = heading[..., 1] * away[..., 0] - heading[..., 0] * away[..., 1]
    front = np.maximum(2.0 * speeds, LEAST_SIGMA)
    width, length = SIDE * front, np.where(ahead >= 0.0, front, REAR * front)
    moving = 0.5 * ((ahead / length) ** 2 + (aside / width) ** 2)
    standing = 0.5 * (away**2).sum(axis=2) / width**2
    return np.where(there, np.exp(-np.where(speeds > STANDING, moving, standing)), 0.0)


def personal_space_cost(record: EpisodeRecord) -> float:
    """Return the time integral of the asymmetric personal spaces of all people at the robot's place, s."""
    return float((row_times(record) * personal_space_values(record).sum(axis=1)).sum())


def personal_space_cost_max(record: EpisodeRecord) -> float:
    """Return the greatest height of an asymmetric personal space at the robot's place; NaN without people."""
    return float(personal_space_values(record).max()) if any_people(record) else math.nan
