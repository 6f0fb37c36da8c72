"""From a policy's actions in [-1, 1] to velocity commands: the one home of that scaling."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from arena_core import ConfigurationError, InvalidCommand, NonNegative, Positive, Robot
from arena_kernels.compiled import compiled

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class ActionRange:
    """What the ends of [-1, 1] mean; null is the robot's own limit. Speeds in m/s, ``wz_max`` in rad/s, ``steering_max`` in rad.

    ``vx_min`` is the least forward speed; the others are symmetric.
    """

    vx_min: float | None
    vx_max: Positive | None
    vy_max: NonNegative | None
    wz_max: Positive | None
    steering_max: Positive | None


@dataclass(frozen=True, slots=True, eq=False)
class ActionScale:
    """Scales actions (N, A): (v, w), for omnidirectional robots (vx, vy, w), for cars (v, steering angle); ``names`` says which.

    ``low`` and ``high`` (A,) are what -1 and 1 mean, m/s and rad/s or rad.
    """

    names: tuple[str, ...]
    low: FloatArray
    high: FloatArray
    wheelbase: float
    wz_max: float

    @staticmethod
    def of(robot: Robot, range_: ActionRange) -> ActionScale:
        """Make the scaling for a robot; raise ConfigurationError where the range exceeds the robot's limits."""
        own, given = robot.limits, robot.limits_with(vx_min=range_.vx_min, vx_max=range_.vx_max, vy_max=range_.vy_max, wz_max=range_.wz_max)
        steering = robot.steering_max if range_.steering_max is None else range_.steering_max
        _check_within("vx_min", range_.vx_min, own.vx_min, own.vx_max)
        _check_within("vx_max", range_.vx_max, given.vx_min, own.vx_max)
        _check_within("vy_max", range_.vy_max, 0.0, own.vy_max)
        _check_within("wz_max", range_.wz_max, 0.0, own.wz_max)
        _check_within("steering_max", range_.steering_max, 0.0, robot.steering_max)
        along, across, turning = (given.vx_min, given.vx_max), (-given.vy_max, given.vy_max), (-given.wz_max, given.wz_max)
        ends = {
            "differential": {"vx": along, "wz": turning},
            "omnidirectional": {"vx": along, "vy": across, "wz": turning},
            "ackermann": {"vx": along, "steering": (-steering, steering)},
        }[robot.kinematics]
        low, high = np.array(list(ends.values())).T
        return ActionScale(tuple(ends), low, high, robot.wheelbase, given.wz_max)

    def commands(self, actions: NDArray[np.floating]) -> FloatArray:
        """Return velocities (N, 3) in ``base_link`` for actions (N, A), cut to [-1, 1]; raise InvalidCommand for NaN."""
        shares = 0.5 * (np.clip(np.asarray(actions, np.float64), -1.0, 1.0) + 1.0)
        if not np.isfinite(shares).all():
            raise InvalidCommand("an action is not finite; allowed: numbers in [-1, 1]")
        values = self.low + shares * (self.high - self.low)
        commands = np.zeros((len(values), 3))
        commands[:, 0] = values[:, 0]
        if "vy" in self.names:
            commands[:, 1] = values[:, 1]
        commands[:, 2] = self._turns(values)
        return commands

    def _turns(self, values: FloatArray) -> FloatArray:
        if "steering" not in self.names:
            return np.asarray(values[:, -1])
        return _turn_rates(np.ascontiguousarray(values), self.wheelbase, self.wz_max)


def _check_within(name: str, value: float | None, low: float, high: float) -> None:
    if value is not None and not (math.isfinite(value) and low <= value <= high):
        raise ConfigurationError(f"action.{name} is {value:g}; allowed: {low:g} .. {high:g}, the robot's limits, or null")


@compiled
def _turn_rates(values: FloatArray, wheelbase: float, wz_max: float) -> FloatArray:
    """Return the turn rates (N,) of cars with speeds and steering angles (N, 2)."""
    rates = np.empty(len(values))
    for k in range(len(values)):
        rates[k] = min(max(values[k, 0] * math.tan(values[k, 1]) / wheelbase, -wz_max), wz_max)
    return rates
