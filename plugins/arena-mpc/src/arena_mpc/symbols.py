"""Motion models in symbols: how a state moves through one interval of constant velocity."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import casadi as ca

from arena_mpc.columns import THETA, VELOCITIES, X, Y
from arena_mpc.parameters import ModelName

Symbol = Any  # casadi's SX, which has no types


def unicycle_step(state: Symbol, control: Symbol, step: Symbol, wheelbase: Symbol) -> Symbol:
    """Move (x, y, theta, v, omega) under accelerations (a, alpha)."""
    v, omega = state[VELOCITIES] + step * control[0], state[VELOCITIES + 1] + step * control[1]
    return _integrate_pose(state, v, 0.0, omega, step, v, omega)


def bicycle_step(state: Symbol, control: Symbol, step: Symbol, wheelbase: Symbol) -> Symbol:
    """Move (x, y, theta, v, steering angle), referred to the rear axle, under an acceleration and a steering rate."""
    v, steering = state[VELOCITIES] + step * control[0], state[VELOCITIES + 1] + step * control[1]
    return _integrate_pose(state, v, 0.0, v * ca.tan(steering) / wheelbase, step, v, steering)


def omnidirectional_step(state: Symbol, control: Symbol, step: Symbol, wheelbase: Symbol) -> Symbol:
    """Move (x, y, theta, vx, vy, omega) under accelerations (ax, ay, alpha)."""
    vx, vy, omega = (state[VELOCITIES + i] + step * control[i] for i in range(3))
    return _integrate_pose(state, vx, vy, omega, step, vx, vy, omega)


def _integrate_pose(state: Symbol, vx: Symbol, vy: Symbol, omega: Symbol, step: Symbol, *velocities: Symbol) -> Symbol:
    """Integrate with the heading of the interval's middle, which is exact up to the arc's sagitta."""
    middle = state[THETA] + 0.5 * step * omega
    c, s = ca.cos(middle), ca.sin(middle)
    return ca.vertcat(
        state[X] + step * (c * vx - s * vy),
        state[Y] + step * (s * vx + c * vy),
        state[THETA] + step * omega,
        *velocities,
    )


DYNAMICS: dict[ModelName, Callable[[Symbol, Symbol, Symbol, Symbol], Symbol]] = {
    "unicycle": unicycle_step,
    "bicycle": bicycle_step,
    "omnidirectional": omnidirectional_step,
}
