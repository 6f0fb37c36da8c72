"""The predictor that errs in nothing for a while: what foresight could be worth."""

from __future__ import annotations

import math
from typing import Annotated, ClassVar

import numpy as np
from numpy.typing import NDArray

from arena_core import Observation, OccupancyGrid, Pose, Predictions, Predictor, Tracks
from arena_core.hosting import PeopleAhead, Truth
from arena_core.parameters import Bounds, Positive

FloatArray = NDArray[np.float64]
Horizon = Annotated[float, Bounds(low=0.0, high=60.0)]  # s
Step = Annotated[float, Bounds(low=0.05, high=10.0)]  # s: several ticks


class TrueFuture(Predictor):
    """Tell what people will truly do for ``horizon`` s, every ``step`` s; from then on each keeps its velocity.

    A track is the nearest person's within ``gate`` m, and moves as that one does: what the tracker errs by stays. One
    that is nobody's keeps its velocity. People walk as if the robot were not there.
    """

    privileged: ClassVar[bool] = True

    def __init__(self, horizon: Horizon, step: Step, gate: Positive) -> None:
        steps = max(math.ceil(horizon / step - 1e-9), 1) if horizon > 0.0 else 0
        self._times = np.minimum(np.arange(steps + 1) * step, horizon)
        self._gate = gate
        self._truth: Truth | None = None

    def see(self, truth: Truth) -> None:
        """Take the truth of the episode that begins."""
        self._truth = truth

    def reset(self, grid: OccupancyGrid | None) -> None:
        """Begin an episode; the truth needs no memory."""

    def predict(self, observation: Observation) -> Predictions:
        """Return where the people whom the tracks are of will be."""
        assert self._truth is not None, "a navigator shows the truth ahead of every reset"
        tracks = observation.tracks
        if not len(tracks.ids):
            return Predictions.straight(tracks.positions, tracks.velocities, tracks.covariances)
        pose = self._truth.state().pose
        return follow_people(tracks, observation.pose, pose, self._truth.people_ahead(self._times), self._gate)


def follow_people(tracks: Tracks, believed: Pose, pose: Pose, ahead: PeopleAhead, gate: float) -> Predictions:
    """Return what tracks do whose people go where they are ``ahead``; the robot is at ``pose`` and believes to be
    elsewhere, and people are tracked as they stand to it.
    """
    turn = _rotation(believed.theta - pose.theta)
    ways = ahead.positions - (pose.x, pose.y)
    ways = ways @ turn.T + (believed.x, believed.y)
    whose = _nearest_person(tracks.positions, ways[:, 0], gate)
    times = ahead.times
    means = tracks.positions[:, None] + tracks.velocities[:, None] * times[:, None]
    velocities = tracks.velocities.copy()
    found = np.flatnonzero(whose >= 0)
    for track, person in zip(found.tolist(), whose[found].tolist(), strict=True):
        moved = ways[person] - ways[person, 0]
        here = np.isfinite(moved[:, 0])
        last = len(times) - 1 if here.all() else int(here.argmin()) - 1  # who leaves the world is last seen at the door
        means[track] = tracks.positions[track] + moved[np.minimum(np.arange(len(times)), last)]
        gone = last < len(times) - 1
        velocities[track] = 0.0 if gone else turn @ ahead.velocities[person, -1]
    if len(times) == 1:
        return Predictions.straight(tracks.positions, velocities, tracks.covariances)
    covariances = np.repeat(tracks.covariances[:, None, :2, :2], len(times), axis=1)
    return Predictions.of(times, means, covariances, velocities)


def _nearest_person(positions: FloatArray, people: FloatArray, gate: float) -> NDArray[np.int64]:
    """Return who is nearest to each of ``positions`` (K, 2) among ``people`` (P, 2), -1 where no one is within the
    gate.
    """
    away = np.hypot(*np.moveaxis(positions[:, None] - people, 2, 0))
    away = np.where(np.isfinite(away), away, np.inf)
    if not away.size:
        return np.full(len(positions), -1)
    return np.where(away.min(axis=1) <= gate, away.argmin(axis=1), -1)


def _rotation(angle: float) -> FloatArray:
    c, s = math.cos(angle), math.sin(angle)
    return np.array(((c, -s), (s, c)))
