"""Kalman filters of many bodies at once: state x, y, vx, vy, constant velocity with white-noise acceleration."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from arena_kernels.compiled import borrowing


@borrowing
def predict(states: NDArray[np.float64], covariances: NDArray[np.float64], dt: float, density: float) -> None:
    """Move states (N, 4) and covariances (N, 4, 4) by ``dt`` s; ``density`` is that of the acceleration, m^2/s^3.

    Bar-Shalom, Li, Kirubarajan, Estimation with Applications to Tracking and Navigation, 2001, section 6.2.2.
    """
    q11, q12, q22 = density * dt * dt * dt / 3.0, density * dt * dt / 2.0, density * dt
    for k in range(len(states)):
        p = covariances[k]
        for i in range(2):
            states[k, i] += dt * states[k, i + 2]
        for row in range(4):  # P F'
            for i in range(2):
                p[row, i] += dt * p[row, i + 2]
        for column in range(4):  # F (P F')
            for i in range(2):
                p[i, column] += dt * p[i + 2, column]
        for i in range(2):
            p[i, i] += q11
            p[i, i + 2] += q12
            p[i + 2, i] += q12
            p[i + 2, i + 2] += q22


@borrowing
def correct(
    states: NDArray[np.float64],
    covariances: NDArray[np.float64],
    matches: NDArray[np.int64],
    positions: NDArray[np.float64],
    noises: NDArray[np.float64],
) -> None:
    """Take in the position ``positions[matches[k]]`` with covariance ``noises[matches[k]]`` (2, 2) for every k matched (not -1).

    The covariance is (I - K H) P (I - K H)' + K R K', Joseph's form, which stays symmetric and positive.
    """
    for k in range(len(states)):
        m = matches[k]
        if m < 0:
            continue
        p, r = covariances[k], noises[m]
        sxx, sxy, syy = p[0, 0] + r[0, 0], p[0, 1] + r[0, 1], p[1, 1] + r[1, 1]
        det = sxx * syy - sxy * sxy
        off_x, off_y = positions[m, 0] - states[k, 0], positions[m, 1] - states[k, 1]
        g00, g01 = (p[0, 0] * syy - p[0, 1] * sxy) / det, (p[0, 1] * sxx - p[0, 0] * sxy) / det
        g10, g11 = (p[1, 0] * syy - p[1, 1] * sxy) / det, (p[1, 1] * sxx - p[1, 0] * sxy) / det
        g20, g21 = (p[2, 0] * syy - p[2, 1] * sxy) / det, (p[2, 1] * sxx - p[2, 0] * sxy) / det
        g30, g31 = (p[3, 0] * syy - p[3, 1] * sxy) / det, (p[3, 1] * sxx - p[3, 0] * sxy) / det
        gains = ((g00, g01), (g10, g11), (g20, g21), (g30, g31))
        for row in range(4):
            states[k, row] += gains[row][0] * off_x + gains[row][1] * off_y
        for column in range(4):  # (I - K H) P
            p0, p1 = p[0, column], p[1, column]
            for row in range(4):
                p[row, column] -= gains[row][0] * p0 + gains[row][1] * p1
        for row in range(4):  # ... (I - K H)'
            p0, p1 = p[row, 0], p[row, 1]
            for column in range(4):
                p[row, column] -= p0 * gains[column][0] + p1 * gains[column][1]
        for row in range(4):
            for column in range(4):
                a, b = gains[row], gains[column]
                p[row, column] += a[0] * (r[0, 0] * b[0] + r[0, 1] * b[1]) + a[1] * (r[1, 0] * b[0] + r[1, 1] * b[1])
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
    """Take in the radius ``measured[matches[k]]`` with variance ``noises[matches[k]]`` for every k matched: a filter of one number."""
    for k in range(len(radii)):
        m = matches[k]
        if m >= 0:
            gain = variances[k] / (variances[k] + noises[m])
            radii[k] += gain * (measured[m] - radii[k])
            variances[k] *= 1.0 - gain
