"""The way out of where a robot got stuck: a linear programme sees neither its corners nor two moves ahead."""

from __future__ import annotations

import math

from arena_core import Pose
from arena_kernels.compiled import borrowing, compiled
from arena_kernels.costmap_window import CostmapWindow, Outline, outline_clearance
from arena_kernels.half_planes import FloatArray
from arena_orca.braking import can_stop, pose_after
from arena_orca.parameters import ACKERMANN, OMNIDIRECTIONAL, Settings

SPEED, TURN = 0.3, 1.0  # m/s and rad/s of an escape, or the robot's own limits
DIRECTIONS = 8  # of straight escapes, omnidirectional robots only
BENDS = (-1.0, -0.5, 0.0, 0.5, 1.0)  # shares of TURN
ENOUGH = 1.0  # m of clearance, beyond which more is no better
NEAR, TURNED = 0.1, 0.6  # m and rad that a robot moves if it gets anywhere


@compiled
def escape_command(
    window: CostmapWindow, outline: Outline, state: FloatArray, settings: Settings, time: float
) -> tuple[bool, float, float, float]:
    """Return whether there is a way out, and the (vx, vy, wz) that after ``time`` s leaves the
    footprint the greatest clearance.
    """
    limits, body = settings.limits, settings.body
    stand = (state[0], state[1], math.cos(state[2]), math.sin(state[2]))
    twist = (state[3], state[4], state[5])
    gap = settings.statics.padding
    found, best, best_x, best_y, best_turn = False, -math.inf, 0.0, 0.0, 0.0
    count = DIRECTIONS if body.kinematics == OMNIDIRECTIONAL else 2 * len(BENDS) + 2
    for choice in range(count):
        vx, vy, wz = escape_choice(choice, settings)
        if not can_stop(window, outline, limits, stand, twist, (vx, vy, wz), time, gap):
            continue
        x, y, cosine, sine = pose_after(limits, stand, twist, (vx, vy, wz), time)
        room = min(ENOUGH, outline_clearance(window, outline, (x, y, cosine, sine), ENOUGH))
        if room > best + 1e-6:
            found, best, best_x, best_y, best_turn = True, room, vx, vy, wz
    return found, best_x, best_y, best_turn


@borrowing
def escape_choice(choice: int, settings: Settings) -> tuple[float, float, float]:
    """Return the twist of one escape: straight in some direction, a bend forwards or
    backwards, or a turn on the spot.
    """
    limits, body = settings.limits, settings.body
    speed, turn = min(SPEED, limits.vx_max), min(TURN, limits.wz_max)
    if body.kinematics == OMNIDIRECTIONAL:
        angle = 2.0 * math.pi * choice / DIRECTIONS
        return speed * math.cos(angle), speed * math.sin(angle), 0.0
    bends = len(BENDS)
    if choice >= 2 * bends:
        return 0.0, 0.0, (turn if choice == 2 * bends else -turn) if body.kinematics != ACKERMANN else 0.0
    vx = max(-speed, limits.vx_min) if choice < bends else speed
    if body.kinematics == ACKERMANN:
        turn = min(turn, abs(vx) / limits.turn_radius)
    return vx, 0.0, BENDS[choice % bends] * turn


class StuckDetector:
    """Notices when a robot that wants to go somewhere has hardly moved for ``patience`` s, and
    lets it escape for ``time`` s.
    """

    def __init__(self, patience: float | None, time: float) -> None:
        self._patience = patience
        self._time = time
        self.clear()

    def clear(self) -> None:
        """Begin with all patience."""
        self._since: tuple[float, Pose] | None = None
        self._until = -math.inf

    def is_stuck(self, stamp: float, pose: Pose) -> bool:
        """Return whether the robot, now at ``pose``, is to escape."""
        if self._patience is None:
            return False
        if stamp < self._until:
            return True
        if (
            self._since is None
            or self._since[1].distance(pose) > NEAR
            or abs(self._since[1].relative(pose).theta) > TURNED
        ):
            self._since = (stamp, pose)
        if stamp - self._since[0] < self._patience:
            return False
        self._since, self._until = None, stamp + self._time
        return True
