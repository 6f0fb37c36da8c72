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
    h = state[-1]
    for i in range(len(low)):
        low[i] = max(room.low[i], state[3 + i] - h * room.most[i])
        high[i] = max(min(room.high[i], state[3 + i] + h * room.most[i]), low[i])


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
    h, last = states[0, -1], len(found.value) - 1
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
        b0, b1, b2 = b[0, i], b[1, i], b[2, i]
        found.q_control[i] = (
            slopes.control[i] + b0 * found.value[0] + b1 * found.value[1] + b2 * found.value[2] + found.value[3 + i]
        )
        for j in range(last + 1):
            found.q_control_state[i, j] = slopes.control_state[i, j]
            if j < 3 or j == last:
                q = found.product
                found.q_control_state[i, j] = (
                    slopes.control_state[i, j] + b0 * q[0, j] + b1 * q[1, j] + b2 * q[2, j] + q[3 + i, j]
                )
        for j in range(len(found.q_control)):
            total = slopes.control_control[i, j]
            for m in range(3):
                for n in range(3):
                    total += b[m, i] * p[m, n] * b[n, j]
                total += b[m, i] * p[m, 3 + j]
            for n in range(3):
                total += p[3 + i, n] * b[n, j]
            found.q_control_control[i, j] = total + p[3 + i, 3 + j]


@inner
def _expand_state(slopes: Slopes, found: BackwardPass) -> None:
    """Write the model by the state, its lower half, and the product of curvature and motion:
    columns 0 to 2 and the last.
    """
    last, a, p, q = len(found.value) - 1, found.by_state, found.curvature, found.product
    x_turn, y_turn, x_time, y_time, turn_time = a[0, 2], a[1, 2], a[0, last], a[1, last], a[2, last]
    for i in range(last + 1):
        q[i, 0], q[i, 1] = p[i, 0], p[i, 1]
        q[i, 2] = p[i, 0] * x_turn + p[i, 1] * y_turn + p[i, 2]
        q[i, last] = p[i, 0] * x_time + p[i, 1] * y_time + p[i, 2] * turn_time + p[i, last]
        found.q_state[i] = slopes.state[i]
        for j in range(i + 1):
            found.q_state_state[i, j] = slopes.state_state[i, j]
    value, whole = found.value, found.q_state_state
    found.q_state[0] += value[0]
    found.q_state[1] += value[1]
    found.q_state[2] = found.q_state[2] + x_turn * value[0] + y_turn * value[1] + value[2]
    found.q_state[last] = (
        found.q_state[last] + x_time * value[0] + y_time * value[1] + turn_time * value[2] + value[last]
    )
    whole[0, 0] += q[0, 0]
    whole[1, 0] += q[1, 0]
    whole[1, 1] += q[1, 1]
    for j in range(3):
        whole[2, j] = whole[2, j] + x_turn * q[0, j] + y_turn * q[1, j] + q[2, j]
        whole[last, j] = whole[last, j] + x_time * q[0, j] + y_time * q[1, j] + turn_time * q[2, j] + q[last, j]
    whole[last, last] = (
        whole[last, last] + x_time * q[0, last] + y_time * q[1, last] + turn_time * q[2, last] + q[last, last]
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
            gain[i, 3 + i], gain[i, -1] = 1.0, -room.most[i]
        if found.held[i] > 0.0 and found.high[i] < room.high[i]:
            gain[i, 3 + i], gain[i, -1] = 1.0, room.most[i]


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
