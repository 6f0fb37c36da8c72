"""Where a robot is to drive: goals of a topic and, in ROS 1, of move_base's action."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import Any

import numpy as np

from arena_core import ConfigurationError, Pose, Twist
from arena_core.commands import print_notice
from arena_core.hosting import Decision
from arena_ros import conversions as to
from arena_ros.codec import get_codec
from arena_ros.live.actions import ActionClient, ActionServer, GoalState
from arena_ros.live.latest_message import LatestMessage
from arena_ros.live.nav2_goals import Nav2Goals
from arena_ros.transport import Transport

MOVE_BASE = "/move_base"  # its action's usual name
NONE = "none"
GOAL_TOPICS = {1: "/move_base_simple/goal", 2: "/goal_pose"}


class GoalSource(ABC):
    """Where goals come from, one at a time, and where it is said what becomes of them."""

    look: float = float("inf")  # s at most between two looks for a goal, beside the control period

    @abstractmethod
    def take(self) -> Pose | None:
        """Return a goal that is new; one that was driven to until now is given up for it."""

    @abstractmethod
    def over(self) -> str:
        """Return why the goal is driven to no longer, empty while it is."""

    @abstractmethod
    def end(self, text: str, *, reached: bool) -> None:
        """Say what became of the goal that was driven to."""

    def tick(self) -> None:  # noqa: B027 - most are asked instead
        """Say that goals are taken."""

    def publish_progress(self, pose: Pose, twist: Twist) -> None:  # noqa: B027 - goals of a topic want no answer
        """Say where the robot is, and how fast, while it drives to a goal."""

    def judge(self, decision: Decision, stamp: float) -> str:
        """Return why the goal is given up after a decision, s after its begin; empty where it is not."""
        return ""

    def stall(self, fault: str, stamp: float) -> str:
        """Return why the goal is given up while the robot has to stand for a fault; empty where it waits."""
        return ""


class Goals(GoalSource):
    """Hears goals in ``map``, whichever way they come, and says what becomes of those that want to know."""

    def __init__(self, transport: Transport, action: str | None, namespace: str = "") -> None:
        topic = namespace + GOAL_TOPICS[transport.ros]
        self._topic = LatestMessage(transport, get_codec(transport.ros), topic, to.POSE_STAMPED)
        name = served_action(transport, action, namespace)
        self._server = ActionServer(transport, name) if name is not None else None

    def take(self) -> Pose | None:
        """Return a goal that is new; one that was driven to until now is given up for it."""
        if self._server is not None and (asked := self._server.take()) is not None:
            goal, fault = _goal_pose(asked.target)
            if fault:
                self._server.reject_goal(asked, fault)
            else:
                self._server.accept(asked)
            return goal
        message = self._topic.take()
        if message is None:
            return None
        goal, fault = _goal_pose(message)
        if fault:
            print_notice(fault)
        elif self._server is not None:
            self._server.accept(None)
        return goal

    def over(self) -> str:
        """Return that who sent the goal does not want it any more, where it is so."""
        return "the goal was cancelled" if self._server is not None and self._server.is_cancelled else ""

    def tick(self) -> None:
        """Say that goals are taken."""
        if self._server is not None:
            self._server.tick()

    def publish_progress(self, pose: Pose, twist: Twist) -> None:
        """Say where the robot is while it drives to a goal."""
        if self._server is not None:
            self._server.publish_feedback(pose)

    def end(self, text: str, *, reached: bool) -> None:
        """Say what became of the goal that was driven to."""
        if self._server is not None:
            self._server.end(GoalState.SUCCEEDED if reached else GoalState.ABORTED, text)


def _goal_pose(message: Any) -> tuple[Pose | None, str]:
    """Return the goal of a PoseStamped, or why it cannot be driven to."""
    frame = message.header.frame_id.lstrip("/")
    goal = to.pose_from_msg(message.pose)
    if frame not in ("map", ""):
        return None, f"a goal in the frame {frame} is not driven to; allowed: map"
    if not np.isfinite(goal.array()).all():
        return None, "a goal that is no number is not driven to"
    return goal, ""


def served_action(transport: Transport, said: str | None, namespace: str = "") -> str | None:
    """Return the name under which the action is served, None where it is not; raise
    ConfigurationError where it cannot be.
    """
    if said == NONE or (said is None and transport.ros == 2):
        return None
    if transport.ros == 2:
        raise ConfigurationError(
            f"action is {said}; allowed in ROS 2: none, goals come by {GOAL_TOPICS[2]}, "
            "and arena ros controller serves follow_path"
        )
    name = "/" + (said or namespace + MOVE_BASE).strip("/")
    if others := transport.rivals(f"{name}/status"):
        print_notice(f"{others[0]} serves {name} already: goals come from {namespace}{GOAL_TOPICS[1]} alone")
        return None
    return name


def open_goals(
    transport: Transport, name: str, controller: str = "", heard: Callable[[], None] = lambda: None
) -> ActionClient | Nav2Goals:
    """Return what sends goals to an action: move_base's in ROS 1, one of Nav2's in ROS 2."""
    name = "/" + name.strip("/")
    if transport.ros == 2:
        return Nav2Goals(transport, name, controller, heard)
    return ActionClient(transport, name, heard)
