"""What an action of ROS 2 is to this package, whichever transport carries it: goals that come, and goals that are sent.

Messages are objects with the interface's fields: those of our codec, or those of rclpy. States are those of
action_msgs/GoalStatus.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from enum import IntEnum
from typing import Any


class GoalStatus(IntEnum):
    """What becomes of a goal."""

    UNKNOWN = 0
    ACCEPTED = 1
    EXECUTING = 2
    CANCELING = 3
    SUCCEEDED = 4
    CANCELED = 5
    ABORTED = 6


class ReceivedGoal(ABC):
    """A goal that was accepted; only its owner's thread calls it."""

    request: Any

    @property
    @abstractmethod
    def is_cancelled(self) -> bool:
        """Return whether its client does not want it any more."""

    @abstractmethod
    def publish_feedback(self, message: Any) -> None:
        """Send feedback."""

    @abstractmethod
    def end(self, status: GoalStatus, result: Any) -> None:
        """Say what became of it, once."""


class GoalSender(ABC):
    """Sends goals to an action, one at a time; ``ended`` is what became of the last one and its result, None before.

    ``is_known`` says whether the server has accepted it; a goal that it rejects ends as UNKNOWN.
    """

    is_known = False
    ended: tuple[GoalStatus, Any] | None = None

    @abstractmethod
    def is_served(self) -> bool:
        """Return whether there is a server."""

    @abstractmethod
    def send(self, goal: Any) -> None:
        """Send a goal; the one before counts no more."""

    @abstractmethod
    def cancel(self) -> None:
        """Say that the goal is not wanted any more."""


GoalCallback = Callable[[ReceivedGoal], None]  # may be called in another thread
EndCallback = Callable[[], None]  # likewise: is_known or ended has changed
