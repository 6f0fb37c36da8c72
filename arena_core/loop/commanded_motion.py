"""Commands that move nothing: who is told to drive or turn and stays is held by something, seen or not."""

from __future__ import annotations

import math

from arena_core.values.geometry import Pose, Twist, wrap_angle

_TIME = 1.0  # s of commands, at least, until a robot counts as held: it needs time to speed up
_WAY, _MOVED = 0.15, 0.05  # m that it was told to drive, and that it drove less than
_TURN, _TURNED = 0.75, 0.2  # rad, likewise
_CREPT, _OBEYED = 0.02, 0.5  # m that a robot that creeps was told to drive, and the share of it that it got on


class CommandedMotion:
    """Adds up what a robot was told to drive since it last moved, and to turn since it last turned."""

    def __init__(self) -> None:
        self._command = Twist(0.0)
        self._told = 0.0
        self.restart(Pose(0.0, 0.0), 0.0)

    def restart(self, pose: Pose, stamp: float) -> None:
        """Count from this pose on."""
        self._begin, self._pose, self._stamp = pose, pose, stamp
        self._time = self._ahead = self._left = self._turn = self._turned = 0.0

    def tell(self, command: Twist) -> None:
        """Take in what the robot is told from now on."""
        self._command = command

    def advance(self, pose: Pose, stamp: float) -> None:
        """Add up what the robot was told since the last time, and how it turned."""
        elapsed, command = stamp - self._stamp, self._command
        heading = pose.theta - self._begin.theta
        c, s = math.cos(heading), math.sin(heading)
        self._time += elapsed if command != Twist(0.0) else 0.0
        self._ahead += elapsed * (c * command.vx - s * command.vy)
        self._left += elapsed * (s * command.vx + c * command.vy)
        self._turn += elapsed * command.wz
        self._told += elapsed * math.hypot(command.vx, command.vy)
        self._turned += float(wrap_angle(pose.theta - self._pose.theta))
        self._pose, self._stamp = pose, stamp
        if pose.distance(self._begin) >= _MOVED:
            self.restart(pose, stamp)
        if abs(self._turned) >= _TURNED:
            self._turn = self._turned = 0.0

    @property
    def told_way(self) -> float:
        """Return the length of all that the robot was ever told to drive, m."""
        return self._told

    def held_way(self) -> float:
        """Return how far a held robot was told to drive, m, below zero if backwards; zero if it is not held."""
        way = math.hypot(self._ahead, self._left)
        held = self._time >= _TIME - 1e-9 and way >= _WAY - 1e-9
        return math.copysign(way, self._ahead) if held else 0.0

    def is_held(self) -> bool:
        """Return whether the robot was told to drive, and stood, or to turn, and did not."""
        turns = self._time >= _TIME - 1e-9 and abs(self._turn) >= _TURN
        return turns or self.held_way() != 0.0


def creeps(told: float, moved: float) -> bool:
    """Return whether a robot that was told to drive ``told`` m in all, and got ``moved`` m on, does as told."""
    return told >= _CREPT and moved >= _OBEYED * told


def has_moved(begin: Pose, pose: Pose) -> bool:
    """Return whether a robot has driven or turned as far as counts, since it stood at ``begin``."""
    turned = abs(float(wrap_angle(pose.theta - begin.theta)))
    return pose.distance(begin) >= _MOVED or turned >= _TURNED
