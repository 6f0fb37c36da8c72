"""Kalman filters of many bodies at once: state x, y, vx, vy, constant velocity with white-noise acceleration."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from arena_kernels.compiled import borrowing
from arena_navigation.tracking.discs import Discs

POSITION, VELOCITY = 0, 2


@borrowing
def predict_tracks(states: NDArray[np.float64], covariances: NDArray[np.float64], dt: float, density: float) -> None:
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
        suu, suv, svv = p[u, u] + r[0, 0], p[u, v] + r[0, 1], p[v, v] + r[1, 1]
        det = suu * svv - suv * suv
        off_u, off_v = measured[m, 0] - states[k, u], measured[m, 1] - states[k, v]
        gains = (
            ((p[0, u] * svv - p[0, v] * suv) / det, (p[0, v] * suu - p[0, u] * suv) / det),
            ((p[1, u] * svv - p[1, v] * suv) / det, (p[1, v] * suu - p[1, u] * suv) / det),
            ((p[2, u] * svv - p[2, v] * suv) / det, (p[2, v] * suu - p[2, u] * suv) / det),
            ((p[3, u] * svv - p[3, v] * suv) / det, (p[3, v] * suu - p[3, u] * suv) / det),
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
