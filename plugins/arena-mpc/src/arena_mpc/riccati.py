"""The backward pass: a linear-quadratic problem along the plan, solved stage by stage with the velocities' limits held
exactly.

After Tassa, Mansard and Todorov, Control-limited differential dynamic programming, 2014; the limits depend on the state
before.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from arena_kernels.compiled import borrowing, inner
from arena_mpc.arrays import FloatArray
from arena_mpc.columns import STEP, THETA, VELOCITIES, X, Y
from arena_mpc.motion import differentiate_motion
from arena_mpc.plan import Room
from arena_mpc.terms import Slopes, Terms, differentiate_interval, differentiate_stage

SWEEPS = 12  # of coordinate descent over two or three velocities, to find which are at a limit


class BackwardPass(NamedTuple):
    """What a backward pass finds: ``offsets`` (N, U) and ``gains`` (N, U, S) of the velocities; and its scratch."""

    offsets: FloatArray
    gains: FloatArray
    by_state: FloatArray
    by_control: FloatArray
    value: FloatArray
    curvature: FloatArray
    product: FloatArray
    q_state: FloatArray
    q_control: FloatArray
    q_state_state: FloatArray
    q_control_control: FloatArray
    q_control_state: FloatArray
    q_row: FloatArray
    low: FloatArray
    high: FloatArray
    held: FloatArray


def make_pass(stages: int, states: int, controls: int) -> BackwardPass:
    """Return room for a backward pass."""
    s, u = states, controls
    sizes = ((stages, u), (stages, u, s), (s, s), (s, u), s, (s, s), (s, s), s, u, (s, s), (u, u), (u, s), s, u, u, u)
    return BackwardPass(*(np.zeros(size) for size in sizes))


@inner
def velocity_limits(room: Room, state: FloatArray, low: FloatArray, high: FloatArray) -> None:
    """Write the least and greatest velocities that can be had one interval after ``state`` to
    ``low`` and ``high`` (U,).
    """
    h = state[STEP]
    for i in range(len(low)):
        low[i] = max(room.low[i], state[VELOCITIES + i] - h * room.most[i])
        high[i] = max(min(room.high[i], state[VELOCITIES + i] + h * room.most[i]), low[i])


@borrowing
def backward_pass(
    terms: Terms,
    room: Room,
    states: FloatArray,
    controls: FloatArray,
    damping: float,
    slopes: Slopes,
    found: BackwardPass,
) -> float:
    """Fill ``found`` for the plan of ``states`` (N + 1, S) and ``controls`` (N, U); return the change of
    the intervals' length, s.
    """
    found.value[:] = 0.0
    found.curvature[:] = 0.0
    for k in range(len(controls) - 1, -1, -1):
        _clear_slopes(slopes)
        differentiate_stage(terms, k + 1, states[k + 1], slopes)
        for i in range(len(found.value)):
            found.value[i] += slopes.state[i]
            for j in range(len(found.value)):
                found.curvature[i, j] += slopes.state_state[i, j]
        _clear_slopes(slopes)
        differentiate_interval(terms, states[k], controls[k], slopes)
        differentiate_motion(terms.model, terms.wheelbase, states[k], controls[k], found.by_state, found.by_control)
        _expand_cost(slopes, found)
        _choose_controls(room, states[k], controls[k], damping, found.offsets[k], found.gains[k], found)
        _propagate_value(found.offsets[k], found.gains[k], found)
    if not terms.timed:
        return 0.0
    h, last = states[0, STEP], len(found.value) - 1
    change = -found.value[last] / (found.curvature[last, last] + damping + 1e-9)
    return float(min(max(change, room.step_low - h), room.step_high - h))


@inner
def _clear_slopes(slopes: Slopes) -> None:
    slopes.state[:] = 0.0
    slopes.control[:] = 0.0
    slopes.state_state[:] = 0.0
    slopes.control_control[:] = 0.0
    slopes.control_state[:] = 0.0


@inner
def _expand_cost(slopes: Slopes, found: BackwardPass) -> None:
    """Write the quadratic model of an interval's cost and of all that follows, by state and control.

    Only the heading and the interval's length move anything but themselves, and no velocity outlasts its interval: the
    other entries of the motion's derivatives are 0 or 1, and left out.
    """
    _expand_state(slopes, found)
    last, b, p = len(found.value) - 1, found.by_control, found.curvature
    for i in range(len(found.q_control)):
        b0, b1, b2 = b[X, i], b[Y, i], b[THETA, i]
        found.q_control[i] = (
            slopes.control[i]
            + b0 * found.value[X]
            + b1 * found.value[Y]
            + b2 * found.value[THETA]
            + found.value[VELOCITIES + i]
        )
        for j in range(last + 1):
            found.q_control_state[i, j] = slopes.control_state[i, j]
            if j < 3 or j == last:
                q = found.product
                found.q_control_state[i, j] = (
                    slopes.control_state[i, j] + b0 * q[X, j] + b1 * q[Y, j] + b2 * q[THETA, j] + q[VELOCITIES + i, j]
                )
        for j in range(len(found.q_control)):
            total = slopes.control_control[i, j]
            for m in range(3):
                for n in range(3):
                    total += b[m, i] * p[m, n] * b[n, j]
                total += b[m, i] * p[m, VELOCITIES + j]
            for n in range(3):
                total += p[VELOCITIES + i, n] * b[n, j]
            found.q_control_control[i, j] = total + p[VELOCITIES + i, VELOCITIES + j]


@inner
def _expand_state(slopes: Slopes, found: BackwardPass) -> None:
    """Write the model by the state, its lower half, and the product of curvature and motion:
    columns 0 to 2 and the last.
    """
    last, a, p, q = len(found.value) - 1, found.by_state, found.curvature, found.product
    x_turn, y_turn, x_time, y_time, turn_time = a[X, THETA], a[Y, THETA], a[X, last], a[Y, last], a[THETA, last]
    for i in range(last + 1):
        q[i, X], q[i, Y] = p[i, X], p[i, Y]
        q[i, THETA] = p[i, X] * x_turn + p[i, Y] * y_turn + p[i, THETA]
        q[i, last] = p[i, X] * x_time + p[i, Y] * y_time + p[i, THETA] * turn_time + p[i, last]
        found.q_state[i] = slopes.state[i]
        for j in range(i + 1):
            found.q_state_state[i, j] = slopes.state_state[i, j]
    value, whole = found.value, found.q_state_state
    found.q_state[X] += value[X]
    found.q_state[Y] += value[Y]
    found.q_state[THETA] = found.q_state[THETA] + x_turn * value[X] + y_turn * value[Y] + value[THETA]
    found.q_state[last] = (
        found.q_state[last] + x_time * value[X] + y_time * value[Y] + turn_time * value[THETA] + value[last]
    )
    whole[X, X] += q[X, X]
    whole[Y, X] += q[Y, X]
    whole[Y, Y] += q[Y, Y]
    for j in range(3):
        whole[THETA, j] = whole[THETA, j] + x_turn * q[X, j] + y_turn * q[Y, j] + q[THETA, j]
        whole[last, j] = whole[last, j] + x_time * q[X, j] + y_time * q[Y, j] + turn_time * q[THETA, j] + q[last, j]
    whole[last, last] = (
        whole[last, last] + x_time * q[X, last] + y_time * q[Y, last] + turn_time * q[THETA, last] + q[last, last]
    )


@inner
def _choose_controls(
    room: Room,
    state: FloatArray,
    control: FloatArray,
    damping: float,
    offset: FloatArray,
    gain: FloatArray,
    found: BackwardPass,
) -> None:
    """Write the best change of the velocities within their limits to ``offset`` (U,), and how it follows
    the state to ``gain`` (U, S).
    """
    velocity_limits(room, state, found.low, found.high)
    q, count = found.q_control_control, len(control)
    for i in range(count):
        q[i, i] += damping
        offset[i] = 0.0
    for _ in range(SWEEPS):
        changed = False
        for i in range(count):
            slope, before = found.q_control[i], offset[i]
            for j in range(count):
                if j != i:
                    slope += q[i, j] * offset[j]
            offset[i] = min(max(-slope / q[i, i], found.low[i] - control[i]), found.high[i] - control[i])
            changed = changed or offset[i] != before
        if not changed:
            break
    for i in range(count):
        slope = found.q_control[i]
        for j in range(count):
            slope += q[i, j] * offset[j]
        at_low = offset[i] <= found.low[i] - control[i] and slope > 0.0
        at_high = offset[i] >= found.high[i] - control[i] and slope < 0.0
        found.held[i] = -1.0 if at_low else 1.0 if at_high else 0.0
    _follow_limits(room, found, gain)
    _follow_freely(found, gain)
    for i in range(count):
        q[i, i] -= damping


@inner
def _follow_limits(room: Room, found: BackwardPass, gain: FloatArray) -> None:
    """Write the gains of velocities at a limit: none at the greatest speed, the limit's own where
    acceleration is what limits.
    """
    gain[:] = 0.0
    for i in range(len(gain)):
        if found.held[i] < 0.0 and found.low[i] > room.low[i]:
            gain[i, VELOCITIES + i], gain[i, STEP] = 1.0, -room.most[i]
        if found.held[i] > 0.0 and found.high[i] < room.high[i]:
            gain[i, VELOCITIES + i], gain[i, STEP] = 1.0, room.most[i]


@inner
def _follow_freely(found: BackwardPass, gain: FloatArray) -> None:
    """Write the gains of the velocities that are at no limit, by Gauss-Seidel sweeps over at most three of them."""
    q, count, columns, sums = found.q_control_control, len(gain), gain.shape[1], found.q_row
    for _ in range(SWEEPS):
        for i in range(count):
            if found.held[i] != 0.0:
                continue
            for column in range(columns):
                sums[column] = found.q_control_state[i, column]
            for j in range(count):
                if j != i:
                    for column in range(columns):
                        sums[column] += q[i, j] * gain[j, column]
            for column in range(columns):
                gain[i, column] = -sums[column] / q[i, i]


@inner
def _propagate_value(offset: FloatArray, gain: FloatArray, found: BackwardPass) -> None:
    """Write value and curvature of what follows the stage's beginning, with the velocities as chosen."""
    states, controls, inside = len(found.value), len(offset), found.product
    for c in range(controls):
        total = found.q_control[c]
        for d in range(controls):
            total += found.q_control_control[c, d] * offset[d]
        found.low[c] = total
        for j in range(states):
            inside[c, j] = found.q_control_state[c, j]
        for d in range(controls):
            for j in range(states):
                inside[c, j] += found.q_control_control[c, d] * gain[d, j]
    for i in range(states):
        total = found.q_state[i]
        for c in range(controls):
            total += gain[c, i] * found.low[c] + found.q_control_state[c, i] * offset[c]
        found.value[i] = total
    for i in range(states):
        for j in range(i + 1):
            total = found.q_state_state[i, j]
            for c in range(controls):
                total += gain[c, i] * inside[c, j] + found.q_control_state[c, i] * gain[c, j]
            found.curvature[i, j] = total
            found.curvature[j, i] = total
