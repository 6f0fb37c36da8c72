"""The social force between robot and people, as HuNavSim's evaluator of 2025 has it, and the work of it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from arena_core import EpisodeRecord, wrap_angle
from arena_metrics.packs.people_gaps import people_there, relative_velocities, row_times, to_people

FloatArray = NDArray[np.float64]
# Moussaid et al. 2009, table 1, with the size of HuNavSim's library: lambda, gamma, n', n, and the force's size, m/s^2
LAMBDA, GAMMA, N_ALONG, N_ASIDE, SIZE = 2.0, 0.35, 3.0, 2.0, 2.1


def social_force(away: FloatArray, closing: FloatArray) -> FloatArray:
    """Return the force on one by another who is ``away`` (..., 2) m from it and towards whom it moves with ``closing``
    m/s (its velocity less the other's), m/s^2; none where both are in one place.
    """
    distance = np.linalg.norm(away, axis=-1)
    direction = away / np.where(distance > 0.0, distance, 1.0)[..., None]
    interaction = LAMBDA * closing + direction
    length = np.linalg.norm(interaction, axis=-1)
    reach = GAMMA * np.where(length > 0.0, length, 1.0)
    along = interaction * (GAMMA / reach)[..., None]
    angle = wrap_angle(_angle(along) - _angle(direction))
    decay = -distance / reach
    forward = -np.exp(decay - (N_ALONG * reach * angle) ** 2)
    aside = np.sign(angle) * np.exp(decay - (N_ASIDE * reach * angle) ** 2)
    left = np.stack((-along[..., 1], along[..., 0]), axis=-1)
    force = SIZE * (forward[..., None] * along + aside[..., None] * left)
    return np.where(((distance > 0.0) & (length > 0.0))[..., None], force, 0.0)


def _angle(vectors: FloatArray) -> FloatArray:
    return np.arctan2(vectors[..., 1], vectors[..., 0])


def _forces(record: EpisodeRecord) -> FloatArray:
    """Return the force of each person on the robot, (T, P, 2), m/s^2, 0 for who is not there; that of the robot on the
    person is its opposite.
    """
    there = people_there(record)[..., None]
    return social_force(np.where(there, to_people(record), 0.0), np.where(there, -relative_velocities(record), 0.0))


def social_force_sum(record: EpisodeRecord) -> float:
    """Return the time integral of the sizes of all people's forces on the robot, or of the robot's on them, m/s."""
    return _integral(record, np.linalg.norm(_forces(record), axis=2).sum(axis=1))


def social_work(record: EpisodeRecord) -> float:
    """Return the time integral of the size of the people's joint force on the robot, and of those of the robot's
    forces on them, m/s.
    """
    forces = _forces(record)
    joint = np.linalg.norm(forces.sum(axis=1), axis=1)
    return _integral(record, joint + np.linalg.norm(forces, axis=2).sum(axis=1))


def _integral(record: EpisodeRecord, sizes: FloatArray) -> float:
    return float((row_times(record) * sizes).sum())
