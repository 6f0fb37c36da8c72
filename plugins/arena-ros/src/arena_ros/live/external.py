"""``planner=ros_external``: a ROS node decides, in lock-step.

The clock goes on when its command has come, however long that takes.
"""

from __future__ import annotations

import threading
import time
from functools import lru_cache
from typing import Any, NamedTuple

from arena_core import ArenaError, EpisodeStart, Observation, Planner, Pose, Robot, Twist
from arena_core.parameters import Positive
from arena_ros import conversions as to
from arena_ros.codec import BadMessage, get_codec, stamp_of
from arena_ros.live.goals import GOAL_TOPICS, open_goals
from arena_ros.live.speed_limiter import STAND
from arena_ros.transport import Transport, open_transport

BEGIN = 10**9  # ns of the clock at the first episode's begin
PAUSE = 10**9  # ns from one episode's last step to the next one's begin
AGAIN = 0.1  # s after which the first step and a goal are sent again: who connects late has missed them
AT_HOME = Pose(0.0, 0.0)


class BudgetExceeded(ArenaError):
    """A foreign planner did not answer in time."""


class GoalGivenUp(ArenaError):
    """A foreign planner drives no further."""


class RosExternal(Planner):
    """Sends what it is shown to a ROS node, and returns the command that comes back for this very step."""

    def __init__(
        self,
        robot: Robot,
        transport: str | None,
        command: str,
        silence: Positive | None,
        action: str | None,
        controller: str,
        budget: Positive,
        patience: Positive,
        *,
        stamped: bool,
    ) -> None:
        self._robot, self._transport_name = robot, transport
        self._node = _NodeNames(command, stamped, action, controller)
        self._silence = silence
        self._budget, self._patience = budget, patience
        self._link: _PlannerLink | None = None
        self._clock = BEGIN - PAUSE

    def reset(self, episode: EpisodeStart) -> None:
        """Connect, once in a process, and tell goal and map."""
        if self._link is None:
            self._link = _open_link(self._transport_name, self._node, self._silence)
        self._begin = self._clock + PAUSE
        self._path: Any = None
        self._link.begin(episode, self._begin)

    def compute_velocity(self, observation: Observation) -> Twist:
        """Return the node's command; raise BudgetExceeded where none comes, GoalGivenUp where the node says
        so: both end the episode.
        """
        if self._link is None:
            raise ArenaError("ros_external was not reset")
        self._clock = self._begin + round(observation.stamp * 1e9)
        limit = self._budget if self._link.answered else self._patience
        return self._link.request_command(observation, self._clock, self._robot.lidar.period, limit)


class _NodeNames(NamedTuple):
    """The topic of the node's commands, whether they have stamps, its action and the controller that is asked for."""

    command: str
    stamped: bool
    action: str | None
    controller: str


@lru_cache(maxsize=4)
def _open_link(transport: str | None, node: _NodeNames, silence: float | None) -> _PlannerLink:
    return _PlannerLink(open_transport(transport, "arena_ros_external"), node, silence)


class _PlannerLink:
    """The topics between this process and the node; ``answered`` says whether it has ever sent a command."""

    def __init__(self, transport: Transport, node: _NodeNames, silence: float | None) -> None:
        if "/clock" in transport.topics():
            raise ArenaError(
                "/clock is published already; allowed: one clock (executor.workers=1, "
                "and no other simulator at this master)"
            )
        self._codec, self._stamped, self._silence, self._command = (
            get_codec(transport.ros),
            node.stamped,
            silence,
            node.command,
        )
        self._spoke = time.monotonic()
        kinds = {"/scan": to.SCAN, "/odom": to.ODOMETRY, "/tf": to.TF, "/clock": to.CLOCK, "/waypoint": to.POSE_STAMPED}
        latched = {"/map": to.GRID, "/plan": to.PATH, "/tf_static": to.TF}
        self._goal = GOAL_TOPICS[transport.ros]
        latched[self._goal] = to.POSE_STAMPED
        self._out = {topic: (transport.publisher(topic, kind), kind) for topic, kind in kinds.items()}
        self._out |= {topic: (transport.publisher(topic, kind, latched=True), kind) for topic, kind in latched.items()}
        self._came = threading.Condition()
        self._answer: tuple[int | None, Twist] | None = None
        self.answered = False
        self._path: Any = None
        self._asked = (
            open_goals(transport, node.action, node.controller, self._notify_waiters)
            if node.action is not None
            else None
        )
        transport.subscribe(node.command, to.TWIST_STAMPED if node.stamped else to.TWIST, self._on_command)

    def begin(self, episode: EpisodeStart, stamp: int) -> None:
        """Tell map and goal."""
        own = self._codec
        if self._asked is not None:
            self._asked.release()
        self._path, self._spoke = None, time.monotonic()
        if episode.map is not None:
            self._publish_message("/map", to.grid_msg(own, episode.map, stamp, "map"))
        self._publish_message("/clock", own.make(to.CLOCK, clock=own.time(stamp)))
        if self._asked is not None:
            self._asked.send(episode.goal, stamp)
        else:
            self._publish_message(self._goal, to.pose_stamped_msg(own, episode.goal, stamp, "map"))

    def request_command(self, observation: Observation, stamp: int, scan_period: float, limit: float) -> Twist:
        """Send a step and wait for its command; return the command to stand where the node may be silent, and is."""
        begin = time.monotonic()
        end = (begin if self._silence is None else self._spoke) + limit
        if self._asked is not None:
            self._asked.follow(observation.path, stamp)
            self._await_goal(end)
        with self._came:
            self._answer = None
        self._send_step(observation, stamp, scan_period)
        while True:
            with self._came:
                self._came.wait_for(lambda: self._matches_stamp(stamp) or self._has_ended(), self._patience(end))
                if self._matches_stamp(stamp) and self._answer is not None:
                    self.answered, self._spoke = True, time.monotonic()
                    return self._answer[1]
            if self._has_ended():
                return self._handle_end()
            if time.monotonic() >= end:
                if self._asked is not None and not self._asked.is_known:
                    raise BudgetExceeded(f"no server of {self._asked.name} has taken the goal within {limit:g} s")
                raise BudgetExceeded(f"no command on {self._command} for this step within {limit:g} s")
            if self._silence is not None and time.monotonic() - begin >= self._silence:
                return STAND
            if not self.answered:
                self._send_step(observation, stamp, scan_period)
            if self._asked is not None:
                self._asked.resend_goal()

    def _await_goal(self, end: float) -> None:
        """Wait until a node that answers at once, and has before, knows its new goal: its next command is for that."""
        assert self._asked is not None
        while self._asked.answers and self.answered and not self._asked.is_known and time.monotonic() < end:
            with self._came:
                self._came.wait(AGAIN)
            self._asked.resend_goal()

    def _patience(self, end: float) -> float:
        """Return how long is waited before something is sent again, s."""
        left = end - time.monotonic()
        connected = self.answered and self._silence is None and (self._asked is None or self._asked.is_known)
        return left if connected else min(left, AGAIN)

    def _has_ended(self) -> bool:
        return self._asked is not None and self._asked.ended is not None

    def _handle_end(self) -> Twist:
        """Stand where the node says that it has arrived; raise GoalGivenUp where it says anything else."""
        assert self._asked is not None
        assert self._asked.ended is not None
        if not self._asked.ended.reached:
            raise GoalGivenUp(f"{self._asked.name} says {self._asked.ended.said}")
        return STAND

    def _notify_waiters(self) -> None:
        with self._came:
            self._came.notify()

    def _matches_stamp(self, stamp: int) -> bool:
        return self._answer is not None and self._answer[0] in (None, stamp)

    def _on_command(self, content: bytes) -> None:
        try:
            message = self._codec.decode(content, to.TWIST_STAMPED if self._stamped else to.TWIST)
        except BadMessage:
            return
        with self._came:
            self._answer = (stamp_of(message.header.stamp) if self._stamped else None), to.twist_from_msg(message)
            self._came.notify()

    def _send_step(self, observation: Observation, stamp: int, scan_period: float) -> None:
        """Send all that belongs to a step, the clock last."""
        own, pose = self._codec, observation.pose
        links = [("map", "odom", AT_HOME), ("odom", "base_link", pose)]
        self._publish_message("/tf", to.transforms_msg(own, links, stamp))
        if self._path is None:
            self._publish_message(
                "/tf_static", to.transforms_msg(own, [("base_link", "laser", observation.scan.mount)], stamp)
            )
        if self._path is not observation.path:
            self._path = observation.path
            self._publish_message("/plan", to.path_msg(own, observation.path.poses, stamp, "map"))
        self._publish_message("/waypoint", to.pose_stamped_msg(own, observation.waypoint, stamp, "map"))
        seen = stamp - round((observation.stamp - observation.scan.stamp) * 1e9)
        self._publish_message("/scan", to.scan_msg(own, observation.scan, seen, "laser", scan_period))
        self._publish_message(
            "/odom", to.odometry_msg(own, pose, observation.twist, to.Header(stamp, "odom"), "base_link")
        )
        self._publish_message("/clock", own.make(to.CLOCK, clock=own.time(stamp)))

    def _publish_message(self, topic: str, message: Any) -> None:
        publish, kind = self._out[topic]
        publish(self._codec.encode(message, kind))
