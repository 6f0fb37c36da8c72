"""The terms of the objective in numbers, with gradients and Gauss-Newton curvatures: what an interval costs, and what a
stage does.

The slack of a stage is eliminated: it is the greatest shortfall of any distance, rounded off so that it has a
derivative.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from arena_kernels.compiled import inner
from arena_mpc.arrays import FloatArray
from arena_mpc.columns import (
    HEADING,
    HEADING_COUNTS,
    MOVER_RADIUS,
    MOVER_VX,
    MOVER_VY,
    MOVER_X,
    MOVER_Y,
    NORMAL_X,
    NORMAL_Y,
    PLANE,
    PLANE_OFFSET,
    PLANE_X,
    PLANE_Y,
    REFERENCE_X,
    REFERENCE_Y,
    STAGE_HEAD,
    STEP,
    THETA,
    VELOCITIES,
    VIA_COUNTS,
    VIA_X,
    VIA_Y,
    X,
    Y,
)
from arena_mpc.objective import (
    ANGULAR,
    CONTROL_ANGULAR,
    CONTROL_LINEAR,
    GOAL_HEADING,
    GOAL_POSITION,
    LINEAR,
    PATH,
    PATH_HEADING,
    SLACK,
    SLACK_SQUARED,
    STATE_HEADING,
    STATE_POSITION,
    TIME,
    VIA_POINTS,
    add_regulation,
    add_slack,
    end_objective,
    interval_objective,
    squared_distance,
    stage_objective,
)

SMOOTH = 1e-6  # m^2, rounds the cone of a distance off at its tip
ROUNDING = 0.02  # m, within which the greatest shortfall is rounded off: less than half a usual cell
FAR_OFF = 12.0  # shortfalls below -FAR_OFF * ROUNDING weigh nothing
NOTHING = -746.0  # exponent whose exponential is 0 in double precision


class Terms(NamedTuple):
    """The numbers of one problem: N intervals, C discs of the footprint, M moving obstacles.

    ``goal`` (3,) counts with its heading if ``goal_heading`` is 1; ``weights`` in the order of WEIGHTS; ``discs_xy``
    (C, 2) m; ``movers`` (N + 1, M, MOVER); ``rows`` (N + 1, STAGE_HEAD + PLANE for each disc and half-plane); ``step``
    is the wanted one, s.
    """

    model: int
    timed: bool
    wheelbase: float
    step: float
    growth: float
    speed_distance: float
    goal_heading: float
    goal: FloatArray
    weights: FloatArray
    discs_xy: FloatArray
    movers: FloatArray
    rows: FloatArray


class Slopes(NamedTuple):
    """Where a stage's derivatives are gathered: of the cost by state and control, and of every
    distance (D,) by state (D, S).
    """

    state: FloatArray
    control: FloatArray
    state_state: FloatArray
    control_control: FloatArray
    control_state: FloatArray
    gaps: FloatArray
    gap_state: FloatArray
    mean: FloatArray


def make_slopes(terms: Terms, states: int, controls: int) -> Slopes:
    """Return room for the derivatives of one stage."""
    planes = (terms.rows.shape[1] - STAGE_HEAD) // PLANE
    distances = planes + len(terms.discs_xy) * terms.movers.shape[1]
    sizes = (
        states,
        controls,
        (states, states),
        (controls, controls),
        (controls, states),
        distances,
        (distances, states),
        states,
    )
    return Slopes(*(np.zeros(size) for size in sizes))


@inner
def interval_cost(terms: Terms, state: FloatArray, control: FloatArray) -> float:
    """Return what the interval that begins at ``state`` (S,) costs with velocities ``control`` (U,): its
    time, and the accelerations.
    """
    h, last = state[STEP], len(control) - 1
    linear = 0.0
    for i in range(last):
        linear += ((control[i] - state[VELOCITIES + i]) / h) ** 2
    angular = ((control[last] - state[VELOCITIES + last]) / h) ** 2
    return float(interval_objective(terms.weights, terms.timed, terms.step, h, linear, angular))


@inner
def differentiate_interval(terms: Terms, state: FloatArray, control: FloatArray, slopes: Slopes) -> None:
    """Add the derivatives of an interval's cost."""
    h, count, end = state[STEP], len(control), len(state) - 1
    if terms.timed:
        slopes.state[end] += terms.weights[TIME]
    for i in range(count):
        weight = 2.0 * terms.step * terms.weights[ANGULAR if i == count - 1 else LINEAR]
        acceleration = (control[i] - state[VELOCITIES + i]) / h
        by_v, by_w, by_h = -1.0 / h, 1.0 / h, -acceleration / h
        slopes.control[i] += weight * acceleration * by_w
        slopes.state[VELOCITIES + i] += weight * acceleration * by_v
        slopes.state[end] += weight * acceleration * by_h
        slopes.control_control[i, i] += weight * by_w * by_w
        slopes.control_state[i, VELOCITIES + i] += weight * by_w * by_v
        slopes.control_state[i, end] += weight * by_w * by_h
        slopes.state_state[VELOCITIES + i, VELOCITIES + i] += weight * by_v * by_v
        slopes.state_state[VELOCITIES + i, end] += weight * by_v * by_h
        slopes.state_state[end, VELOCITIES + i] += weight * by_v * by_h
        slopes.state_state[end, end] += weight * by_h * by_h


@inner
def stage_cost(terms: Terms, k: int, state: FloatArray, slopes: Slopes) -> float:
    """Return what it costs to be at ``state`` (S,) at stage ``k`` > 0; the last stage is the plan's end."""
    weights, row, goal = terms.weights, terms.rows[k], terms.goal
    cost = stage_objective(weights, terms.step, state, row, _squared_chord(state[THETA] - row[HEADING]))
    away, turned = squared_distance(state, goal), terms.goal_heading * _squared_chord(state[THETA] - goal[THETA])
    if not terms.timed:
        cost = add_regulation(weights, cost, state, away, turned)
    if k == len(terms.rows) - 1:
        cost += end_objective(weights, away, turned)
    write_distances(terms, k, state, slopes, False)
    return float(add_slack(weights, cost, _smooth_shortfall(slopes.gaps)))


@inner
def differentiate_stage(terms: Terms, k: int, state: FloatArray, slopes: Slopes) -> None:
    """Add the derivatives of a stage's cost."""
    weights, row, goal = terms.weights, terms.rows[k], terms.goal
    _add_square(
        slopes,
        row[NORMAL_X],
        row[NORMAL_Y],
        (state[X] - row[REFERENCE_X]) * row[NORMAL_X] + (state[Y] - row[REFERENCE_Y]) * row[NORMAL_Y],
        terms.step * weights[PATH],
    )
    _add_square(slopes, 1.0, 0.0, state[X] - row[VIA_X], row[VIA_COUNTS] * weights[VIA_POINTS])
    _add_square(slopes, 0.0, 1.0, state[Y] - row[VIA_Y], row[VIA_COUNTS] * weights[VIA_POINTS])
    _add_chord(slopes, state[THETA] - row[HEADING], terms.step * weights[PATH_HEADING] * row[HEADING_COUNTS])
    position, heading = 0.0, 0.0
    if not terms.timed:
        position, heading = weights[STATE_POSITION], weights[STATE_HEADING]
        for i in range(VELOCITIES, len(state) - 1):
            weight = 2.0 * weights[CONTROL_ANGULAR if i == len(state) - 2 else CONTROL_LINEAR]
            slopes.state[i] += weight * state[i]
            slopes.state_state[i, i] += weight
    if k == len(terms.rows) - 1:
        position, heading = position + weights[GOAL_POSITION], heading + weights[GOAL_HEADING]
    _add_square(slopes, 1.0, 0.0, state[X] - goal[X], position)
    _add_square(slopes, 0.0, 1.0, state[Y] - goal[Y], position)
    _add_chord(slopes, state[THETA] - goal[THETA], terms.goal_heading * heading)
    write_distances(terms, k, state, slopes, True)
    _add_slack(slopes, weights[SLACK], weights[SLACK_SQUARED])


@inner
def _squared_chord(angle: float) -> float:
    return 2.0 * (1.0 - math.cos(angle))


@inner
def _add_chord(slopes: Slopes, angle: float, weight: float) -> None:
    slopes.state[THETA] += 2.0 * weight * math.sin(angle)
    slopes.state_state[THETA, THETA] += 2.0 * weight * max(math.cos(angle), 0.0)


@inner
def _add_square(slopes: Slopes, nx: float, ny: float, residual: float, weight: float) -> None:
    slopes.state[X] += 2.0 * weight * residual * nx
    slopes.state[Y] += 2.0 * weight * residual * ny
    slopes.state_state[X, X] += 2.0 * weight * nx * nx
    slopes.state_state[X, Y] += 2.0 * weight * nx * ny
    slopes.state_state[Y, X] += 2.0 * weight * nx * ny
    slopes.state_state[Y, Y] += 2.0 * weight * ny * ny


@inner
def write_distances(terms: Terms, k: int, state: FloatArray, slopes: Slopes, derived: bool) -> None:
    """Write how far each disc is from its half-planes and from each moving obstacle, less what
    speed asks for; if asked, derived.
    """
    c, s, time = math.cos(state[THETA]), math.sin(state[THETA]), k * state[STEP]
    planes = (terms.rows.shape[1] - STAGE_HEAD) // (PLANE * len(terms.discs_xy))
    speed_squared = SMOOTH
    for i in range(VELOCITIES, len(state) - 2):
        speed_squared += state[i] * state[i]
    speed = math.sqrt(speed_squared)
    found = 0
    for d in range(len(terms.discs_xy)):
        ox, oy = (
            c * terms.discs_xy[d, X] - s * terms.discs_xy[d, Y],
            s * terms.discs_xy[d, X] + c * terms.discs_xy[d, Y],
        )
        x, y = state[X] + ox, state[Y] + oy
        for j in range(planes):
            at = STAGE_HEAD + PLANE * (d * planes + j)
            nx, ny = terms.rows[k, at + PLANE_X], terms.rows[k, at + PLANE_Y]
            slopes.gaps[found] = nx * x + ny * y - terms.rows[k, at + PLANE_OFFSET] - terms.speed_distance * speed
            if derived:
                _derive_gap(slopes, found, terms.speed_distance / speed, state, nx, ny, ox, oy, 0.0)
            found += 1
        for m in range(terms.movers.shape[1]):
            mx, my, vx, vy, radius = (
                terms.movers[k, m, MOVER_X],
                terms.movers[k, m, MOVER_Y],
                terms.movers[k, m, MOVER_VX],
                terms.movers[k, m, MOVER_VY],
                terms.movers[k, m, MOVER_RADIUS],
            )
            dx, dy = x - mx - time * vx, y - my - time * vy
            away = math.sqrt(dx * dx + dy * dy + SMOOTH)
            slopes.gaps[found] = away - radius - time * terms.growth - terms.speed_distance * speed
            if derived:
                by_step = -k * ((dx * vx + dy * vy) / away + terms.growth)
                _derive_gap(slopes, found, terms.speed_distance / speed, state, dx / away, dy / away, ox, oy, by_step)
            found += 1


@inner
def _derive_gap(
    slopes: Slopes, i: int, share: float, state: FloatArray, nx: float, ny: float, ox: float, oy: float, by_step: float
) -> None:
    """Write the derivative of distance ``i`` along (nx, ny) of a disc at (ox, oy) from the robot."""
    row = slopes.gap_state[i]
    row[X], row[Y], row[THETA] = nx, ny, ny * ox - nx * oy
    row[VELOCITIES:STEP] = 0.0
    for j in range(VELOCITIES, len(state) - 2):
        row[j] = -share * state[j]
    row[STEP] = by_step


@inner
def _smooth_shortfall(gaps: FloatArray) -> float:
    """Return the greatest shortfall of any distance, or none, rounded off: the logarithm of a sum of exponentials."""
    worst = -FAR_OFF
    for i in range(len(gaps)):
        worst = max(worst, -gaps[i] / ROUNDING)
    if worst <= -FAR_OFF:
        return 0.0
    top = max(worst, 0.0)
    total = math.exp(-top)
    for i in range(len(gaps)):
        exponent = -gaps[i] / ROUNDING - top
        if exponent > NOTHING:
            total += math.exp(exponent)
    return ROUNDING * (top + math.log(total))


@inner
def _add_slack(slopes: Slopes, weight: float, weight_squared: float) -> None:
    """Add the derivatives of the price of the slack; its curvature is that of a convex function of the
    distances, taken as linear.
    """
    gaps, rows, mean = slopes.gaps, slopes.gap_state, slopes.mean
    slack = _smooth_shortfall(gaps)
    if slack == 0.0:
        return
    price, bend = weight + 2.0 * weight_squared * slack, 2.0 * weight_squared
    mean[:] = 0.0
    for i in range(len(gaps)):
        exponent = (-gaps[i] - slack) / ROUNDING
        share = math.exp(exponent) if exponent > NOTHING else 0.0
        if share < 1e-6:
            continue
        for a in range(len(mean)):
            if rows[i, a] == 0.0:
                continue
            mean[a] += share * rows[i, a]
            scaled = price * share / ROUNDING * rows[i, a]
            for b in range(len(mean)):
                slopes.state_state[a, b] += scaled * rows[i, b]
    for a in range(len(mean)):
        slopes.state[a] -= price * mean[a]
        for b in range(len(mean)):
            slopes.state_state[a, b] += (bend - price / ROUNDING) * mean[a] * mean[b]
