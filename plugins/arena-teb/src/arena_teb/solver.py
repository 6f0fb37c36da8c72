"""Levenberg-Marquardt on a band: banded normal equations, banded Cholesky factors, Nielsen's damping."""

from __future__ import annotations

import math

import numpy as np

from arena_kernels.compiled import borrowing, compiled, inner
from arena_teb.problem import REACH, Ends, FloatArray, Penalties, Rows, Shape, Surroundings
from arena_teb.terms import evaluate, make_rows

DAMPING = 1.0  # [-] first damping
SETTLED = 0.1  # [-] damping below which a small gain means that there is little to gain, not that the step was short
TIME_STIFFNESS = 5.0  # [m^2/s^2] how much more a time is damped than a position: times that collapse are slow to come back
LEAST_SHRINK = 0.1  # [-] a good step divides the damping by no more than 10
GIVE_UP = 1e12  # [-] damping beyond which no step is worth trying
DIAGONAL = REACH - 1  # column of the diagonal in band storage


@compiled
def solve(
    band: FloatArray,
    penalties: Penalties,
    shape: Shape,
    ends: Ends,
    around: Surroundings,
    iterations: int,
    tolerance: float,
) -> tuple[float, int]:
    """Improve ``band`` (N, 4) in place until a step gains less than ``tolerance`` of the cost; return cost and iterations.

    Madsen, Nielsen and Tingleff, Methods for non-linear least squares problems, 2004, algorithm 3.16. The first pose stays, the
    last one too but for a free heading.
    """
    count = len(band)
    rows = make_rows(around)
    normal, gradient = np.zeros((4 * count, REACH)), np.zeros(4 * count)
    factor, step, scale = np.zeros((4 * count, REACH)), np.zeros(4 * count), np.ones(4 * count)
    scale[3::4] = TIME_STIFFNESS
    trial = band.copy()
    cost = evaluate(band, penalties, shape, ends, around, rows)
    normal_equations(rows, ends, normal, gradient)
    damping, growth, done = DAMPING, 2.0, 0
    while done < iterations and damping < GIVE_UP:
        done += 1
        if not factorise(normal, scale, damping, factor):
            damping *= growth
            growth *= 2.0
            continue
        backsolve(factor, gradient, step)
        move(band, step, trial)
        found = evaluate(trial, penalties, shape, ends, around, rows)
        gain = cost - found
        expected = expected_gain(step, gradient, scale, damping)
        if damping < SETTLED and expected <= 0.1 * tolerance * cost:
            break
        if not gain > 0.0:
            damping *= growth
            growth *= 2.0
            continue
        band[:] = trial
        converged = damping < SETTLED and gain < tolerance * cost
        damping *= max(LEAST_SHRINK, 1.0 - (2.0 * gain / expected - 1.0) ** 3)
        growth = 2.0
        cost = found
        if converged:
            break
        normal_equations(rows, ends, normal, gradient)
    return cost, done


@borrowing
def normal_equations(rows: Rows, ends: Ends, normal: FloatArray, gradient: FloatArray) -> None:
    """Sum up J'J (lower half in band storage: column REACH - 1 is the diagonal) and J'r; hold what does not move."""
    normal[:] = 0.0
    gradient[:] = 0.0
    for row in range(len(rows.residual)):
        width, first, residual = rows.width[row], rows.first[row], rows.residual[row]
        for i in range(width):
            slope = rows.jacobian[row, i]
            gradient[first + i] += slope * residual
            for j in range(i + 1):
                normal[first + i, DIAGONAL - i + j] += slope * rows.jacobian[row, j]
    size = len(gradient)
    for variable in range(3):
        hold(variable, normal, gradient)
    hold(size - 4, normal, gradient)
    hold(size - 3, normal, gradient)
    if ends.heading_free == 0.0:
        hold(size - 2, normal, gradient)
    hold(size - 1, normal, gradient)


@inner
def hold(variable: int, normal: FloatArray, gradient: FloatArray) -> None:
    """Take a variable out of the equations."""
    gradient[variable] = 0.0
    normal[variable, :] = 0.0
    normal[variable, DIAGONAL] = 1.0
    for below in range(variable + 1, min(variable + REACH, len(gradient))):
        normal[below, DIAGONAL - (below - variable)] = 0.0


@borrowing
def factorise(normal: FloatArray, scale: FloatArray, damping: float, factor: FloatArray) -> bool:
    """Write the Cholesky factor of the damped normal matrix, its diagonal inverted; return whether there is one."""
    for i in range(len(normal)):
        for column in range(REACH):
            j = i - DIAGONAL + column
            if j < 0:
                factor[i, column] = 0.0
                continue
            value = normal[i, column]
            shift = i - j
            if shift == 0:
                value += damping * scale[i] + 1e-12
            for m in range(column):
                if m - column + DIAGONAL >= 0:
                    value -= factor[i, m] * factor[j, m + shift]
            if shift > 0:
                factor[i, column] = value * factor[j, DIAGONAL]
            else:
                if not value > 0.0:
                    return False
                factor[i, DIAGONAL] = 1.0 / math.sqrt(value)
    return True


@borrowing
def backsolve(factor: FloatArray, gradient: FloatArray, step: FloatArray) -> None:
    """Write the step that the factor and the gradient give."""
    size = len(gradient)
    for i in range(size):
        value = -gradient[i]
        for column in range(max(0, DIAGONAL - i), DIAGONAL):
            value -= factor[i, column] * step[i - DIAGONAL + column]
        step[i] = value * factor[i, DIAGONAL]
    for i in range(size - 1, -1, -1):
        step[i] *= factor[i, DIAGONAL]
        for column in range(max(0, DIAGONAL - i), DIAGONAL):
            step[i - DIAGONAL + column] -= factor[i, column] * step[i]


@borrowing
def move(band: FloatArray, step: FloatArray, moved: FloatArray) -> None:
    """Write the band one step further; a time shrinks linearly down to half of it, and beyond that ever more slowly."""
    for k in range(len(band)):
        for i in range(3):
            moved[k, i] = band[k, i] + step[4 * k + i]
        time, change = band[k, 3], step[4 * k + 3]
        half = 0.5 * time
        moved[k, 3] = time + change if change > -half else half * math.exp((change + half) / half)


@borrowing
def expected_gain(step: FloatArray, gradient: FloatArray, scale: FloatArray, damping: float) -> float:
    """Return by how much the linearised problem says the cost falls."""
    total = 0.0
    for i in range(len(step)):
        total += step[i] * (damping * scale[i] * step[i] - gradient[i])
    return 0.5 * total
