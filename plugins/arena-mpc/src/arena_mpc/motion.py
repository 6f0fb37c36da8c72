"""Motion models in numbers: how a state of pose, velocities and interval length moves through
one interval, and the derivatives.
"""

from __future__ import annotations

import math

from arena_kernels.compiled import inner
from arena_mpc.arrays import FloatArray
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
    h = state[-1]
    middle = state[2] + 0.5 * h * omega
    c, s = math.cos(middle), math.sin(middle)
    following[0] = state[0] + h * (c * vx - s * vy)
    following[1] = state[1] + h * (s * vx + c * vy)
    following[2] = state[2] + h * omega
    for i in range(len(control)):
        following[3 + i] = control[i]
    following[-1] = h


@inner
def differentiate_motion(
    model: int, wheelbase: float, state: FloatArray, control: FloatArray, by_state: FloatArray, by_control: FloatArray
) -> None:
    """Write the derivatives of ``integrate_motion`` to ``by_state`` (S, S) and ``by_control`` (S, U)."""
    vx, vy, omega = body_speeds(model, wheelbase, control)
    h, last = state[-1], len(state) - 1
    middle = state[2] + 0.5 * h * omega
    c, s = math.cos(middle), math.sin(middle)
    ux, uy = c * vx - s * vy, s * vx + c * vy
    by_state[:] = 0.0
    by_control[:] = 0.0
    for i in range(3):
        by_state[i, i] = 1.0
    by_state[last, last] = 1.0
    by_state[0, 2], by_state[1, 2] = -h * uy, h * ux
    by_state[0, last], by_state[1, last], by_state[2, last] = (
        ux - 0.5 * h * omega * uy,
        uy + 0.5 * h * omega * ux,
        omega,
    )
    for i in range(len(control)):
        by_control[3 + i, i] = 1.0
    turned = len(control) - 1
    by_control[0, 0], by_control[1, 0] = h * c, h * s
    if model == OMNIDIRECTIONAL:
        by_control[0, 1], by_control[1, 1] = -h * s, h * c
    rate = 1.0
    if model == BICYCLE:
        tangent = math.tan(control[1])
        rate = control[0] * (1.0 + tangent * tangent) / wheelbase
        turn = tangent / wheelbase
        by_control[0, 0] -= 0.5 * h * h * uy * turn
        by_control[1, 0] += 0.5 * h * h * ux * turn
        by_control[2, 0] = h * turn
    by_control[0, turned] = -0.5 * h * h * uy * rate
    by_control[1, turned] = 0.5 * h * h * ux * rate
    by_control[2, turned] = h * rate
