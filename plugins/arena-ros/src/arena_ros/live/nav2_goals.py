"""Goals for Nav2: its actions FollowPath and NavigateToPose as one sends them."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

from arena_core import ConfigurationError, Path, Pose
from arena_core.commands import one_line
from arena_ros import conversions as to
from arena_ros.action_protocol import GoalStatus
from arena_ros.codec import get_codec
from arena_ros.live.actions import GoalEnd
from arena_ros.transport import Transport

FOLLOW_PATH, TO_POSE = "nav2_msgs/action/FollowPath", "nav2_msgs/action/NavigateToPose"
NAMES = {"follow_path": FOLLOW_PATH, "navigate_to_pose": TO_POSE}  # how names of these actions end
AGAIN = 2.0  # s after which a goal is sent again that a server has not answered: it had not connected yet
RELEASE = 1.0  # s that a server may take to give a goal up


class Nav2Goals:
    """Sends goals to one of Nav2's actions, one at a time; ``ended`` is what became of the last one.

    FollowPath is sent each new path, NavigateToPose the goal. ``controller`` is a controller's name, empty for any.
    """

    answers = True  # a server says at once whether it accepts a goal

    def __init__(self, transport: Transport, name: str, controller: str, heard: Callable[[], None]) -> None:
        self.name, self._type = name, action_type(name)
        self._controller, self._codec = controller, get_codec(2)
        self._sender = transport.send_goals(name, self._type, heard)
        self._codes = {code: key for key, code in self._codec.constants(f"{self._type}_Result").items()}
        self._goal: Any = None
        self._path: Path | None = None
        self._sent = float("-inf")

    @property
    def is_known(self) -> bool:
        """Return whether the server has accepted the goal, or there is none."""
        return self._goal is None or self._sender.is_known or self._sender.ended is not None

    @property
    def ended(self) -> GoalEnd | None:
        """Return what became of the goal, None while it is driven to."""
        if self._goal is None or self._sender.ended is None:
            return None
        status, result = self._sender.ended
        if status is GoalStatus.UNKNOWN:
            return GoalEnd(reached=False, said="rejected")
        code, text = getattr(result, "error_code", 0), one_line(getattr(result, "error_msg", ""), 80)
        why = [f"{self._codes.get(code, 'error')} {code}"] * bool(code) + [text] * bool(text)
        return GoalEnd(status is GoalStatus.SUCCEEDED, status.name.lower() + (f" ({': '.join(why)})" if why else ""))

    def send(self, goal: Pose, stamp: int) -> None:
        """Have the robot drive to a goal in ``map``; ``stamp`` ns is that of the clock which counts."""
        self._goal, self._path = None, None
        if self._type == TO_POSE:
            pose = to.pose_stamped_msg(self._codec, goal, stamp, "map")
            self._send_goal(self._codec.make(f"{TO_POSE}_Goal", pose=pose, behavior_tree=""))

    def follow(self, path: Path, stamp: int) -> None:
        """Have it follow a path, unless it does; a new one takes the place of the old one."""
        if self._type == FOLLOW_PATH and path is not self._path:
            self._path = path
            message = to.path_msg(self._codec, path.poses, stamp, "map")
            ids = {"controller_id": self._controller, "goal_checker_id": "", "progress_checker_id": ""}
            self._send_goal(self._codec.make(f"{FOLLOW_PATH}_Goal", path=message, **ids))

    def resend_goal(self) -> None:
        """Send the goal again to a server that has not answered."""
        if not self.is_known and time.monotonic() - self._sent > AGAIN and self._sender.is_served():
            self._send_goal(self._goal)

    def release(self) -> None:
        """Have the last goal given up, and wait a little for that."""
        if self._goal is None or self._sender.ended is not None:
            return
        self._sender.cancel()
        end = time.monotonic() + RELEASE
        while self._sender.is_known and self._sender.ended is None and time.monotonic() < end:
            time.sleep(0.005)

    def _send_goal(self, goal: Any) -> None:
        self._goal, served = goal, self._sender.is_served()
        self._sent = time.monotonic() if served else float("-inf")
        self._sender.ended, self._sender.is_known = None, False
        if served:
            self._sender.send(goal)


def action_type(name: str) -> str:
    """Return the type of one of Nav2's actions by its name; raise ConfigurationError where it is none."""
    for ending, kind in NAMES.items():
        if name.endswith(ending):
            return kind
    raise ConfigurationError(f"action is {name}; allowed in ROS 2: a name that ends in {' or '.join(NAMES)}")
