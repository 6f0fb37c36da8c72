"""The localisers without a filter: the exact pose, and dead reckoning, which drifts."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from arena_core import Localizer, OccupancyGrid, Pose, PoseEstimate, ReferenceLocalizer, Robot, Sensors
from arena_navigation.amcl.odometry_history import OdometryHistory


class GroundTruthLocalizer(ReferenceLocalizer):
    """Believes an external positioning system, which in simulation is exact."""

    def begin(self, keys: NDArray[np.uint64], slots: NDArray[np.int64], total: int) -> None:
        """Begin episodes; nothing is kept."""

    def estimates(self, poses: NDArray[np.float64], slots: NDArray[np.int64]) -> NDArray[np.float64]:
        """Return the poses themselves."""
        return poses


class OdometryLocalizer(Localizer):
    """Adds up what the wheels report since the start, without ever looking at the map."""

    def __init__(self, robot: Robot) -> None:
        self._odometry = robot.odometry

    def reset(self, grid: OccupancyGrid | None, start: Pose, random: np.random.Generator) -> None:
        """Begin at ``start``, taken for exact."""
        self._history = OdometryHistory()
        self._start = start
        self._origin: Pose | None = None
        self._last: tuple[float, Pose] | None = None
        self._covariance = np.zeros((3, 3))

    def update(self, sensors: Sensors) -> PoseEstimate:
        """Return the start pose, moved as odometry has moved since the first message; the covariance grows with it."""
        self._history.add(sensors.odometry)
        odometry = self._history.at(sensors.stamp)
        if self._origin is None or self._last is None:
            self._origin, self._last = odometry, (sensors.stamp, odometry)
        pose = self._start.compose(self._origin.relative(odometry))
        before = self._start.compose(self._origin.relative(self._last[1]))
        self._covariance = self._next_covariance(before, before.relative(pose), sensors.stamp - self._last[0])
        self._last = (sensors.stamp, odometry)
        return PoseEstimate(pose, self._covariance)

    def _next_covariance(
        self, pose: Pose, step: Pose, duration: float
    ) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
        """Return the covariance after one more ``step``, to first order.

        Probabilistic Robotics, table 5.6, whose variances are those of one message: n messages of a step each report a
        n-th of it, so that their variances add up to a n-th of what one message would have.
        """
        travel, turned = math.hypot(step.x, step.y), step.theta
        share = min(self._odometry.period / duration, 1.0) if duration > 0.0 else 0.0
        along = share * (self._odometry.alpha3 * travel**2 + self._odometry.alpha4 * turned**2)
        turn = share * (self._odometry.alpha1 * turned**2 + 2.0 * self._odometry.alpha2 * travel**2)
        c, s = math.cos(pose.theta), math.sin(pose.theta)
        moved = np.array(((1.0, 0.0, -s * step.x - c * step.y), (0.0, 1.0, c * step.x - s * step.y), (0.0, 0.0, 1.0)))
        heading = pose.theta + math.atan2(step.y, step.x)
        noise = np.array(((math.cos(heading), 0.0), (math.sin(heading), 0.0), (0.0, 1.0)))
        grown: np.ndarray[tuple[int, int], np.dtype[np.float64]] = (
            moved @ self._covariance @ moved.T + noise @ np.diag((along, turn)) @ noise.T
        )
        return grown
