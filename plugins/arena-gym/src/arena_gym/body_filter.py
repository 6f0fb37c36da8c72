"""The Kalman filter of one body whose axes are alike: constant velocity with white-noise acceleration.

As the tracker ``kalman`` filters where its measurements are equally unsure along both axes.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arena_kernels.compiled import inner

Floats = NDArray[np.float64]


class FilterNumbers(NamedTuple):
    """``density`` of the acceleration (m^2/s^3), variances of a new body's speed and of a stand (m^2/s^2), and what the
    robot's own pose leaves open (m, rad).
    """

    density: float
    speed_variance: float
    standing_variance: float
    position_doubt: float
    heading_doubt: float


@inner
def predict_body(state: Floats, covariance: Floats, dt: float, density: float) -> None:
    """Move a state (x, y, vx, vy) and the covariance (place, both, speed) of either axis by ``dt`` s."""
    state[0] += dt * state[2]
    state[1] += dt * state[3]
    covariance[0] += dt * (2.0 * covariance[1] + dt * covariance[2]) + density * dt * dt * dt / 3.0
    covariance[1] += dt * covariance[2] + density * dt * dt / 2.0
    covariance[2] += density * dt


@inner
def measure_position(state: Floats, covariance: Floats, measured: tuple[float, float], variance: float) -> None:
    """Take in a measured place (m) with its variance along an axis (m^2)."""
    total = covariance[0] + variance
    place, speed = covariance[0] / total, covariance[1] / total
    for axis in range(2):
        off = measured[axis] - state[axis]
        state[axis] += place * off
        state[axis + 2] += speed * off
    covariance[2] -= speed * covariance[1]
    covariance[1] *= 1.0 - place
    covariance[0] *= 1.0 - place


@inner
def measure_rest(state: Floats, covariance: Floats, variance: float) -> None:
    """Take in that the body stands, with a variance along an axis (m^2/s^2)."""
    total = covariance[2] + variance
    place, speed = covariance[1] / total, covariance[2] / total
    for axis in range(2):
        off = -state[axis + 2]
        state[axis] += place * off
        state[axis + 2] += speed * off
    covariance[0] -= place * covariance[1]
    covariance[1] *= 1.0 - speed
    covariance[2] *= 1.0 - speed
