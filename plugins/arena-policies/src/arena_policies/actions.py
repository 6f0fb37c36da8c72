"""From a policy's actions in [-1, 1] to velocity commands: the one home of that scaling."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from arena_core import ConfigurationError, InvalidCommand, Robot
from arena_core.parameters import NonNegative, Positive
from arena_kernels.compiled import borrowing

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class ActionRange:
    """What the ends of [-1, 1] mean; null is the robot's own limit. Speeds in m/s, ``wz_max`` in rad/s,
    ``steering_max`` in rad.

    ``vx_min`` is the least forward speed; the others are symmetric.
    """

    vx_min: float | None
    vx_max: Positive | None
    vy_max: NonNegative | None
    wz_max: Positive | None
    steering_max: Positive | None


@dataclass(frozen=True, slots=True, eq=False)
class ActionScale:
    """Scales actions (N, A): (v, w), for omnidirectional robots (vx, vy, w), for cars (v, steering angle); ``names``
    says which.

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
        own, given = (
            robot.limits,
            robot.limits_with(vx_min=range_.vx_min, vx_max=range_.vx_max, vy_max=range_.vy_max, wz_max=range_.wz_max),
        )
        steering = robot.steering_max if range_.steering_max is None else range_.steering_max
        _check_within("vx_min", range_.vx_min, own.vx_min, own.vx_max)
        _check_within("vx_max", range_.vx_max, given.vx_min, own.vx_max)
        _check_within("vy_max", range_.vy_max, 0.0, own.vy_max)
        _check_within("wz_max", range_.wz_max, 0.0, own.wz_max)
        _check_within("steering_max", range_.steering_max, 0.0, robot.steering_max)
        along, across, turning = (
            (given.vx_min, given.vx_max),
            (-given.vy_max, given.vy_max),
            (-given.wz_max, given.wz_max),
        )
        ends = {
            "differential": {"vx": along, "wz": turning},
            "omnidirectional": {"vx": along, "vy": across, "wz": turning},
            "ackermann": {"vx": along, "steering": (-steering, steering)},
        }[robot.kinematics]
        low, high = np.array(list(ends.values())).T
        return ActionScale(tuple(ends), low, high, robot.wheelbase, given.wz_max)

    def commands(self, actions: NDArray[np.floating]) -> FloatArray:
        """Return velocities (N, 3) in ``base_link`` for actions (N, A), cut to [-1,
        1]; raise InvalidCommand for NaN.
        """
        commands = np.zeros((len(actions), 3))
        wheelbase = self.wheelbase if "steering" in self.names else 0.0
        if not _write_commands(
            np.ascontiguousarray(actions, np.float64), self.low, self.high, wheelbase, self.wz_max, commands
        ):
            raise InvalidCommand("an action is not finite; allowed: numbers in [-1, 1]")
        return commands

    def actions(self, commands: FloatArray) -> FloatArray:
        """Return the actions (N, A) in [-1, 1] that come nearest to velocities (N, 3) in ``base_link``."""
        wanted = np.ascontiguousarray(commands[:, [0, 2]] if len(self.names) == 2 else commands, np.float64)
        if "steering" in self.names:  # which says nothing of a turn at a stand
            speeds = np.where(np.abs(wanted[:, 0]) < 1e-6, np.inf, wanted[:, 0])
            wanted[:, 1] = np.arctan(wanted[:, 1] * self.wheelbase / speeds)
        widths = np.where(self.high > self.low, self.high - self.low, 1.0)  # 0 where a robot shall not drive sideways
        return np.clip(2.0 * (wanted - self.low) / widths - 1.0, -1.0, 1.0)


def _check_within(name: str, value: float | None, low: float, high: float) -> None:
    if value is not None and not (math.isfinite(value) and low <= value <= high):
        raise ConfigurationError(
            f"action.{name} is {value:g}; allowed: {low:g} .. {high:g}, the robot's limits, or null"
        )


@borrowing
def _write_commands(
    actions: FloatArray, low: FloatArray, high: FloatArray, wheelbase: float, wz_max: float, commands: FloatArray
) -> bool:
    """Write what actions (N, A) mean to ``commands`` (N, 3) and return True, or False where one is not a number.

    With a ``wheelbase``, m, the last one is a car's steering angle, else the turn rate.
    """
    last = actions.shape[1] - 1
    for k in range(len(actions)):
        value = 0.0
        for j in range(last + 1):
            if math.isnan(actions[k, j]):
                return False
            share = 0.5 * (min(max(actions[k, j], -1.0), 1.0) + 1.0)
            value = low[j] + share * (high[j] - low[j])
            commands[k, 2 if j == last else j] = value
        if wheelbase > 0.0:
            commands[k, 2] = min(max(commands[k, 0] * math.tan(value) / wheelbase, -wz_max), wz_max)
    return True
