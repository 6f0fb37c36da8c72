"""What a driver publishes for people to see: plan, waypoint, pose, what the planner sees, and a status."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from arena_core import Candidate, Observation, Planner, Pose, Sensors, Twist
from arena_core.hosting import Decision, Navigator
from arena_ros import conversions as to
from arena_ros.codec import PEOPLE, get_codec
from arena_ros.live.goals import GoalSource
from arena_ros.transport import Transport

TOPICS = {
    "/plan": to.PATH,
    "/waypoint": to.POSE_STAMPED,
    "/arena/pose": to.POSE_COVARIANCE,
    "/arena/status": to.TEXT,
    "/arena/local_costmap": to.GRID,
    "/arena/tracks": PEOPLE,
}


class Seen(Planner):
    """A planner whose last observation can be shown to people."""

    def __init__(self, planner: Planner) -> None:
        self.inner = planner
        self.observation: Observation | None = None

    def reset(self, episode: Any) -> None:
        """Begin an episode."""
        self.observation = None
        self.inner.reset(episode)

    def compute_velocity(self, observation: Observation) -> Twist:
        """Return what the planner says."""
        self.observation = observation
        return self.inner.compute_velocity(observation)

    def considered(self) -> Sequence[Candidate] | None:
        """Return what the planner considered."""
        return self.inner.considered()


def show_planner(navigator: Navigator) -> Seen:
    """Return a navigator's planner, from now on one whose observation can be shown."""
    seen = Seen(navigator.planner)
    seen.compiles = navigator.planner.compiles  # type: ignore[misc]
    navigator.planner = seen
    return seen


@dataclass(frozen=True, slots=True)
class ViewTopics:
    """How views are published: a status each ``period`` s, and names that topics have instead of their usual ones.

    ``odom_frame`` returns the name of odometry's frame, where no one else says where that is in ``map``.
    """

    period: float
    odom_frame: Callable[[], str] | None
    names: Mapping[str, str]


class Views:
    """Publishes views of a drive."""

    def __init__(self, transport: Transport, goals: GoalSource, seen: Seen, topics: ViewTopics) -> None:
        self._codec, self._goals, self._seen = get_codec(transport.ros), goals, seen
        self._status_period = topics.period
        self._out = {
            topic: (transport.publisher(topics.names.get(topic, topic), kind, latched=topic == "/plan"), kind)
            for topic, kind in TOPICS.items()
        }
        self._odom_frame = topics.odom_frame
        self._tf = transport.publisher("/tf", to.TF) if topics.odom_frame is not None else None
        self._shown = float("-inf")

    def publish_step(self, decision: Decision, sensors: Sensors) -> None:
        """Publish what people want to see of a control step; the command is out already."""
        own, now = self._codec, time.time_ns()
        if decision.planned is not None:
            self._publish_message("/plan", to.path_msg(own, decision.planned.poses, now, "map"))
        self._publish_message("/waypoint", to.pose_stamped_msg(own, decision.waypoint, now, "map"))
        estimate = decision.estimate
        self._publish_message(
            "/arena/pose", to.pose_covariance_msg(own, estimate.pose, estimate.covariance, now, "map")
        )
        if self._tf is not None and self._odom_frame is not None:
            correction = estimate.pose.compose(sensors.odometry.pose.relative(Pose(0.0, 0.0)))
            self._tf(own.encode(to.transforms_msg(own, [("map", self._odom_frame(), correction)], now), to.TF))
        self._goals.publish_progress(estimate.pose, sensors.odometry.twist)
        self.publish_status("drives", decision)

    def publish_status(self, text: str, decision: Decision | None = None, *, at_once: bool = False) -> None:
        """Publish a status, not more often than its period but ``at_once``; with a decision what the planner sees."""
        self._goals.tick()
        if not at_once and time.monotonic() - self._shown < self._status_period:
            return
        self._shown = time.monotonic()
        own, now = self._codec, time.time_ns()
        status: dict[str, Any] = {"status": text}
        if decision is not None:
            status["command"] = decision.command.array().tolist()
            if (seen := self._seen.observation) is not None:
                costs, tracks = seen.local_map, seen.tracks
                self._publish_message("/arena/local_costmap", to.costmap_msg(own, costs, now, "map"))
                self._publish_message(
                    "/arena/tracks",
                    to.people_msg(own, tracks.ids.tolist(), tracks.positions, tracks.velocities, to.Header(now, "map")),
                )
        self._publish_message("/arena/status", to.text_msg(own, json.dumps(status)))

    def _publish_message(self, topic: str, message: Any) -> None:
        publish, kind = self._out[topic]
        publish(self._codec.encode(message, kind))
