"""move_base's action, served and asked for: actionlib's protocol is five topics
(wiki.ros.org/actionlib/DetailedDescription).
"""

from __future__ import annotations

import os
import time
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from enum import IntEnum
from typing import Any

from arena_core import Path, Pose
from arena_core.commands import one_line
from arena_ros import conversions as to
from arena_ros.codec import BadMessage, get_codec, stamp_of
from arena_ros.transport import Transport

GOAL = "move_base_msgs/msg/MoveBaseActionGoal"
FEEDBACK = "move_base_msgs/msg/MoveBaseActionFeedback"
RESULT = "move_base_msgs/msg/MoveBaseActionResult"
GOAL_ID, STATUS, STATUSES = (f"actionlib_msgs/msg/{name}" for name in ("GoalID", "GoalStatus", "GoalStatusArray"))
STATUS_PERIOD = 0.2  # s between two messages of status, as actionlib's servers have it
KEPT = 5.0  # s that a goal which has ended stays in them, likewise
AGAIN = 0.5  # s after which a goal is sent again that the server does not know: it may have come later


class GoalState(IntEnum):
    """What becomes of a goal, as actionlib_msgs/GoalStatus numbers it."""

    PENDING = 0
    ACTIVE = 1
    PREEMPTED = 2
    SUCCEEDED = 3
    ABORTED = 4
    REJECTED = 5
    PREEMPTING = 6
    RECALLED = 8


@dataclass(slots=True, eq=False)
class GoalRequest:
    """A goal that a person has sent: ``identity`` and ``target`` are messages; ``ended`` is
    when, s of the monotonic clock.
    """

    identity: Any
    target: Any
    state: GoalState = GoalState.PENDING
    text: str = ""
    ended: float | None = None


class ActionServer:
    """Takes goals and says what becomes of them, one at a time; a new one takes the place of the old one, as in
    move_base.

    Only who owns it calls it, no thread of the transport: that only puts down what it hears.
    """

    def __init__(self, transport: Transport, name: str) -> None:
        self._codec = get_codec(1)
        self._heard: deque[tuple[str, bytes]] = deque(maxlen=100)
        transport.subscribe(f"{name}/goal", GOAL, lambda content: self._heard.append((GOAL, content)))
        transport.subscribe(f"{name}/cancel", GOAL_ID, lambda content: self._heard.append((GOAL_ID, content)))
        self._send_status = transport.publisher(f"{name}/status", STATUSES, latched=True)
        self._send_feedback = transport.publisher(f"{name}/feedback", FEEDBACK)
        self._send_result = transport.publisher(f"{name}/result", RESULT)
        self._known: list[GoalRequest] = []
        self._waiting: GoalRequest | None = None
        self._current: GoalRequest | None = None
        self._count = 0
        self._told = float("-inf")
        self.tick()

    def take(self) -> GoalRequest | None:
        """Return the goal that waits, once."""
        self._read_messages()
        asked, self._waiting = self._waiting, None
        return asked

    def accept(self, asked: GoalRequest | None) -> None:
        """Have a goal driven to from now on, or None: one that is not of this action."""
        self.end(GoalState.PREEMPTED, "another goal came")
        self._current = asked
        if asked is not None:
            asked.state = GoalState.ACTIVE
        self.tick(at_once=True)

    def reject_goal(self, asked: GoalRequest, text: str) -> None:
        """Say that a goal is not driven to."""
        self._finish_goal(asked, GoalState.REJECTED, text)

    @property
    def is_cancelled(self) -> bool:
        """Return whether the goal that is driven to is not wanted any more."""
        self._read_messages()
        return self._current is not None and self._current.state is GoalState.PREEMPTING

    def end(self, state: GoalState, text: str) -> None:
        """Say what became of the goal that was driven to, if there is one."""
        asked, self._current = self._current, None
        if asked is not None:
            self._finish_goal(asked, GoalState.PREEMPTED if asked.state is GoalState.PREEMPTING else state, text)

    def publish_feedback(self, pose: Pose) -> None:
        """Say where the robot is, in ``map``."""
        if self._current is not None:
            own, now = self._codec, time.time_ns()
            inner = own.make(
                "move_base_msgs/msg/MoveBaseFeedback", base_position=to.pose_stamped_msg(own, pose, now, "map")
            )
            message = own.make(
                FEEDBACK, header=own.header(now, ""), status=self._goal_status(self._current), feedback=inner
            )
            self._send_feedback(own.encode(message, FEEDBACK))

    def tick(self, *, at_once: bool = False) -> None:
        """Publish the status of all goals, where it is due."""
        now, own = time.monotonic(), self._codec
        if at_once or now - self._told >= STATUS_PERIOD:
            self._told = now
            self._known = [each for each in self._known if each.ended is None or now - each.ended < KEPT]
            statuses = [self._goal_status(each) for each in self._known]
            message = own.make(STATUSES, header=own.header(time.time_ns(), ""), status_list=statuses)
            self._send_status(own.encode(message, STATUSES))

    def _read_messages(self) -> None:
        while self._heard:
            kind, content = self._heard.popleft()
            try:
                message = self._codec.decode(content, kind)
            except BadMessage:
                continue
            if kind == GOAL:
                self._take_goal(message)
            else:
                self._cancel_goals(message)

    def _take_goal(self, message: Any) -> None:
        self._count += 1
        identity = message.goal_id
        if not identity.id:
            identity = self._codec.make(GOAL_ID, stamp=identity.stamp, id=f"arena-{self._count}")
        if any(each.identity.id == identity.id for each in self._known):
            return
        if self._waiting is not None:
            self._finish_goal(self._waiting, GoalState.RECALLED, "another goal came")
        self._waiting = GoalRequest(identity, message.goal.target_pose)
        self._known.append(self._waiting)
        self.tick(at_once=True)

    def _cancel_goals(self, message: Any) -> None:
        if self._waiting is not None and _matches_goal(self._waiting, message):
            self._finish_goal(self._waiting, GoalState.RECALLED, "it was cancelled")
            self._waiting = None
        if self._current is not None and _matches_goal(self._current, message):
            self._current.state = GoalState.PREEMPTING

    def _finish_goal(self, asked: GoalRequest, state: GoalState, text: str) -> None:
        asked.state, asked.text, asked.ended = state, text, time.monotonic()
        own = self._codec
        result = own.make("move_base_msgs/msg/MoveBaseResult")
        message = own.make(
            RESULT, header=own.header(time.time_ns(), ""), status=self._goal_status(asked), result=result
        )
        self._send_result(own.encode(message, RESULT))
        self.tick(at_once=True)

    def _goal_status(self, asked: GoalRequest) -> Any:
        return self._codec.make(STATUS, goal_id=asked.identity, status=int(asked.state), text=asked.text)


def _matches_goal(asked: GoalRequest, cancel: Any) -> bool:
    """Return whether a cancellation means a goal: it may name it, name nothing and so
    mean all, or mean all up to a stamp.
    """
    if cancel.id:
        return bool(cancel.id == asked.identity.id)
    stamp = stamp_of(cancel.stamp)
    return stamp == 0 or stamp_of(asked.identity.stamp) <= stamp


@dataclass(frozen=True, slots=True)
class GoalEnd:
    """What became of a goal that was sent: whether the robot has arrived, and what the server said."""

    reached: bool
    said: str


class ActionClient:
    """Sends goals to a move_base, one at a time; ``ended`` says what became of the last one, None while it is driven
    to.

    ``is_known`` says whether the server has said that it has the goal; ``heard`` is called when it ends, in a thread
    of the transport.
    """

    answers = False  # a server says by the clock that it has a goal, which stands still until it commands

    def __init__(self, transport: Transport, name: str, heard: Callable[[], None] = lambda: None) -> None:
        self.name = name
        self.ended: GoalEnd | None = None
        self._codec, self._heard = get_codec(1), heard
        self._send_goal = transport.publisher(f"{name}/goal", GOAL)
        self._send_cancel = transport.publisher(f"{name}/cancel", GOAL_ID)
        self._id, self._content, self._count = "", b"", 0
        self.is_known, self._sent = False, 0.0
        transport.subscribe(f"{name}/status", STATUSES, self._on_status)
        transport.subscribe(f"{name}/result", RESULT, self._on_result)

    def send(self, goal: Pose, stamp: int) -> None:
        """Send a goal in ``map``; ``stamp`` ns is that of the clock which counts."""
        own = self._codec
        self._count += 1
        self.ended, self.is_known = None, False
        self._id = f"arena-{os.getpid()}-{self._count}"
        # servers leave out what is older than the one before
        identity = own.make(GOAL_ID, stamp=own.time(time.time_ns()), id=self._id)
        inner = own.make("move_base_msgs/msg/MoveBaseGoal", target_pose=to.pose_stamped_msg(own, goal, stamp, "map"))
        self._content = own.encode(own.make(GOAL, header=own.header(stamp, ""), goal_id=identity, goal=inner), GOAL)
        self._send_goal(self._content)
        self._sent = time.monotonic()

    def follow(self, path: Path, stamp: int) -> None:
        """Leave the path to the server, which plans its own."""

    def release(self) -> None:
        """Leave the last goal to the server, for which the next one takes its place."""

    def resend_goal(self) -> None:
        """Send the goal again to a server that has not said that it knows it."""
        if self._id and not self.is_known and self.ended is None and time.monotonic() - self._sent > AGAIN:
            self._send_goal(self._content)
            self._sent = time.monotonic()

    def cancel(self) -> None:
        """Say that the goal is not wanted any more."""
        if self._id and self.ended is None:
            identity = self._codec.make(GOAL_ID, stamp=self._codec.time(0), id=self._id)
            self._send_cancel(self._codec.encode(identity, GOAL_ID))

    def _on_status(self, content: bytes) -> None:
        if not self.is_known and (message := self._read_message(content, STATUSES)) is not None:
            self.is_known = any(each.goal_id.id == self._id for each in message.status_list)

    def _on_result(self, content: bytes) -> None:
        message = self._read_message(content, RESULT)
        if (
            message is None
            or message.status.goal_id.id != self._id
            or message.status.status not in [each.value for each in GoalState]
        ):
            return
        state, text = GoalState(message.status.status), one_line(message.status.text, 80)
        said = state.name.lower() + (f" ({text})" if text else "")
        self.ended = GoalEnd(state is GoalState.SUCCEEDED, said)
        self._heard()

    def _read_message(self, content: bytes, kind: str) -> Any | None:
        try:
            return self._codec.decode(content, kind)
        except BadMessage:
            return None
