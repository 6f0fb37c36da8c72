"""What connects a driver to its robot and to people."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from arena_core.hosting import Benchmark
from arena_ros import conversions as to
from arena_ros.codec import get_codec
from arena_ros.live.goals import Goals, GoalSource
from arena_ros.live.latest_message import LatestMessage
from arena_ros.live.sensor_inputs import SensorInputs, SensorTopics
from arena_ros.live.settings import Settings
from arena_ros.live.time_source import TimeSource
from arena_ros.live.velocity_output import VelocityOutput, VelocityTopic
from arena_ros.live.views import TOPICS, Views, ViewTopics, show_planner
from arena_ros.transport import Transport


@dataclass(frozen=True, slots=True)
class Topics:
    """The topics of sensors and velocities, and the name under which move_base's action is served.

    Where ``action`` is None, it is the usual one in ROS 1. ``goals`` take its place where there are some, ``clock``
    that of the wall, and topics of views have the names of ``views``. What has no name of its own lies in the
    ``namespace``, empty or such as ``/robot1``.
    """

    sensors: SensorTopics
    velocities: VelocityTopic
    action: str | None
    goals: GoalSource | None = None
    clock: TimeSource | None = None
    views: Mapping[str, str] = field(default_factory=dict)
    namespace: str = ""


@dataclass(frozen=True, slots=True, eq=False)
class Connections:
    """Sensors, velocities, goals, poses where the robot is said to stand, and views for people."""

    sensors: SensorInputs
    velocities: VelocityOutput
    goals: GoalSource
    starts: LatestMessage
    views: Views


def connect_robot(transport: Transport, benchmark: Benchmark, settings: Settings, topics: Topics) -> Connections:
    """Subscribe and publish what a driver needs; the benchmark's planner is shown to people from now on."""
    sensors = SensorInputs(transport, topics.sensors, benchmark.robot, settings, topics.clock)
    period = benchmark.navigator.control_period
    velocities = VelocityOutput(transport, topics.velocities, benchmark.robot, period, settings)
    space = topics.namespace
    goals = topics.goals or Goals(transport, topics.action, space)
    starts = LatestMessage(transport, get_codec(transport.ros), f"{space}/initialpose", to.POSE_COVARIANCE)
    seen, frame = show_planner(benchmark.navigator), None if sensors.is_external else lambda: sensors.odom_frame()[0]
    names = {**{topic: space + topic for topic in TOPICS}, **topics.views}
    views = Views(transport, goals, seen, ViewTopics(settings.status_period, frame, names))
    return Connections(sensors, velocities, goals, starts, views)
