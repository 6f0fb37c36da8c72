"""What of a command a robot is sent: never more than its limits, and nothing where something is wrong."""

from __future__ import annotations

from arena_core import Robot, Twist

STAND = Twist(0.0, 0.0, 0.0)


class SpeedLimiter:
    """Holds commands to the speeds and accelerations of a robot; ``speed`` is the
    share of its speeds that is driven.
    """

    def __init__(self, robot: Robot, speed: float, period: float) -> None:
        self._limits, self._speed, self._period = robot.limits, speed, period
        self._last = STAND

    def limit_command(self, wanted: Twist) -> Twist:
        """Return the nearest command that the robot may drive after the last one, one period ago."""
        limits, share = self._limits, self._speed
        vx = min(max(wanted.vx, share * limits.vx_min), share * limits.vx_max)
        vy = _clamp_value(wanted.vy, share * limits.vy_max)
        wz = _clamp_value(wanted.wz, share * limits.wz_max)
        self._last = Twist(
            self._last.vx + _clamp_value(vx - self._last.vx, limits.ax_max * self._period),
            self._last.vy + _clamp_value(vy - self._last.vy, limits.ay_max * self._period),
            self._last.wz + _clamp_value(wz - self._last.wz, limits.alpha_max * self._period),
        )
        return self._last

    def stop(self) -> Twist:
        """Return the command to stand at once: brakes are the robot's own."""
        self._last = STAND
        return STAND


def _clamp_value(value: float, bound: float) -> float:
    return min(max(value, -bound), bound)
