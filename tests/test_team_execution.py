"""The episode of a team: each robot is judged by itself, and who is through stands as a body."""

from dataclasses import replace

import numpy as np
import pytest

from arena_core import Pose, PoseEstimate, Twist
from arena_core.loop.navigator import NO_TIME, Decision
from arena_core.loop.recording import Recorder
from arena_core.loop.team_execution import TeamRules, TeamSeat, run_team
from arena_core.tasks import Member
from arena_core.testing import component, robot, scenario
from arena_core.testing.samples import IDEAL


class Brain:
    """A navigator that always says the same and stops at the goal, or raises an error after a second."""

    control_period = 0.1
    robot = robot()
    privileged = ()

    def __init__(self, command, error=None):
        self.command, self.error, self.heard = command, error, []

    def reset(self, mission, truth=None):
        self.mission = mission

    def rehearse(self, sensors):
        pass

    def notes(self):
        return {}

    def decide(self, sensors):
        self.heard.append([(one.sender, one.stamp, one.pose.x) for one in sensors.heard])
        if self.error and sensors.stamp > 0.95:
            raise self.error
        arrived = sensors.reference.distance(self.mission.goal) <= self.mission.goal_radius
        estimate = PoseEstimate(sensors.reference, np.zeros((3, 3)))
        return Decision(self.command, estimate, self.mission.goal, None, arrived, (), NO_TIME)


def side_by_side(*ways):
    """Return a scenario with a robot for each (start x, goal x), 1 m beside each other, headed along x."""
    poses = [(Pose(a, -1.0 * k), Pose(b, -1.0 * k)) for k, (a, b) in enumerate(ways)]
    mates = tuple(Member(f"robot{k}", *way) for k, way in enumerate(poses[1:], 1))
    return replace(scenario(start=poses[0][0], goal=poses[0][1]), time_limit=20.0, team=mates)


def drive(problem, *brains, stop_on_collision=False, communication=None):
    simulator = component("simulator", "sim2d", [], robot=robot(), pedestrians=component("pedestrians", "none", []))
    seats = [
        TeamSeat(brain, Recorder(problem.seen_by(k), robot(), {"columns": {}}), "brain")
        for k, brain in enumerate(brains)
    ]
    return run_team(problem, simulator, seats, TeamRules(IDEAL, stop_on_collision, communication))


def outcomes(records):
    return [record.meta["outcome"] for record in records]


def test_each_robot_arrives_by_itself_and_the_others_drive_on():
    near, far = drive(side_by_side((-2.0, 0.0), (-2.0, 2.0)), Brain(Twist(0.4)), Brain(Twist(0.4)))
    assert outcomes([near, far]) == ["goal_reached", "goal_reached"]
    assert near["stamp"][-1] < far["stamp"][-1]
    assert near["pose"][-1, 1] == pytest.approx(0.0, abs=1e-9)
    assert far["pose"][-1, 1] == pytest.approx(-1.0, abs=1e-9)


def test_who_has_arrived_brakes_and_stands():
    near, far = drive(side_by_side((-2.0, 0.0), (-2.0, 2.0)), Brain(Twist(0.4)), Brain(Twist(0.4)))
    track, stamps = far["team_pose"][:, 0], far["team_stamp"]
    after = track[stamps > near["stamp"][-1] + 1.0]
    assert np.ptp(after, axis=0).max() == 0.0
    assert 0.0 <= after[0, 0] - near["pose"][-1, 0] < 0.2  # the braking distance


def test_all_records_say_where_the_whole_team_was_until_the_last_was_through():
    records = drive(side_by_side((-2.0, 0.0), (-2.0, 2.0)), Brain(Twist(0.4)), Brain(Twist(0.4)))
    assert [record.meta["team"]["member"] for record in records] == [0, 1]
    for record in records:
        assert np.array_equal(record["team_pose"], records[0]["team_pose"])
        assert record["team_stamp"][-1] == records[1]["stamp"][-1]
        told = record.meta["team"]["robots"]
        assert [one["end"] for one in told] == [float(own["stamp"][-1]) for own in records]
        member, own = record.meta["team"]["member"], record["pose"]
        assert np.abs(record["team_pose"][: len(own), member] - own).max() < 1e-4


def test_a_planner_that_dies_stops_its_robot_alone():
    dead, alive = drive(
        side_by_side((-2.0, 2.0), (-2.0, 2.0)), Brain(Twist(0.4), error=RuntimeError("no more")), Brain(Twist(0.4))
    )
    assert outcomes([dead, alive]) == ["error", "goal_reached"]
    assert "RuntimeError: no more" in dead.meta["error"]
    assert dead["stamp"][-1] == pytest.approx(1.0)
    ends = alive["team_pose"][-1, 0] - dead["pose"][-1]
    assert 0.0 <= ends[0] < 0.2


def test_a_planner_that_dies_at_its_reset_leaves_the_others_their_episode():
    class Stillborn(Brain):
        def reset(self, mission, truth=None):
            raise RuntimeError("not today")

    dead, alive = drive(side_by_side((-2.0, 2.0), (-2.0, 0.0)), Stillborn(Twist(0.4)), Brain(Twist(0.4)))
    assert outcomes([dead, alive]) == ["error", "goal_reached"]
    assert len(dead["stamp"]) == 1


def test_robots_that_cross_collide_and_with_stop_on_collision_both_are_through():
    problem = side_by_side((-1.0, 1.0), (1.0, -1.0))
    mate = replace(problem.team[0], start=Pose(1.0, 0.0, np.pi), goal=Pose(-1.0, 0.0))
    records = drive(replace(problem, team=(mate,)), Brain(Twist(0.4)), Brain(Twist(0.4)), stop_on_collision=True)
    assert outcomes(records) == ["collision", "collision"]
    assert [record["contact_kind"].tolist() for record in records] == [[3], [3]]
    assert [record["contact_person"].tolist() for record in records] == [[1], [0]]


def test_the_first_robot_of_a_team_has_the_streams_that_it_has_alone():
    problem = side_by_side((-2.0, 0.0), (-2.0, 2.0))
    assert problem.seen_by(0).name == problem.name
    assert problem.seen_by(1).name != problem.name
    assert problem.seen_by(1).start == problem.team[0].start


def test_robots_hear_of_each_other_a_step_later_and_of_none_that_is_through():
    radio = component("communication", "broadcast", ["communication.loss=0", "communication.memory=0.3"])
    near, far = Brain(Twist(0.4)), Brain(Twist(0.4))
    ended, track = drive(side_by_side((-2.0, -1.5), (-2.0, 0.0)), near, far, communication=radio)
    poses = track["team_pose"][:, 0, 0]
    assert (near.heard[0], far.heard[0]) == ([], [])
    assert far.heard[3] == [(0, pytest.approx(0.2), pytest.approx(poses[2], abs=1e-4))]
    last = len(ended["stamp"]) - 1  # at which the first robot has arrived, and tells nothing any more
    assert [len(heard) for heard in far.heard[last : last + 4]] == [1, 1, 1, 0]


def test_without_communication_nothing_is_heard():
    brains = Brain(Twist(0.4)), Brain(Twist(0.4))
    drive(side_by_side((-2.0, -1.5), (-2.0, -1.5)), *brains)
    assert not any(heard for brain in brains for heard in brain.heard)
