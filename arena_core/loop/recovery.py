"""What the robot tries when it makes no progress: the recovery behaviours of move_base and
Nav2, in the navigator's hands.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from arena_core.loop.commanded_motion import CommandedMotion, creeps, has_moved
from arena_core.loop.ways_out import MOVING, Behaviour, WaysOut
from arena_core.values.episode import Event
from arena_core.values.geometry import FloatArray, Footprint, Pose, Twist, wrap_angle
from arena_core.values.parameters import NonNegative, Positive
from arena_core.values.robot import Robot
from arena_core.values.world import LETHAL, Costmap

AT_ONCE = ("clear", "clear_far", "detour")  # those that take no time
STAND = Twist(0.0, 0.0, 0.0)
_OUTLINE = 24  # points of a circle's outline
_RINGS = (1.0, 0.8, 0.6, 0.4, 0.2)  # sizes of the outline at which a body is tried: a cell apart on the robots at hand
_LOOK_AHEAD = 0.3  # s of motion that must be free before a step of it is driven
_LOOK_AHEAD_FREEING = 0.1  # s, off what holds the robot
_LEANING = 0.1  # m, within which a robot stays that leans on something
_LEANS, _HELD = "leans on something", "its commands move nothing"
_FACING = 0.4  # rad, up to which drive_on turns while it drives


# a behaviour, whether it is to free the robot from what it does not see, and why it begins
Leaving = tuple[Behaviour, bool, str]


@dataclass(frozen=True, slots=True)
class RecoveryRules:
    """Which behaviours are tried in turn (none: no recoveries), when, and how far each goes.

    The first is due when the robot has stayed within ``progress_radius`` m for ``progress_time`` s, the next ones
    ``retry_time`` s after the one before. ``clear_beyond`` m is what ``clear_far`` keeps; ``wait_time`` s;
    ``turn_angle`` rad at ``turn_speed`` rad/s; ``back_up_distance`` m at ``back_up_speed`` m/s. ``detour`` plans for
    ``detour_time`` s as if a disc of ``detour_radius`` m stood on the path, ``detour_ahead`` m ahead. ``drive_on``
    turns to the waypoint and drives ``drive_on_distance`` m at ``back_up_speed``. A robot that has leaned on something,
    or whose commands have moved nothing, for ``lean_time`` s (None: ever) is to move at once, by the next behaviour
    where one moves nothing. One that has stayed within ``circle_radius`` m for ``circle_time`` s (None: ever) drives in
    circles: the behaviours are tried in turn, ``progress_time`` s apart.
    """

    behaviours: list[Behaviour]
    progress_radius: Positive
    progress_time: Positive
    retry_time: NonNegative
    clear_beyond: NonNegative
    wait_time: Positive
    turn_angle: Positive
    turn_speed: Positive
    back_up_distance: Positive
    back_up_speed: Positive
    detour_ahead: Positive
    detour_radius: Positive
    detour_time: Positive
    drive_on_distance: Positive
    circle_radius: Positive
    circle_time: Positive | None
    lean_time: Positive | None


@dataclass(frozen=True, slots=True)
class Begun:
    """A behaviour that begins now: ``clear_beyond`` m is from where on the local map forgets its marks, None if it
    keeps them.

    ``closes``: the place ahead on the path is to be kept off for a while.
    """

    behaviour: Behaviour
    clear_beyond: float | None
    event: Event
    closes: bool = False


class Recoveries:
    """Watches one robot's progress, and drives what is tried when there is none."""

    def __init__(self, rules: RecoveryRules, robot: Robot) -> None:
        self._rules = rules
        self._robot = robot
        self._body, self._rim = footprint_points(robot.footprint), _outline_points(robot.footprint)
        self._possible = [b for b in rules.behaviours if b != "turn" or robot.kinematics != "ackermann"]
        self.reset()

    def reset(self) -> None:
        """Begin an episode."""
        self._anchor: Pose | None = None  # where the robot was when it last made progress
        self._since = 0.0
        self._due_at = math.inf
        self._tried = 0
        self._active: Behaviour | None = None
        self._centre: Pose | None = None  # of the circle that the robot has not left since ``_circling_since``
        self._circling_since = 0.0
        self._circled = 0
        self._rest: Pose | None = None  # about where the robot has been since ``_rest_since``
        self._rest_since = self._rest_told = 0.0  # s; m that it had been told to drive until then
        self._ways = WaysOut(self._possible)
        self._motion = CommandedMotion()
        self._leaves = False  # the behaviour under way, what the robot leans on
        self._frees = False  # the behaviour under way, from what held the robot
        self._drives = False  # the behaviour under way, so far

    def begin(self, pose: Pose, stamp: float, touches: Callable[[], bool] = lambda: False) -> Begun | None:
        """Take in where the robot is, and return the behaviour that begins now, if one does.

        ``touches`` is asked whether its body touches something where it has not moved for ``lean_time``.
        """
        self._motion.advance(pose, stamp)
        leaving = self._behaviour_when_held(stamp) or self._behaviour_when_leaning(pose, stamp, touches)
        if self._anchor is None or pose.distance(self._anchor) >= self._rules.progress_radius:
            self._anchor, self._since, self._tried = pose, stamp, 0
            self._due_at = stamp + self._rules.progress_time
        if leaving is not None:
            self._due_at = max(self._due_at, stamp + self._rules.retry_time)
            behaviour, frees, why = leaving
            begun = self._start_behaviour(behaviour, pose, stamp, f"{behaviour}: {why}")
            self._leaves, self._frees = True, frees
            return begun
        if self._drives_in_circles(pose, stamp):
            behaviour, self._circled = self._next_listed(self._circled, touches)
            return self._start_behaviour(
                behaviour, pose, stamp, f"{behaviour}: drives in circles", closes=behaviour == "detour"
            )
        if self._active is not None or not self._possible or stamp < self._due_at - 1e-9:
            return None
        behaviour, self._tried = self._next_listed(self._tried, touches)
        self._due_at = stamp + self._rules.retry_time
        all_failed = self._tried > len(self._possible) and self._tried % len(self._possible) == 1
        closes = "detour" in self._possible and (behaviour == "detour" or all_failed)
        return self._start_behaviour(
            behaviour, pose, stamp, f"{behaviour}: no progress for {stamp - self._since:.1f} s", closes=closes
        )

    def _start_behaviour(
        self, behaviour: Behaviour, pose: Pose, stamp: float, detail: str, *, closes: bool = False
    ) -> Begun:
        if behaviour not in AT_ONCE:
            self._leaves = self._frees = self._drives = False
            self._active, self._from, self._until = behaviour, pose, stamp + self._time_limit(behaviour)
            self._turned, self._side = 0.0, 0.0
        clear_beyond = {"clear": 0.0, "clear_far": self._rules.clear_beyond}.get(behaviour)
        return Begun(behaviour, clear_beyond, Event(stamp, "recovery", detail), closes)

    def _drives_in_circles(self, pose: Pose, stamp: float) -> bool:
        """Return whether the robot has driven about in one place for too long since the last
        behaviour that was begun for that.
        """
        rules = self._rules
        if self._centre is None or pose.distance(self._centre) >= rules.circle_radius:
            self._centre, self._circling_since, self._circled = pose, stamp, 0
        if rules.circle_time is None or self._active is not None or not self._possible:
            return False
        due = stamp - self._circling_since >= rules.circle_time + self._circled * rules.progress_time - 1e-9
        return due and stamp < self._due_at - 1e-9

    def _next_listed(self, tried: int, touches: Callable[[], bool]) -> tuple[Behaviour, int]:
        """Return the behaviour that is due after so many, and how many that makes; no one waits who leans."""
        behaviour = self._possible[tried % len(self._possible)]
        if behaviour == "wait" and self._rules.lean_time is not None and self._ways.listed:
            tried += self._motion.is_held() or touches()
        return self._possible[tried % len(self._possible)], tried + 1

    def _behaviour_when_held(self, stamp: float) -> Leaving | None:
        """Return what is tried at once where the behaviour under way has moved nothing: first the way opposite. Where
        nothing is left to try, end it.
        """
        if self._rules.lean_time is None or self._active not in MOVING or not self._motion.is_held():
            return None
        why = f"{self._active} moved nothing"
        self._ways.fail(self._active, frees=self._frees)
        way = self._ways.choose(self._opposite_behaviour())
        if way is None:
            self._active = None
            self._pause_leaving(self._rules.lean_time, stamp)
            return None
        return *way, why

    def _behaviour_when_leaning(self, pose: Pose, stamp: float, touches: Callable[[], bool]) -> Leaving | None:
        """Return the behaviour that brings the robot off what it has leaned on for too long, at once where the one
        before has moved nothing; None if it does not lean, or creeps along as it is told.
        """
        rests = self._rest is not None and pose.distance(self._rest) <= _LEANING
        if not rests:
            self._ways.restart()
        if self._rest is None or not rests or self._active is not None:
            self._rest, self._rest_since, self._rest_told = pose, stamp, self._motion.told_way
        lean_time, failed = self._rules.lean_time, self._ways.last
        if lean_time is None or not self._ways.listed or self._active is not None:
            return None
        if failed is None and stamp - self._rest_since < lean_time - 1e-9:
            return None
        held, told = self._motion.is_held(), self._motion.told_way - self._rest_told
        if failed is None and not held and (not touches() or creeps(told, pose.distance(self._rest))):
            return None
        self._rest_since = stamp
        if self._motion.held_way() < 0.0:
            self._ways.fail("back_up", frees=False)
        way = self._ways.choose(self._opposite_behaviour() if held else None)
        if way is None:
            self._pause_leaving(lean_time, stamp)
            return None
        return *way, _LEANS if failed is None and not held else _HELD if failed is None else f"{failed} moved nothing"

    def _pause_leaving(self, lean_time: float, stamp: float) -> None:
        """Leave the robot alone for a while, as nothing has moved it."""
        self._rest_since = stamp - lean_time + min(lean_time, self._ways.begin_again())

    def _opposite_behaviour(self) -> Behaviour:
        """Return what leads off what holds the robot: forwards, listed or not, unless it was told to drive forwards."""
        return "back_up" if self._motion.held_way() > 0.0 and "back_up" in self._possible else "drive_on"

    def command(self, pose: Pose, stamp: float, local_map: Callable[[], Costmap], waypoint: Pose) -> Twist | None:
        """Return what the behaviour under way sends now; None when none is, or when it has just ended."""
        if self._active is None:
            return None
        command = self._next_command(pose, stamp, local_map, waypoint)
        if self._drives != (command is not None):  # what it is told from now on counts, not what it was told before
            self._motion.restart(pose, stamp)
        self._drives = command is not None
        if command is None:
            self._note_end(self._active, pose)
            self._active, self._due_at = None, stamp + self._rules.retry_time
        return command

    def _note_end(self, ended: Behaviour, pose: Pose) -> None:
        """Note whether a behaviour that was to bring the robot off what it leans on has moved it."""
        if has_moved(self._from, pose):
            self._ways.restart()
        elif self._leaves:
            self._ways.fail(ended, frees=self._frees)

    def tell(self, command: Twist) -> None:
        """Take in what the robot is told from now on, by a behaviour or by the planner."""
        self._motion.tell(command)

    def _next_command(self, pose: Pose, stamp: float, local_map: Callable[[], Costmap], waypoint: Pose) -> Twist | None:
        if stamp >= self._until - 1e-9:
            return None
        if self._active == "wait":
            return STAND
        moves = {"back_up": self._back_up, "drive_on": self._drive_on, "turn": self._turn_in_place}
        command = moves[str(self._active)](pose, waypoint)
        return command if command is not None and self._is_free(local_map(), pose, command) else None

    def _back_up(self, pose: Pose, _: Pose) -> Twist | None:
        speed = min(self._rules.back_up_speed, -self._robot.limits.vx_min)
        far = pose.distance(self._from) >= self._rules.back_up_distance
        return None if far or speed <= 0.0 else Twist(-speed)

    def _drive_on(self, pose: Pose, waypoint: Pose) -> Twist | None:
        """Turn to the waypoint, then drive there slowly; off what holds the robot straight on first."""
        driven = pose.distance(self._from)
        if driven >= self._rules.drive_on_distance:
            return None
        if self._frees and driven < _LEANING:
            return Twist(min(self._rules.back_up_speed, self._robot.limits.vx_max))
        bearing = float(wrap_angle(math.atan2(waypoint.y - pose.y, waypoint.x - pose.x) - pose.theta))
        turn = min(self._rules.turn_speed, self._robot.limits.wz_max)
        speed = min(self._rules.back_up_speed, self._robot.limits.vx_max)
        if self._robot.kinematics == "ackermann":
            turn = min(turn, speed / self._robot.turn_radius)
        elif abs(bearing) > _FACING:
            speed = 0.0
        return Twist(speed, 0.0, min(max(2.0 * bearing, -turn), turn))

    def _turn_in_place(self, pose: Pose, waypoint: Pose) -> Twist | None:
        """Turn on to the side on which the waypoint was when the turn began."""
        turned = float(wrap_angle(pose.theta - self._from.theta))
        self._turned += float(wrap_angle(turned - self._turned))
        if abs(self._turned) >= self._rules.turn_angle:
            return None
        if self._side == 0.0:
            bearing = math.atan2(waypoint.y - pose.y, waypoint.x - pose.x)
            self._side = math.copysign(1.0, float(wrap_angle(bearing - pose.theta)))
        return Twist(0.0, 0.0, self._side * min(self._rules.turn_speed, self._robot.limits.wz_max))

    def touches(self, costmap: Costmap, pose: Pose) -> bool:
        """Return whether the robot's outline lies in an occupied cell or half a cell beside one, where a
        scan marks what it touches.
        """
        return (
            count_touched(costmap, self._rim * (1.0 + 0.5 * costmap.resolution / self._robot.footprint.radius), pose)
            > 0
        )

    def _is_free(self, costmap: Costmap, pose: Pose, command: Twist) -> bool:
        """Return whether the body, a little further on this motion, touches nothing that it does not touch already.

        What frees the robot from what it touches may do so by half a cell: so far the marks of a scan may be off.
        """
        time = _LOOK_AHEAD_FREEING if self._frees else _LOOK_AHEAD
        off = 0.5 * costmap.resolution / self._robot.footprint.radius if self._frees else 0.0
        body, ahead = self._body * (1.0 - off), Pose(command.vx * time, 0.0, command.wz * time)
        return count_touched(costmap, body, pose.compose(ahead)) <= count_touched(costmap, body, pose)

    def _time_limit(self, behaviour: Behaviour) -> float:
        """Return for how long a behaviour goes on at most, s: twice what it would
        take, where the robot moves as told.
        """
        rules = self._rules
        on = 2.0 * (rules.drive_on_distance / rules.back_up_speed + math.pi / rules.turn_speed)
        back = 2.0 * rules.back_up_distance / rules.back_up_speed
        times = {"turn": 2.0 * rules.turn_angle / rules.turn_speed, "back_up": back, "drive_on": on}
        return times.get(behaviour, rules.wait_time)


def footprint_points(footprint: Footprint) -> FloatArray:
    """Return points all over a footprint, (K, 2), m, in ``base_link``: its outline, and that drawn in
    towards the origin in rings.
    """
    return np.concatenate([share * _outline_points(footprint) for share in _RINGS])


def _outline_points(footprint: Footprint) -> FloatArray:
    if footprint.is_circle:
        angles = 2.0 * math.pi * np.arange(_OUTLINE) / _OUTLINE
        return footprint.radius * np.stack((np.cos(angles), np.sin(angles)), axis=1)
    shares = np.linspace(0.0, 1.0, 8, endpoint=False)[:, None, None]
    ends = np.roll(footprint.vertices_xy, -1, axis=0)
    return np.asarray((footprint.vertices_xy + shares * (ends - footprint.vertices_xy)).reshape(-1, 2))


def count_touched(costmap: Costmap, body_xy: FloatArray, pose: Pose) -> int:
    """Count the points of a body at ``pose`` that lie in lethal cells of the window."""
    c, s = math.cos(pose.theta), math.sin(pose.theta)
    placed = body_xy @ np.array(((c, s), (-s, c))) + (pose.x, pose.y)
    cells = np.floor((placed - costmap.origin_xy) / costmap.resolution).astype(np.int64)
    inside = (cells >= 0).all(axis=1) & (cells < costmap.costs.shape[::-1]).all(axis=1)
    return int(np.count_nonzero(costmap.costs[cells[inside, 1], cells[inside, 0]] == LETHAL))
