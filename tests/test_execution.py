import math
from dataclasses import replace

import numpy as np
import pytest

from arena_core import Contact, Crowd, Pose, PoseEstimate, Simulator, Snapshot, Twist
from arena_core.loop.execution import Timing, run_episode
from arena_core.loop.navigator import NO_TIME, Decision, Spent
from arena_core.loop.recording import Recorder
from arena_core.testing import robot, scan, scenario
from arena_core.testing.samples import IDEAL

AHEAD = Twist(1.0)
TOUCH = Contact(1.0, "wall", -1, 0.5, True, 0.0, 0.0)


class Glide(Simulator):
    """Moves one robot along x, at once as fast as it is told; no one else is there."""

    inner_step = 0.02

    def __init__(self):
        self.commands, self.contacts = [], ()

    def reset(self, scenarios, slots=None):
        self.pose, self.stamp = scenarios[0].start.array(), 0.0
        return self.snapshot(0)

    def advance(self, commands, ticks):
        self.commands += [commands[0].tolist()] * ticks
        self.pose = self.pose + np.array((commands[0, 0] * ticks * self.inner_step, 0.0, 0.0))
        self.stamp += ticks * self.inner_step
        return self.snapshot(ticks)

    def snapshot(self, ticks):
        nobody = Crowd(
            *(np.zeros(1, np.int32), np.zeros((1, 0), np.int32), np.zeros((1, 0, 2)), np.zeros((1, 0, 2))),
            *(np.zeros((1, 0)), np.zeros((1, 0), np.int8)),
        )
        header = scan(Pose.of(self.pose), robot())
        stamps, poses, still = np.array((self.stamp,)), self.pose[None], np.zeros((1, 3))
        return Snapshot(
            *(
                stamps,
                poses,
                still,
                nobody,
                np.ones(1),
                np.full(1, np.inf),
                np.zeros(1, np.bool_),
                np.array((0.01 * ticks,)),
            ),
            *((self.contacts,), header.ranges[None], stamps, stamps, poses, still, header),
        )


class Brain:
    """A navigator that always says the same and stops at the goal."""

    control_period = 0.1
    privileged = ()

    def __init__(self, command=AHEAD, error=None, seconds=0.0):
        self.command, self.error, self.seconds = command, error, seconds

    def reset(self, mission, truth=None):
        self.mission = mission

    def notes(self):
        return {}

    def rehearse(self, sensors):
        pass

    def decide(self, sensors):
        if self.error and sensors.stamp > 0.95:
            raise self.error
        arrived = sensors.odometry.pose.distance(self.mission.goal) <= self.mission.goal_radius
        estimate = PoseEstimate(sensors.odometry.pose, np.zeros((3, 3)))
        return Decision(
            self.command, estimate, self.mission.goal, None, arrived, (), Spent(0.5 * self.seconds, 0.0, self.seconds)
        )


def episode(brain=None, simulator=None, timing=IDEAL, problem=None, stop_on_collision=False):
    problem = problem or scenario()
    recorder = Recorder(problem, robot(), {"columns": {}})
    return run_episode(
        problem, simulator or Glide(), brain or Brain(), timing, recorder, stop_on_collision=stop_on_collision
    )


def decision(arrived):
    return Decision(
        Twist(0.0), PoseEstimate(Pose(0.0, 0.0), np.zeros((3, 3))), Pose(0.0, 0.0), None, arrived, (), NO_TIME
    )


def test_a_drive_to_the_goal_is_recorded_step_by_step():
    record = episode()
    assert record.meta["outcome"] == "goal_reached"
    assert np.allclose(record["stamp"], 0.1 * np.arange(len(record["stamp"])))
    assert record["pose"][-1, 0] == pytest.approx(1.2, abs=1e-6)
    assert np.isnan(record["command"][-1]).all()
    assert (record["command"][:-1] == (1.0, 0.0, 0.0)).all()


def test_a_robot_that_does_not_move_runs_out_of_time():
    record = episode(Brain(Twist(0.0)), problem=replace(scenario(), time_limit=2.0))
    assert (record.meta["outcome"], record["stamp"][-1]) == ("time_out", pytest.approx(2.0))


def test_an_exception_of_the_navigator_ends_the_episode_and_what_was_recorded_is_kept():
    record = episode(Brain(error=ValueError("lost my way")))
    assert (record.meta["outcome"], record.meta["error"]) == ("error", "ValueError: lost my way")
    assert len(record["stamp"]) == 11
    assert np.isnan(record["estimate"][-1]).all()


def test_a_collision_ends_an_episode_only_when_asked_to():
    simulator = Glide()
    simulator.contacts = (TOUCH,)
    assert episode(simulator=simulator).meta["outcome"] == "goal_reached"
    assert episode(simulator=simulator, stop_on_collision=True).meta["outcome"] == "collision"


@pytest.mark.parametrize(("latency", "ticks"), [(0.0, 0), (0.02, 1), (0.03, 2), (0.1, 5), (0.25, 13)])
def test_a_late_command_lets_the_robot_stand_meanwhile(latency, ticks):
    simulator = Glide()
    episode(simulator=simulator, timing=Timing("latency", latency, 1.0))
    assert simulator.commands[: ticks + 1] == [[0.0, 0.0, 0.0]] * ticks + [[1.0, 0.0, 0.0]]


def test_measured_timing_is_late_by_the_time_really_taken():
    simulator = Glide()
    episode(Brain(seconds=0.05), simulator, Timing("measured", 0.0, 1.0))
    assert simulator.commands[:4] == [[0.0, 0.0, 0.0]] * 3 + [[1.0, 0.0, 0.0]]


def test_a_slower_computer_is_later_in_proportion():
    simulator = Glide()
    episode(Brain(seconds=0.01), simulator, Timing("measured", 0.0, 8.0))
    assert simulator.commands[:5] == [[0.0, 0.0, 0.0]] * 4 + [[1.0, 0.0, 0.0]]


def test_ideal_timing_ignores_the_time_taken():
    assert Timing("ideal", 0.3, 1.0).delay(replace(decision(False), spent=Spent(9.0, 9.0, 9.0))) == 0.0


def test_wall_time_is_no_part_of_the_record():
    fast, slow = episode(Brain(seconds=0.0)), episode(Brain(seconds=1.0))
    assert all(np.array_equal(fast[name], slow[name], equal_nan=True) for name in fast.arrays)
    assert fast.meta == slow.meta
    assert slow.timing["navigator_seconds"].tolist() == [1.0] * (len(slow["stamp"]) - 1)
    assert slow.timing["planner_seconds"].tolist() == [0.5] * (len(slow["stamp"]) - 1)


def test_the_navigator_is_told_start_goal_and_map_of_the_scenario_unless_the_world_is_unknown():
    known, unknown = Brain(), Brain()
    problem = scenario()
    episode(known, problem=problem)
    episode(unknown, problem=replace(problem, world=replace(problem.world, known=False)))
    assert (known.mission.start, known.mission.goal, known.mission.goal_radius) == (problem.start, problem.goal, 0.3)
    assert known.mission.map is problem.world.grid
    assert unknown.mission.map is None
    assert math.isfinite(known.mission.seed)
