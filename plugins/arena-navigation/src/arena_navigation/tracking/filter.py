"""Kalman filters of many bodies at once: state x, y, vx, vy, constant velocity with white-noise acceleration."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from arena_kernels.compiled import borrowing
from arena_navigation.columns import VX, VY, X, Y
from arena_navigation.tracking.discs import Discs

POSITION, VELOCITY = X, VX  # where each begins in a state


@borrowing
def predict_tracks(states: NDArray[np.float64], covariances: NDArray[np.float64], dt: float, density: float) -> None:
    """Move states (N, 4) and covariances (N, 4, 4) by ``dt`` s; ``density`` is that of the acceleration, m^2/s^3.

    Bar-Shalom, Li, Kirubarajan, Estimation with Applications to Tracking and Navigation, 2001, section 6.2.2.
    """
    q11, q12, q22 = density * dt * dt * dt / 3.0, density * dt * dt / 2.0, density * dt
    for k in range(len(states)):
        p = covariances[k]
        for i in range(2):
            states[k, i] += dt * states[k, VELOCITY + i]
        for row in range(4):  # P F'
            for i in range(2):
                p[row, i] += dt * p[row, VELOCITY + i]
        for column in range(4):  # F (P F')
            for i in range(2):
                p[i, column] += dt * p[VELOCITY + i, column]
        for i in range(2):
            p[i, i] += q11
            p[i, VELOCITY + i] += q12
            p[VELOCITY + i, i] += q12
            p[VELOCITY + i, VELOCITY + i] += q22


@borrowing
def correct_tracks(
    states: NDArray[np.float64],
    covariances: NDArray[np.float64],
    matches: NDArray[np.int64],
    measured: NDArray[np.float64],
    noises: NDArray[np.float64],
    first: int,
) -> None:
    """Take in ``measured[matches[k]]`` with covariance ``noises[matches[k]]`` (2, 2) for every k matched (not -1).

    ``first`` is what was measured: POSITION or VELOCITY.

    The covariance is (I - K H) P (I - K H)' + K R K', Joseph's form, which stays symmetric and positive.
    """
    for k in range(len(states)):
        m = matches[k]
        if m < 0:
            continue
        p, r = covariances[k], noises[m]
        u, v = first, first + 1
        suu, suv, svv = p[u, u] + r[X, X], p[u, v] + r[X, Y], p[v, v] + r[Y, Y]
        det = suu * svv - suv * suv
        off_u, off_v = measured[m, X] - states[k, u], measured[m, Y] - states[k, v]
        gains = (
            ((p[X, u] * svv - p[X, v] * suv) / det, (p[X, v] * suu - p[X, u] * suv) / det),
            ((p[Y, u] * svv - p[Y, v] * suv) / det, (p[Y, v] * suu - p[Y, u] * suv) / det),
            ((p[VX, u] * svv - p[VX, v] * suv) / det, (p[VX, v] * suu - p[VX, u] * suv) / det),
            ((p[VY, u] * svv - p[VY, v] * suv) / det, (p[VY, v] * suu - p[VY, u] * suv) / det),
        )
        for row in range(4):
            states[k, row] += gains[row][0] * off_u + gains[row][1] * off_v
        for column in range(4):  # (I - K H) P
            pu, pv = p[u, column], p[v, column]
            for row in range(4):
                p[row, column] -= gains[row][0] * pu + gains[row][1] * pv
        for row in range(4):  # ... (I - K H)'
            pu, pv = p[row, u], p[row, v]
            for column in range(4):
                p[row, column] -= pu * gains[column][0] + pv * gains[column][1]
        for row in range(4):
            for column in range(4):
                a, b = gains[row], gains[column]
                p[row, column] += a[0] * (r[X, X] * b[0] + r[X, Y] * b[1]) + a[1] * (r[Y, X] * b[0] + r[Y, Y] * b[1])
        for row in range(4):  # equal to the last digit on both sides
            for column in range(row):
                p[row, column] = p[column, row]


@borrowing
def correct_radii(
    radii: NDArray[np.float64],
    variances: NDArray[np.float64],
    matches: NDArray[np.int64],
    measured: NDArray[np.float64],
    noises: NDArray[np.float64],
) -> None:
    """Take in the radius ``measured[matches[k]]`` with variance ``noises[matches[k]]`` for every
    k matched: a filter of one number.
    """
    for k in range(len(radii)):
        m = matches[k]
        if m >= 0:
            gain = variances[k] / (variances[k] + noises[m])
            radii[k] += gain * (measured[m] - radii[k])
            variances[k] *= 1.0 - gain


@borrowing
def place_by_radii(
    matches: NDArray[np.int64],
    discs: Discs,
    radii: NDArray[np.float64],
    variances: NDArray[np.float64],
    noise: float,
    positions: NDArray[np.float64],
    noises: NDArray[np.float64],
) -> None:
    """Write where each matched disc lies, (N, 2) and (N, 2, 2), given what its track knows of the radius.

    The conditional of a Gaussian, for a scan alone hardly tells a larger disc from a smaller one that is nearer. Bodies
    keep their radius but for ``noise`` m.
    """
    for k in range(len(matches)):
        m = matches[k]
        if m < 0:
            continue
        total = discs.radius_variances[m] + variances[k] + noise * noise
        off = (discs.radii[m] - radii[k]) / total
        for i in range(2):
            positions[k, i] = discs.positions[m, i] - discs.leanings[m, i] * off
            for j in range(2):
                noises[k, i, j] = discs.covariances[m, i, j] - discs.leanings[m, i] * discs.leanings[m, j] / total
