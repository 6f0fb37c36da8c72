"""Where velocities go: held to the robot's limits, watched, and not at all where they come too late."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace

from arena_core import Robot, Twist
from arena_core.commands import print_notice
from arena_core.hosting import Decision
from arena_core.records import Event
from arena_ros import conversions as to
from arena_ros.codec import get_codec
from arena_ros.live.loop_monitor import LoopMonitor
from arena_ros.live.sensor_inputs import SensorInputs
from arena_ros.live.settings import Settings
from arena_ros.live.speed_limiter import STAND, SpeedLimiter
from arena_ros.live.time_source import RosTime
from arena_ros.transport import Transport

STEP_ARRIVES = 0.2  # s of wall time within which all messages of a step have come


@dataclass(frozen=True, slots=True)
class VelocityTopic:
    """The topic of velocities; with ``alone`` the robot stands while another node publishes it.

    With ``idle`` zeros are sent also while there is no goal. ``clock`` is where velocities have a stamp, that of the
    clock: then a simulator waits for each of them, and none is sent that answers no step.
    """

    name: str
    alone: bool
    idle: bool = True
    clock: RosTime | None = None


class VelocityOutput:
    """Sends a robot velocities, one a control period, and notes how long that took."""

    def __init__(self, transport: Transport, topic: VelocityTopic, robot: Robot, period: float, settings: Settings):
        self._late, self._topic = settings.overrun * period, topic
        self._limiter = SpeedLimiter(robot, settings.speed, period)
        codec = self._codec = get_codec(transport.ros)
        self._kind = to.TWIST if topic.clock is None else to.TWIST_STAMPED
        publish = self._publish = transport.publisher(topic.name, self._kind)
        stand = codec.encode(to.twist_msg(codec, STAND), to.TWIST)
        rivals = (lambda: transport.rivals(topic.name)) if topic.alone else None
        limit = (settings.overrun + 1.0) * period if topic.clock is None else float("inf")
        self.monitor = LoopMonitor(lambda: publish(stand), limit, rivals)
        self.latencies: list[float] = []
        # s of each step that were not the navigator's: taking in sensors, limits, sending
        self.beyond: list[float] = []

    def stop(self) -> None:
        """Let the robot stand."""
        self._send(self._limiter.stop())

    def idle(self) -> None:
        """Let the robot stand while it has no goal, unless others may drive it then."""
        if self._topic.idle:
            self.stop()

    def await_odometry(self, sensors: SensorInputs) -> None:
        """Wait until what the next velocity answers has come, where each answers a step."""
        if self._topic.clock is not None:
            sensors.wait_for_odometry(self._topic.clock.stamp, STEP_ARRIVES)

    def limit(self, decision: Decision, took: float, stamp: float) -> Decision:
        """Return a decision with the command that is to be sent: to stand where it took too long to be true any
        more.
        """
        if took <= self._late:
            return replace(decision, command=self._limiter.limit_command(decision.command))
        print_notice("control steps take longer than they may: the robot stops for each of them")
        event = Event(stamp, "safety_stop", f"a control step took {took:.2f} s")
        return replace(decision, command=self._limiter.stop(), events=(*decision.events, event))

    def send(self, decision: Decision, took: float) -> None:
        """Send the command of a decision that took so long."""
        begin = time.monotonic()
        self._send(decision.command)
        self.monitor.note_command()
        self.latencies.append(took + time.monotonic() - begin)
        self.beyond.append(self.latencies[-1] - decision.spent.navigator)

    def rival(self) -> str | None:
        """Return who else commands the robot; None where no one does."""
        rivals = self.monitor.rivals
        return f"{rivals[0]} publishes {self._topic.name}, too (alone=false lets it)" if rivals else None

    def _send(self, command: Twist) -> None:
        own, clock = self._codec, self._topic.clock
        message = to.twist_msg(own, command)
        if clock is not None:
            clock.answered = clock.stamp
            message = own.make(to.TWIST_STAMPED, header=own.header(clock.stamp, "base_link"), twist=message)
        self._publish(own.encode(message, self._kind))
