import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from arena_core import Contact, Crowd, Pose, PoseEstimate, Simulator, Snapshot, Twist
from arena_core.execution import CommandQueue, Timing, joined, judge, run_episode
from arena_core.navigator import NO_TIME, Decision, Spent
from arena_core.recording import Recorder
from arena_core.testing import robot, scan, scenario
from arena_core.testing.samples import IDEAL

AHEAD = Twist(1.0)
TOUCH = Contact(1.0, "wall", -1, 0.5, True, 0.0, 0.0)


class Glide(Simulator):
    """Moves one robot along x, at once as fast as it is told; nobody else is there."""

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
            *(stamps, poses, still, nobody, np.ones(1), np.full(1, np.inf), np.zeros(1, np.bool_), np.array((0.01 * ticks,))),
            *((self.contacts,), header.ranges[None], stamps, stamps, poses, still, header),
        )


class Brain:
    """A navigator that always says the same and stops at the goal."""

    control_period = 0.1

    def __init__(self, command=AHEAD, error=None, seconds=0.0):
        self.command, self.error, self.seconds = command, error, seconds

    def reset(self, mission):
        self.mission = mission

    def rehearse(self, sensors):
        pass

    def decide(self, sensors):
        if self.error and sensors.stamp > 0.95:
            raise self.error
        arrived = sensors.odometry.pose.distance(self.mission.goal) <= self.mission.goal_radius
        estimate = PoseEstimate(sensors.odometry.pose, np.zeros((3, 3)))
        return Decision(self.command, estimate, self.mission.goal, None, arrived, (), Spent(0.5 * self.seconds, 0.0, self.seconds))


def episode(brain=None, simulator=None, timing=IDEAL, problem=None, stop_on_collision=False):
    problem = problem or scenario()
    recorder = Recorder(problem, robot(), {"columns": {}}, keep_scans=False)
    return run_episode(problem, simulator or Glide(), brain or Brain(), timing, recorder, stop_on_collision)


@given(steps=st.integers(1, 10), delays=st.lists(st.integers(0, 35), min_size=1, max_size=20))
def test_commands_act_when_their_delay_is_over_and_none_that_was_overtaken_comes_back(steps, delays):
    queue, acted = CommandQueue(), []
    for k, delay in enumerate(delays):
        queue.send(Twist(k + 1.0), k * steps + delay)
        acted += [command.vx for command, ticks in queue.segments(k * steps, (k + 1) * steps) for _ in range(ticks)]
    sent = [(k * steps, k * steps + delay) for k, delay in enumerate(delays)]
    due = [[k + 1.0 for k, (since, at) in enumerate(sent) if since <= tick and at <= tick] for tick in range(len(delays) * steps)]
    assert acted == [commands[-1] if commands else 0.0 for commands in due]


@given(begin=st.integers(0, 5), length=st.integers(1, 20), at=st.integers(0, 30))
def test_segments_are_never_empty_and_fill_the_interval(begin, length, at):
    queue = CommandQueue()
    queue.send(Twist(1.0), at)
    ticks = [n for _, n in queue.segments(begin, begin + length)]
    assert min(ticks) >= 1
    assert sum(ticks) == length


def decision(arrived):
    return Decision(Twist(0.0), PoseEstimate(Pose(0.0, 0.0), np.zeros((3, 3))), Pose(0.0, 0.0), None, arrived, (), NO_TIME)


@pytest.mark.parametrize(
    ("arrived", "x", "stamp", "contacts", "stop_on_collision", "outcome"),
    [
        (True, 1.5, 5.0, (), False, "goal_reached"),
        (True, 1.5 - 0.54, 5.0, (), False, "goal_reached"),
        (True, 1.5 - 0.56, 5.0, (), False, "false_arrival"),
        (True, 1.5, 60.0, (), False, "goal_reached"),
        (True, 1.5, 5.0, (TOUCH,), True, "goal_reached"),
        (False, 1.5, 5.0, (), False, None),
        (False, 0.0, 59.9, (), False, None),
        (False, 0.0, 60.0, (), False, "time_out"),
        (False, 0.0, 5.0, (TOUCH,), False, None),
        (False, 0.0, 5.0, (TOUCH,), True, "collision"),
        (False, 0.0, 60.0, (TOUCH,), True, "collision"),
    ],
)
def test_an_episode_ends_as_the_table_says(arrived, x, stamp, contacts, stop_on_collision, outcome):
    simulator = Glide()
    state = replace(simulator.reset([scenario()]).state(0), stamp=stamp, pose=Pose(x, 0.0), contacts=contacts)
    assert judge(scenario(), state, decision(arrived), stop_on_collision) == outcome


def test_joining_keeps_the_last_state_all_contacts_and_the_whole_time_in_contact():
    simulator = Glide()
    simulator.reset([scenario()])
    simulator.contacts = (TOUCH,)
    states = [simulator.advance(np.array(((1.0, 0.0, 0.0),)), n).state(0) for n in (2, 3)]
    whole = joined(states)
    assert (whole.pose, whole.stamp) == (states[1].pose, states[1].stamp)
    assert whole.contacts == (TOUCH, TOUCH)
    assert whole.contact_time == pytest.approx(0.05)
    assert joined(states[:1]) is states[0]


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
