"""Motion models in numbers: how a state of pose, velocities and interval length moves through
one interval, and the derivatives.
"""

from __future__ import annotations

import math

from arena_kernels.compiled import inner
from arena_mpc.arrays import FloatArray
from arena_mpc.columns import STEP, THETA, VELOCITIES, X, Y
from arena_mpc.parameters import ModelName

UNICYCLE, BICYCLE, OMNIDIRECTIONAL = 0, 1, 2
NUMBER: dict[ModelName, int] = {"unicycle": UNICYCLE, "bicycle": BICYCLE, "omnidirectional": OMNIDIRECTIONAL}


@inner
def body_speeds(model: int, wheelbase: float, velocities: FloatArray) -> tuple[float, float, float]:
    """Return vx, vy (m/s) and the turn rate (rad/s) of a state's velocities."""
    if model == UNICYCLE:
        return velocities[0], 0.0, velocities[1]
    if model == BICYCLE:
        return velocities[0], 0.0, velocities[0] * math.tan(velocities[1]) / wheelbase
    return velocities[0], velocities[1], velocities[2]


@inner
def integrate_motion(
    model: int, wheelbase: float, state: FloatArray, control: FloatArray, following: FloatArray
) -> None:
    """Write where ``state`` (x, y, theta, velocities, h) is after h s at the velocities
    ``control`` to ``following``.
    """
    vx, vy, omega = body_speeds(model, wheelbase, control)
    h = state[STEP]
    middle = state[THETA] + 0.5 * h * omega
    c, s = math.cos(middle), math.sin(middle)
    following[X] = state[X] + h * (c * vx - s * vy)
    following[Y] = state[Y] + h * (s * vx + c * vy)
    following[THETA] = state[THETA] + h * omega
    for i in range(len(control)):
        following[VELOCITIES + i] = control[i]
    following[STEP] = h


@inner
def differentiate_motion(
    model: int, wheelbase: float, state: FloatArray, control: FloatArray, by_state: FloatArray, by_control: FloatArray
) -> None:
    """Write the derivatives of ``integrate_motion`` to ``by_state`` (S, S) and ``by_control`` (S, U)."""
    vx, vy, omega = body_speeds(model, wheelbase, control)
    h, last = state[STEP], len(state) - 1
    middle = state[THETA] + 0.5 * h * omega
    c, s = math.cos(middle), math.sin(middle)
    ux, uy = c * vx - s * vy, s * vx + c * vy
    by_state[:] = 0.0
    by_control[:] = 0.0
    for i in range(VELOCITIES):
        by_state[i, i] = 1.0
    by_state[last, last] = 1.0
    by_state[X, THETA], by_state[Y, THETA] = -h * uy, h * ux
    by_state[X, last], by_state[Y, last], by_state[THETA, last] = (
        ux - 0.5 * h * omega * uy,
        uy + 0.5 * h * omega * ux,
        omega,
    )
    for i in range(len(control)):
        by_control[VELOCITIES + i, i] = 1.0
    turned = len(control) - 1
    by_control[X, 0], by_control[Y, 0] = h * c, h * s
    if model == OMNIDIRECTIONAL:
        by_control[X, 1], by_control[Y, 1] = -h * s, h * c
    rate = 1.0
    if model == BICYCLE:
        tangent = math.tan(control[1])
        rate = control[0] * (1.0 + tangent * tangent) / wheelbase
        turn = tangent / wheelbase
        by_control[X, 0] -= 0.5 * h * h * uy * turn
        by_control[Y, 0] += 0.5 * h * h * ux * turn
        by_control[THETA, 0] = h * turn
    by_control[X, turned] = -0.5 * h * h * uy * rate
    by_control[Y, turned] = 0.5 * h * h * ux * rate
    by_control[THETA, turned] = h * rate
