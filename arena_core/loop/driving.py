"""The loop of one episode, whatever is driven: the robot of a simulator, or a real one."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from arena_core.base.ctrl_c import interrupts
from arena_core.base.errors import describe_error
from arena_core.loop.navigator import Decision, Navigator
from arena_core.loop.recording import Recorder
from arena_core.values.episode import Outcome
from arena_core.values.sensing import Sensors


@dataclass(frozen=True, slots=True)
class Ending:
    """How an episode ends: its outcome, what went wrong, and the decision that ended it, if one did."""

    outcome: Outcome
    error: str = ""
    decision: Decision | None = None


class RobotInterface(Protocol):
    """A robot as the loop of an episode drives it; it also tells the recorder the state of each step.

    One control step is ``read``, the navigator's decision, ``judge``, ``write``.
    """

    def read(self) -> Sensors | Ending:
        """Return what the sensors say when the next control step is due, or how the episode ends instead."""
        ...

    def judge(self, decision: Decision) -> Ending | None:
        """Return how the episode ends with a decision, or None."""
        ...

    def write(self, decision: Decision) -> Decision:
        """Send the command of a decision; return the decision as it was carried out."""
        ...


def drive_episode(robot: RobotInterface, navigator: Navigator, recorder: Recorder) -> Ending:
    """Drive a robot to the end of its episode; whatever the navigator raises ends it with the outcome ``error``."""
    while True:
        sensors = robot.read()
        if isinstance(sensors, Ending):
            return sensors
        try:
            decision = navigator.decide(sensors)
            considered = navigator.considered(decision) if recorder.keeps_considered else None
        except BaseException as error:  # whatever a planner raises, sys.exit() too
            if interrupts.raised(error):
                raise
            return Ending("error", describe_error(error))
        ending = robot.judge(decision)
        if ending is not None:
            return ending
        recorder.add(robot.write(decision), considered)
