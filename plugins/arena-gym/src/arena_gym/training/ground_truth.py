"""What a critic that sees the truth is shown beside the observation; the policy never reads it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from arena_core import Snapshot
from arena_gym.training.settings import TruthSettings

PERSON_COLUMNS = 5  # columns: whether there is one, x and y, vx and vy


class GroundTruth:
    """Columns of the truth: clearances, and the nearest people with their velocities, as seen from the robot.

    Asymmetric actor-critic (Pinto et al. 2018): the value of a state is easier to learn where its hidden part is known,
    and it is needed in training alone.
    """

    def __init__(self, settings: TruthSettings) -> None:
        self._people, self._reach = settings.people, settings.reach
        self.size = 2 + PERSON_COLUMNS * settings.people

    def truth_columns(self, snapshot: Snapshot, slots: NDArray[np.int64]) -> NDArray[np.float32]:
        """Return the truth of these K worlds, (K, size): least clearance of anything and of people, then the nearest
        people, nearest first.

        Lengths are over the reach and cut at 1; velocities, m/s, are relative to ``map`` along the robot's axes. Where
        there is no one (or farther than the reach) a person's columns are 0.
        """
        poses, crowd = snapshot.poses[slots], snapshot.crowd
        clearances = np.stack((snapshot.clearances[slots], snapshot.clearances_people[slots]), axis=1) / self._reach
        found = np.zeros((len(slots), self._people, PERSON_COLUMNS))
        places = crowd.positions[slots] - poses[:, None, :2]
        distances = np.hypot(places[..., 0], places[..., 1])
        distances = np.where(distances <= self._reach, distances, np.inf)  # NaN where a slot is empty
        nearest = np.argsort(distances, axis=1, kind="stable")[:, : self._people]
        there = np.isfinite(np.take_along_axis(distances, nearest, axis=1))
        rows = np.arange(len(slots))[:, None]
        count = nearest.shape[1]
        found[:, :count, 0] = 1.0
        found[:, :count, 1:3] = _rotate_vectors(places[rows, nearest], poses[:, 2]) / self._reach
        found[:, :count, 3:5] = _rotate_vectors(crowd.velocities[slots][rows, nearest], poses[:, 2])
        found[:, :count][~there] = 0.0
        columns = np.hstack((np.clip(clearances, -1.0, 1.0), found.reshape(len(slots), -1)))
        return np.nan_to_num(columns, nan=0.0).astype(np.float32)


def _rotate_vectors(vectors: NDArray[np.float64], headings: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return vectors (K, P, 2) of ``map`` along the axes of robots with these headings (K,)."""
    cosines, sines = np.cos(headings)[:, None], np.sin(headings)[:, None]
    x, y = vectors[..., 0], vectors[..., 1]
    return np.stack((cosines * x + sines * y, cosines * y - sines * x), axis=-1)
