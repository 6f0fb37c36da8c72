"""The loop of an episode, with a robot that is no simulator's."""

import numpy as np

from arena_core import Pose, PoseEstimate, Sensors, Twist
from arena_core.loop.driving import Ending, drive_episode
from arena_core.loop.navigator import NO_TIME, Decision
from arena_core.loop.recording import Recorder
from arena_core.testing import robot, scenario

SENSORS = object.__new__(Sensors)  # the loop hands them on, and looks at nothing in them


def decision(vx):
    return Decision(Twist(vx), PoseEstimate(Pose(0.0, 0.0), np.zeros((3, 3))), Pose(0.0, 0.0), None, False, (), NO_TIME)


class Slow:
    """A robot that drives half as fast as it is told, for three steps."""

    def __init__(self, judged=None):
        self.events, self.judged = [], judged

    def read(self):
        self.events.append("read")
        return SENSORS if self.events.count("read") < 4 else Ending("time_out", "three steps")

    def judge(self, wanted):
        self.events.append("judge")
        return self.judged

    def write(self, wanted):
        self.events.append("write")
        return decision(0.5 * wanted.command.vx)


class Brain:
    def __init__(self, error=None):
        self.error = error

    def decide(self, sensors):
        assert sensors is SENSORS
        if self.error:
            raise self.error
        return decision(1.0)


class Kept(Recorder):
    """A recorder that shows what it was given."""

    def __init__(self):
        super().__init__(scenario(), robot(), {"columns": {}})
        self.decisions = []

    def add(self, decision, considered=None):
        self.decisions.append(decision)


def test_a_step_is_read_judged_and_written_until_the_robot_ends_it():
    slow, kept = Slow(), Kept()
    assert drive_episode(slow, Brain(), kept) == Ending("time_out", "three steps")
    assert slow.events == ["read", "judge", "write"] * 3 + ["read"]


def test_what_is_recorded_is_the_command_that_was_sent():
    kept = Kept()
    drive_episode(Slow(), Brain(), kept)
    assert [each.command.vx for each in kept.decisions] == [0.5, 0.5, 0.5]


def test_a_verdict_ends_the_episode_before_anything_is_sent():
    slow, kept = Slow(Ending("goal_reached")), Kept()
    assert drive_episode(slow, Brain(), kept) == Ending("goal_reached")
    assert (slow.events, kept.decisions) == (["read", "judge"], [])


def test_whatever_a_navigator_raises_ends_the_episode_with_an_error():
    assert drive_episode(Slow(), Brain(SystemExit(3)), Kept()).outcome == "error"
