"""The way out of a local minimum: turn on the spot, then drive straight to where the way to the local goal is shorter.

An arc of one velocity cannot first turn away from the path and then pass a door post; two motions can.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arena_core import Pose, wrap_angle
from arena_dwa.columns import HIGH, LOW, X, Y
from arena_dwa.map_grid import bordered_index, clamped_index
from arena_dwa.settings import Body, BodyOnWindow, FloatArray, Limits
from arena_dwa.trajectory import PlanarPose, compose_poses, planar_pose
from arena_kernels.compiled import compiled
from arena_kernels.costmap_window import CostmapWindow, allowed_gap, outline_clearance

DIRECTIONS = 32
SPACING = 0.025  # m between two places of a line that are looked at: half a usual cell
TURN_SPACING = 0.1  # rad between two headings of a turn that are looked at
WORTH = 0.1  # m, the least gain: two cells
TURNING_COSTS = 0.03  # m a radian, so that of two equal ways the nearer one is taken
BACKWARDS_COSTS = 0.1  # m, for the scanner may see nothing behind
FACING = 0.15  # rad; who faces the line so well drives
ENOUGH = 0.05  # m, a line's end counts as reached
TIME_LIMIT = 6.0  # s for turn and line: half a turn at the slowest robot's speed, and half a metre


class LineRules(NamedTuple):
    """How long a line may be, m, and whether the robot may drive it sideways, or backwards."""

    reach: float
    sideways: bool
    backwards: bool


@compiled
def best_line(
    ground: BodyOnWindow, goal: NDArray[np.int32], start: PlanarPose, rules: LineRules
) -> tuple[float, float, float]:
    """Return (direction, heading, length) of the straight line that shortens the way to the local goal most; length 0:
    none.

    ``goal`` holds the steps from the local goal, of the flat grid with its border. Direction and heading (rad) are
    relative to the present heading; a robot that goes sideways need not turn. Lines are no longer than allowed
    and free of contact all along, and the turn before as well.
    """
    gap = outline_clearance(ground.window, ground.body.outline, start, ground.body.padding)
    allowed = allowed_gap(gap, ground.body.padding, 0.0)
    here = goal[clamped_index(ground.window, start[X], start[Y])]
    best, direction, heading, length = WORTH, 0.0, 0.0, 0.0
    for k in range(DIRECTIONS):
        way = 2.0 * math.pi * k / DIRECTIONS
        for backward in range(2 if rules.backwards and not rules.sideways else 1):
            turn = 0.0 if rules.sideways else (way + math.pi * backward + math.pi) % (2.0 * math.pi) - math.pi
            steps, far = evaluate_line(
                ground,
                goal,
                compose_poses(start, (0.0, 0.0, math.cos(turn), math.sin(turn))),
                way - turn,
                rules.reach,
                allowed,
            )
            gain = (here - steps) * ground.window.resolution - TURNING_COSTS * abs(turn) - BACKWARDS_COSTS * backward
            if gain > best and is_turn_free(ground.window, ground.body, start, turn, allowed):
                best, direction, heading, length = gain, way, turn, far
    return direction, heading, length


@compiled
def evaluate_line(
    ground: BodyOnWindow, goal: NDArray[np.int32], stand: PlanarPose, way: float, reach: float, allowed: float
) -> tuple[float, float]:
    """Return the fewest steps from the local goal on a line that leads ``way`` (rad) off the heading, and
    how far along they are, m.
    """
    step = SPACING * math.cos(way), SPACING * math.sin(way), 1.0, 0.0
    fewest, far = math.inf, 0.0
    for k in range(1, int(reach / SPACING) + 1):
        stand = compose_poses(stand, step)
        cell = bordered_index(ground.window, stand[X], stand[Y])
        if cell < 0 or outline_clearance(ground.window, ground.body.outline, stand, allowed) < allowed:
            break
        if goal[cell] < fewest:
            fewest, far = float(goal[cell]), k * SPACING
    return fewest, far


@compiled
def is_turn_free(window: CostmapWindow, body: Body, start: PlanarPose, turn: float, allowed: float) -> bool:
    """Return whether the robot may turn on the spot by ``turn`` (rad)."""
    parts = math.ceil(abs(turn) / TURN_SPACING)
    for k in range(1, parts + 1):
        angle = turn * k / parts
        if (
            outline_clearance(
                window, body.outline, compose_poses(start, (0.0, 0.0, math.cos(angle), math.sin(angle))), allowed
            )
            < allowed
        ):
            return False
    return True


class EscapeInputs(NamedTuple):
    """What a way out is looked for on: the window, the robot's body, its path (M, 3) and the
    steps from the local goal.
    """

    window: CostmapWindow
    body: Body
    path: FloatArray
    goal: NDArray[np.int32]


class Line(NamedTuple):
    """A line that is being driven: since when (s) and from where, the heading and the direction (rad,
    ``map``), and how far (m).
    """

    stamp: float
    start: Pose
    heading: float
    direction: float
    length: float


class WayOut:
    """Keeps to one line until it is driven, or takes too long."""

    def __init__(self, reach: float, limits: Limits, *, sideways: bool) -> None:
        self._reach = reach
        self._limits = limits
        self._sideways = sideways
        self.clear()

    def clear(self) -> None:
        """Drive no line."""
        self._line: Line | None = None

    @property
    def is_active(self) -> bool:
        """Whether a line is being driven."""
        return self._line is not None

    def warm_up(self, pose: Pose, ground: EscapeInputs) -> None:
        """Look for a line of no length, so that the search is compiled before a control step needs it."""
        start = planar_pose(pose.x, pose.y, pose.theta)
        best_line(BodyOnWindow(ground.window, ground.body), ground.goal, start, LineRules(0.0, self._sideways, False))

    def begin(self, stamp: float, pose: Pose, ground: EscapeInputs) -> None:
        """Look for a line from ``pose`` (``map``)."""
        start, backwards = planar_pose(pose.x, pose.y, pose.theta), self._limits.vx_min < 0.0
        direction, turn, length = best_line(
            BodyOnWindow(ground.window, ground.body),
            ground.goal,
            start,
            LineRules(self._reach, self._sideways, backwards),
        )
        self._line = Line(stamp, pose, pose.theta + turn, pose.theta + direction, length) if length > 0.0 else None

    def target_velocity(self, stamp: float, pose: Pose, velocities: FloatArray, time: float) -> FloatArray | None:
        """Return the velocity (3,) within the window ``velocities`` (3, 2) that turns to the line or drives it; None
        when it is done.

        It is slow enough that what is left of the line lasts for ``time`` (s).
        """
        if self._line is None:
            return None
        left = self._line.length - pose.distance(self._line.start)
        if left < ENOUGH or stamp - self._line.stamp > TIME_LIMIT:
            self._line = None
            return None
        off = float(wrap_angle(self._line.heading - pose.theta))
        wanted = self._turn_velocity(off) if abs(off) > FACING else self._line_velocity(pose.theta, off, left / time)
        return np.clip(wanted, velocities[:, LOW], velocities[:, HIGH])

    def _turn_velocity(self, off: float) -> FloatArray:
        # half of what braking allows
        return np.array((0.0, 0.0, math.copysign(math.sqrt(self._limits.alpha_max * abs(off)), off)))

    def _line_velocity(self, theta: float, off: float, speed: float) -> FloatArray:
        assert self._line is not None
        towards = self._line.direction - theta
        forwards, aside = math.cos(towards), math.sin(towards) if self._sideways else 0.0
        return np.array((speed * forwards, speed * aside, off))
