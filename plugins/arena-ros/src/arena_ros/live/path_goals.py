"""Nav2's action FollowPath, served as controller_server does: one path at a time, the newest."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Collection
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from arena_core import Pose, Twist
from arena_core.commands import one_line, print_notice
from arena_core.hosting import Decision, Navigator
from arena_core.parameters import NonNegative, Positive
from arena_ros import conversions as to
from arena_ros.action_protocol import GoalStatus, ReceivedGoal
from arena_ros.codec import get_codec
from arena_ros.live.given_path import GivenPath, follow_given_paths, length_ahead, resample_path
from arena_ros.live.goals import GoalSource
from arena_ros.transport import Transport

FOLLOW_PATH = "nav2_msgs/action/FollowPath"
RESULT, FEEDBACK = f"{FOLLOW_PATH}_Result", f"{FOLLOW_PATH}_Feedback"
NO_COMMAND = "no_valid_command"
LOOK = 0.02  # s of wall time between two looks for a path
FrameLookup = Callable[[], tuple[str, Pose | None]]


@dataclass(frozen=True, slots=True)
class Checkers:
    """By which figures a path is given up: times in s, ``progress_radius`` in m."""

    failure_tolerance: NonNegative
    progress_radius: Positive
    progress_time: Positive
    sensor_timeout: Positive


@dataclass(frozen=True, slots=True)
class PluginNames:
    """The names that goals may ask for; an empty one in a goal is any."""

    controllers: Collection[str]
    goal_checkers: Collection[str]
    progress_checkers: Collection[str]


class PathFault(Exception):
    """A path cannot be followed: the name of Nav2's error code, and why."""

    def __init__(self, code: str, text: str) -> None:
        super().__init__(text)
        self.code, self.text = code, text


class PathGoals(GoalSource):
    """Serves FollowPath for a navigator; ``odom`` says where odometry's frame is in ``map``."""

    look = LOOK
    _anchor: Pose | None = None  # where the robot was when it last made progress
    _stalled: float | None = None  # s, since when it stands for a fault

    def __init__(
        self, transport: Transport, name: str, names: PluginNames, checkers: Checkers, navigator: Navigator
    ) -> None:
        self._codec, self._names, self._checkers, self._navigator = get_codec(2), names, checkers, navigator
        self.odom: FrameLookup = lambda: ("odom", None)
        self._codes = self._codec.constants(RESULT)
        self._given: GivenPath = follow_given_paths(navigator)
        self._heard: deque[ReceivedGoal] = deque()
        self._current: ReceivedGoal | None = None
        self._why, self._code = "", "UNKNOWN"
        self._begin_checks()
        transport.serve_action(name, FOLLOW_PATH, self._heard.append)

    def take(self) -> Pose | None:
        """Return where a new path ends; None where there is none, or it leads to the present goal on another way."""
        goals = [self._heard.popleft() for _ in range(len(self._heard))]
        for older in goals[:-1]:
            self._finish(older, GoalStatus.ABORTED, "NONE", "a newer path came")
        if not goals:
            return None
        if self._current is not None:
            self._finish(self._current, GoalStatus.ABORTED, "NONE", "a newer path came")
        before, self._current = self._current, goals[-1]
        try:
            goal = self._take_path(self._current.request)
        except PathFault as fault:
            print_notice(f"a path is not followed: {fault.text}")
            self._finish(self._current, GoalStatus.ABORTED, fault.code, fault.text)
            self._current, self._why = None, "" if before is None else "the path that came is not followed"
            return None
        mission = self._navigator.mission if before is not None else None
        if mission is not None and mission.goal.distance(goal) <= mission.goal_radius and self._given.path is not None:
            self._navigator.mission = replace(mission, goal=goal)
            self._navigator.follow(self._given.path)
            return None
        self._begin_checks()
        return goal

    def over(self) -> str:
        """Return that the path is cancelled, or that a newer one is of no use."""
        if self._current is not None and self._current.is_cancelled:
            return "the goal was cancelled"
        return self._why

    def publish_progress(self, pose: Pose, twist: Twist) -> None:
        """Say how far it is along the path, and how fast the robot is."""
        if self._current is not None and self._given.path is not None:
            distance, speed = length_ahead(self._given.path, pose), float(np.hypot(twist.vx, twist.vy))
            self._current.publish_feedback(self._codec.make(FEEDBACK, distance_to_goal=distance, speed=speed))

    def judge(self, decision: Decision, stamp: float) -> str:
        """Give up where the planner has had no command, or the robot made no progress, for too long."""
        figures = self._checkers
        self._stalled = None
        if all(event.kind != NO_COMMAND for event in decision.events):
            self._commanded = stamp
        elif stamp - self._commanded >= figures.failure_tolerance:
            code = "PATIENCE_EXCEEDED" if figures.failure_tolerance > 0.0 else "NO_VALID_CONTROL"
            return self._give_up(code, f"no valid command for {stamp - self._commanded:.1f} s")
        pose = decision.estimate.pose
        if decision.compiled:  # what a compiler takes is no lack of progress
            self._anchor = None
        elif self._anchor is None or self._anchor.distance(pose) > figures.progress_radius:
            self._anchor, self._moved = pose, stamp
        elif stamp - self._moved > figures.progress_time:
            return self._give_up(
                "FAILED_TO_MAKE_PROGRESS", f"within {figures.progress_radius:g} m for {figures.progress_time:g} s"
            )
        return ""

    def stall(self, fault: str, stamp: float) -> str:
        """Give up where the robot has had to stand for a sensor or a pose for too long."""
        self._stalled = stamp if self._stalled is None else self._stalled
        if stamp - self._stalled < self._checkers.sensor_timeout:
            return ""
        return self._give_up("TF_ERROR" if fault.startswith("no pose") else "CONTROLLER_TIMED_OUT", fault)

    def end(self, text: str, *, reached: bool) -> None:
        """Answer the goal that was driven to, if there is one."""
        goal, self._current, self._why = self._current, None, ""
        if goal is None:
            return
        if reached:
            self._finish(goal, GoalStatus.SUCCEEDED, "NONE", "")
        elif goal.is_cancelled:
            self._finish(goal, GoalStatus.CANCELED, "NONE", text)
        else:
            self._finish(goal, GoalStatus.ABORTED, self._code, text)

    def _begin_checks(self) -> None:
        self._code, self._anchor, self._moved, self._commanded = "UNKNOWN", None, 0.0, 0.0
        self._stalled = None

    def _give_up(self, code: str, text: str) -> str:
        self._code = code
        return text

    def _finish(self, goal: ReceivedGoal, status: GoalStatus, code: str, text: str) -> None:
        none = self._codec.make("std_msgs/msg/Empty")
        goal.end(
            status, self._codec.make(RESULT, result=none, error_code=self._codes[code], error_msg=one_line(text, 200))
        )

    def _take_path(self, request: Any) -> Pose:
        """Have the path of a goal followed from now on, and return its end; raise PathFault."""
        self._check_names(request)
        poses = to.path_from_msg(request.path)
        if not len(poses):
            raise PathFault("INVALID_PATH", "the path is empty")
        if not np.isfinite(poses).all():
            raise PathFault("INVALID_PATH", "the path has a pose that is no number")
        place = self._frame_pose(request.path.header.frame_id.lstrip("/"))
        poses = np.array([place.compose(Pose.of(row)).array() for row in poses])
        goal = Pose.of(poses[-1])
        self._given.path = resample_path(poses[:, :2])
        if self._given.path is None:  # one place: from where the robot is it is straight on
            raise PathFault("INVALID_PATH", "the path has one pose; allowed: two or more that differ")
        return goal

    def _frame_pose(self, frame: str) -> Pose:
        """Return where the frame of a path is in ``map``."""
        odom, place = self.odom()
        if frame in ("map", ""):
            return Pose(0.0, 0.0)
        if frame == odom and place is not None:
            return place
        allowed = "map" if place is None else f"map, {odom}"
        raise PathFault("TF_ERROR", f"no transform leads from {one_line(frame, 40)} to map; allowed: {allowed}")

    def _check_names(self, request: Any) -> None:
        kinds = {
            "controller_id": (self._names.controllers, "INVALID_CONTROLLER"),
            "goal_checker_id": (self._names.goal_checkers, "UNKNOWN"),
            "progress_checker_id": (self._names.progress_checkers, "UNKNOWN"),
        }
        for field, (allowed, code) in kinds.items():
            name = getattr(request, field, "")
            if name and name not in allowed:
                raise PathFault(code, f"{field} is {one_line(name, 40)}; allowed: {', '.join(allowed)}")
