"""Iterative linear-quadratic optimisation of a plan: every iterate obeys the model and its limits, so any of them can
be driven.

After Tassa, Erez and Todorov, Synthesis and stabilization of complex behaviors through online trajectory optimization,
2012. The length of the intervals is a state that does not change and is free at the beginning.
"""

from __future__ import annotations

import math

import numpy as np

from arena_kernels.compiled import borrowing, inner
from arena_mpc.arrays import FloatArray
from arena_mpc.columns import STEP, VELOCITIES
from arena_mpc.motion import BICYCLE, integrate_motion
from arena_mpc.plan import Plan, Room, Solution
from arena_mpc.riccati import BackwardPass, backward_pass, make_pass, velocity_limits
from arena_mpc.terms import Slopes, Terms, interval_cost, make_slopes, stage_cost

HALVINGS = 6  # of a step, before the model is damped instead
LEAST_DAMPING, GIVE_UP = 1e-4, 1e6  # added to the curvature, the problem's being between 1 and 1000


@borrowing
def optimise_ilqr(
    terms: Terms,
    room: Room,
    states: FloatArray,
    controls: FloatArray,
    new_states: FloatArray,
    new_controls: FloatArray,
    slopes: Slopes,
    found: BackwardPass,
    iterations: int,
    tolerance: float,
) -> tuple[float, int]:
    """Improve ``states`` (N + 1, S) and ``controls`` (N, U) in place until a step gains too little; return cost and
    iterations.

    The controls are made possible first. ``tolerance`` is the share of its cost that a step has to gain.
    """
    found.gains[:] = 0.0
    found.offsets[:] = 0.0
    cost = roll_out(terms, room, states, controls, 0.0, 0.0, new_states, new_controls, slopes, found)
    _copy_array(new_states, states)
    _copy_array(new_controls, controls)
    damping, done = 0.0, 0
    while done < iterations and damping < GIVE_UP:
        done += 1
        change = backward_pass(terms, room, states, controls, damping, slopes, found)
        share, gain = 1.0, -1.0
        for _ in range(HALVINGS):
            gain = cost - roll_out(
                terms, room, states, controls, change, share, new_states, new_controls, slopes, found
            )
            if gain > 0.0:
                break
            share *= 0.5
        if not gain > 0.0:
            damping = max(10.0 * damping, LEAST_DAMPING)
            continue
        _copy_array(new_states, states)
        _copy_array(new_controls, controls)
        settled = gain < tolerance * cost and share == 1.0
        cost -= gain
        damping = damping / 5.0 if damping > LEAST_DAMPING else 0.0
        if settled:
            break
    return cost, done


@inner
def _copy_array(source: FloatArray, target: FloatArray) -> None:
    for i in range(source.shape[0]):
        for j in range(source.shape[1]):
            target[i, j] = source[i, j]


@inner
def roll_out(
    terms: Terms,
    room: Room,
    states: FloatArray,
    controls: FloatArray,
    change: float,
    share: float,
    new_states: FloatArray,
    new_controls: FloatArray,
    slopes: Slopes,
    found: BackwardPass,
) -> float:
    """Drive the plan with ``share`` of the offsets and all of the feedback, within
    the limits; return what that costs.
    """
    for j in range(states.shape[1]):
        new_states[0, j] = states[0, j]
    new_states[0, STEP] += share * change
    cost = 0.0
    for k in range(len(controls)):
        state, control = new_states[k], new_controls[k]
        for i in range(len(control)):
            control[i] = controls[k, i] + share * found.offsets[k, i]
            for j in range(len(state)):
                control[i] += found.gains[k, i, j] * (state[j] - states[k, j])
        velocity_limits(room, state, found.low, found.high)
        for i in range(len(control)):
            control[i] = min(max(control[i], found.low[i]), found.high[i])
        if terms.model == BICYCLE:
            steepest = math.atan(room.turn * terms.wheelbase / max(abs(control[0]), 1e-3))
            control[1] = min(max(control[1], -steepest), steepest)
        integrate_motion(terms.model, terms.wheelbase, state, control, new_states[k + 1])
        cost += interval_cost(terms, state, control) + stage_cost(terms, k + 1, new_states[k + 1], slopes)
    return cost


def solve_shooting(
    terms: Terms, state: FloatArray, guess: Plan, room: Room, iterations: int, tolerance: float
) -> Solution:
    """Return what ``iterations`` make of a guess that begins at ``state`` (S - 1,): always a plan."""
    stages, velocities = len(guess.states) - 1, guess.states.shape[1] - 3
    states = np.zeros((stages + 1, len(state) + 1))
    states[0, :STEP], states[0, STEP] = state, min(max(guess.step, room.step_low), room.step_high)
    controls = guess.states[1:, VELOCITIES:].copy()
    slopes, found = make_slopes(terms, len(state) + 1, velocities), make_pass(stages, len(state) + 1, velocities)
    cost, done = optimise_ilqr(
        terms, room, states, controls, states.copy(), controls.copy(), slopes, found, iterations, tolerance
    )
    if not np.isfinite(states).all():
        return Solution(None, math.inf, done)
    return Solution(Plan(states[:, :STEP].copy(), float(states[0, STEP]), np.zeros(stages + 1)), cost, done)
