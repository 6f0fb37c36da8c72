"""Levenberg-Marquardt on a band: banded normal equations, banded Cholesky factors, Nielsen's damping."""

from __future__ import annotations

import math

import numpy as np

from arena_kernels.compiled import borrowing, compiled, inlined, inner
from arena_kernels.scalars import Integer
from arena_teb.columns import COLUMNS, TIME
from arena_teb.problem import REACH, BandTerms, Ends, FloatArray, IntArray, Penalties, Rows, Shape, Surroundings
from arena_teb.terms import evaluate_terms, make_rows

DAMPING = 1.0  # [-] first damping
SETTLED = 0.1  # [-] damping below which a small gain means that there is little to gain, not that the step was short
# [m^2/s^2] how much more a time is damped than a position: times that collapse are slow to come back
TIME_STIFFNESS = 5.0
LEAST_SHRINK = 0.1  # [-] a good step divides the damping by no more than 10
GIVE_UP = 1e12  # [-] damping beyond which no step is worth trying
ONE, TWO = np.uint64(1), np.uint64(2)
STRIDE = np.uint64(REACH + 1)  # entries from one column to the next
# last variable that a pose's first one is joined to: of the next pose, of that after it, of its own
NEXT, AFTER_NEXT, ITSELF = 6, 10, 3


@compiled
def solve_band(
    band: FloatArray,
    penalties: Penalties,
    shape: Shape,
    ends: Ends,
    around: Surroundings,
    iterations: int,
    tolerance: float,
) -> tuple[float, int]:
    """Improve ``band`` (N, 4) in place until a step gains less than ``tolerance`` of the cost; return cost and
    iterations.

    Madsen, Nielsen and Tingleff, Methods for non-linear least squares problems, 2004, algorithm 3.16. The first pose
    stays, the last one too but for a free heading.
    """
    count = len(band)
    rows = make_rows(around)
    room = 4 * count * (REACH + 1)
    normal, gradient, joined = np.zeros(room), np.zeros(4 * count), np.empty(count, np.int64)
    factor, step, scale = np.empty(room), np.zeros(4 * count), np.ones(4 * count)
    scale[TIME::COLUMNS] = TIME_STIFFNESS
    trial = band.copy()
    cost = evaluate_terms(band, BandTerms(penalties, rows), shape, ends, around)
    normal_equations(rows, ends, normal, gradient, joined)
    damping, growth, done = DAMPING, 2.0, 0
    while done < iterations and damping < GIVE_UP:
        done += 1
        if not factorise_matrix(normal, joined, scale, damping, factor):
            damping *= growth
            growth *= 2.0
            continue
        solve_factored(factor, joined, gradient, step)
        apply_step(band, step, trial)
        found = evaluate_terms(trial, BandTerms(penalties, rows), shape, ends, around)
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
        normal_equations(rows, ends, normal, gradient, joined)
    return cost, done


@borrowing
def normal_equations(rows: Rows, ends: Ends, normal: FloatArray, gradient: FloatArray, joined: IntArray) -> None:
    """Sum up J'J (lower half: column c from its diagonal down at STRIDE c) and J'r; hold what does not move.

    ``joined`` (N,) becomes how far the first variable of each pose is joined to later ones.
    """
    for i in range(len(normal)):
        normal[i] = 0.0
    for i in range(len(gradient)):
        gradient[i] = 0.0
    for k in range(len(joined)):
        joined[k] = NEXT
    joined[-1] = ITSELF
    for row in range(rows.used[0]):
        first, width, residual, slopes = rows.first[row], rows.width[row], rows.residual[row], rows.jacobian[row]
        if width == 7:
            add_seven(slopes, residual, np.uint64(first), normal, gradient)
        elif width == 3:
            add_three(slopes, residual, np.uint64(first), normal, gradient)
        else:
            add_any(slopes, width, residual, first, normal, gradient)
        if width == REACH:
            joined[first // COLUMNS] = AFTER_NEXT
    size = len(gradient)
    for variable in range(3):
        fix_variable(variable, normal, gradient)
    fix_variable(size - 4, normal, gradient)
    fix_variable(size - 3, normal, gradient)
    if ends.heading_free == 0.0:
        fix_variable(size - 2, normal, gradient)
    fix_variable(size - 1, normal, gradient)


@inlined
def add_any(
    slopes: FloatArray, width: int, residual: float, first: int, normal: FloatArray, gradient: FloatArray
) -> None:
    """Add a term of any width."""
    for i in range(width):
        slope, column = slopes[i], (REACH + 1) * (first + i)
        gradient[first + i] += slope * residual
        for j in range(i, width):
            normal[column + j - i] += slope * slopes[j]


@inlined
def add_three(slopes: FloatArray, residual: float, first: Integer, normal: FloatArray, gradient: FloatArray) -> None:
    """Add a term of three variables."""
    a, b, c = slopes[0], slopes[1], slopes[2]
    gradient[first] += a * residual
    gradient[first + ONE] += b * residual
    gradient[first + TWO] += c * residual
    at = first * STRIDE
    normal[at] += a * a
    normal[at + ONE] += a * b
    normal[at + TWO] += a * c
    at += STRIDE
    normal[at] += b * b
    normal[at + ONE] += b * c
    normal[at + STRIDE] += c * c


@inlined
def add_seven(slopes: FloatArray, residual: float, first: Integer, normal: FloatArray, gradient: FloatArray) -> None:
    """Add a term of seven variables: unrolled, for all slopes then stay in registers."""
    values = slopes[0], slopes[1], slopes[2], slopes[3], slopes[4], slopes[5], slopes[6]
    a, b, c, d, e, f, g = values
    add_entries(gradient, first, residual, values)
    at = first * STRIDE
    add_entries(normal, at, a, values)
    at += STRIDE
    add_entries(normal, at, b, (b, c, d, e, f, g))
    at += STRIDE
    add_entries(normal, at, c, (c, d, e, f, g))
    at += STRIDE
    add_entries(normal, at, d, (d, e, f, g))
    at += STRIDE
    add_entries(normal, at, e, (e, f, g))
    at += STRIDE
    add_entries(normal, at, f, (f, g))
    normal[at + STRIDE] += g * g


@inlined
def add_entries(target: FloatArray, at: Integer, factor: float, values: tuple[float, ...]) -> None:
    """Add ``factor`` times each of the values to entries from ``at`` on."""
    for i in range(len(values)):
        target[at + np.uint64(i)] += factor * values[i]


@inner
def fix_variable(variable: int, normal: FloatArray, gradient: FloatArray) -> None:
    """Take a variable out of the equations."""
    gradient[variable] = 0.0
    stride = REACH + 1
    normal[variable * stride] = 1.0
    for i in range(1, REACH):
        normal[variable * stride + i] = 0.0
        if variable >= i:
            normal[(variable - i) * stride + i] = 0.0


@borrowing
def factorise_matrix(
    normal: FloatArray, joined: IntArray, scale: FloatArray, damping: float, factor: FloatArray
) -> bool:
    """Write the Cholesky factor of the damped normal matrix, column by column, its diagonal inverted; return whether
    there is one.

    A column is taken from those behind it as soon as it is known: nothing waits for a sum. Only what a pose is joined
    to is worked on.
    """
    for i in range(len(normal)):
        factor[i] = normal[i]
    for i in range(np.uint64(len(scale))):
        factor[i * STRIDE] += damping * scale[i] + 1e-12
    for k in range(len(joined)):
        at = np.uint64(4 * k) * STRIDE
        if joined[k] == NEXT:  # each with its constant: loops of known length are unrolled
            sound = eliminate_pose(factor, at, NEXT)
        elif joined[k] == AFTER_NEXT:
            sound = eliminate_pose(factor, at, AFTER_NEXT)
        else:
            sound = eliminate_pose(factor, at, ITSELF)
        if not sound:
            return False
    return True


@inlined
def eliminate_pose(factor: FloatArray, at: Integer, reach: int) -> bool:
    """Take the four columns of a pose from those behind, the first of them down to ``reach`` rows below it;
    return whether that can be.
    """
    sound = eliminate_column(factor, at, reach)
    sound = eliminate_column(factor, at + STRIDE, reach - 1) and sound
    sound = eliminate_column(factor, at + TWO * STRIDE, reach - 2) and sound
    return eliminate_column(factor, at + (ONE + TWO) * STRIDE, reach - 3) and sound


@inlined
def eliminate_column(factor: FloatArray, at: Integer, reach: int) -> bool:
    """Finish the column at ``at`` and take its products from ``reach`` columns behind; return
    whether its diagonal is above 0.
    """
    value = factor[at]
    inverse = 1.0 / math.sqrt(value)
    factor[at] = inverse
    for j in range(1, reach + 1):
        factor[at + np.uint64(j)] *= inverse
    for behind in range(1, reach + 1):
        shift = np.uint64(behind)
        slope = factor[at + shift]
        for j in range(reach + 1 - behind):
            factor[at + shift * STRIDE + np.uint64(j)] -= slope * factor[at + shift + np.uint64(j)]
    return bool(value > 0.0)


@borrowing
def solve_factored(factor: FloatArray, joined: IntArray, gradient: FloatArray, step: FloatArray) -> None:
    """Write the step that the factor and the gradient give."""
    stride, count = REACH + 1, len(joined)
    for i in range(len(gradient)):
        step[i] = -gradient[i]
    for k in range(count):
        for i in range(4 * k, 4 * k + 4):
            step[i] *= factor[i * stride]
            for j in range(1, joined[k] + 4 * k - i + 1):
                step[i + j] -= factor[i * stride + j] * step[i]
    for k in range(count - 1, -1, -1):
        for i in range(4 * k + 3, 4 * k - 1, -1):
            value = step[i]
            for j in range(joined[k] + 4 * k - i, 0, -1):
                value -= factor[i * stride + j] * step[i + j]
            step[i] = value * factor[i * stride]


@borrowing
def apply_step(band: FloatArray, step: FloatArray, moved: FloatArray) -> None:
    """Write the band one step further; a time shrinks linearly down to half of it, and beyond that ever more slowly."""
    for k in range(len(band)):
        for i in range(TIME):
            moved[k, i] = band[k, i] + step[COLUMNS * k + i]
        time, change = band[k, TIME], step[COLUMNS * k + TIME]
        half = 0.5 * time
        moved[k, TIME] = time + change if change > -half else half * math.exp((change + half) / half)


@borrowing
def expected_gain(step: FloatArray, gradient: FloatArray, scale: FloatArray, damping: float) -> float:
    """Return by how much the linearised problem says the cost falls."""
    total = 0.0
    for i in range(len(step)):
        total += step[i] * (damping * scale[i] * step[i] - gradient[i])
    return 0.5 * total
