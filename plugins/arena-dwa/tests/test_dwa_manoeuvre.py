import math

import numpy as np
import pytest

from arena_core import NoValidCommand, Pose, Twist
from arena_core.testing import component
from arena_dwa.entrance import fitting_poses
from arena_dwa.manoeuvre import PATIENCE, STEP, Manoeuvre, path_segments
from arena_dwa.settings import BodyOnWindow
from arena_kernels.costmap_window import window_of

GAP = (1.0, 1.2, 0.22, 3.1), (1.0, 1.2, -3.1, -0.22)  # 0.45 m wide, about the x axis
PATH = [(0.05 * k, 0.0) for k in range(51)]
AWAY = [(-x, y) for x, y in PATH]


def drive(planner, robot, observe, costmap, path, pose, steps):
    """Return the poses (N, 3) and commands (N, 3) of a car that does at once what it is told; a refusal stops it."""
    twist, poses, commands = Twist(0.0), [], []
    for k in range(steps):
        try:
            twist = planner.compute_velocity(observe(costmap, pose, path, twist, 0.1 * k))
        except NoValidCommand:
            twist = Twist(0.0)
        assert abs(twist.wz) <= abs(twist.vx) / robot.turn_radius + 1e-9
        middle = Pose(0.0, 0.0, 0.05 * twist.wz).compose(Pose(0.1 * twist.vx, 0.0))
        pose = pose.compose(Pose(middle.x, middle.y, 0.1 * twist.wz))
        poses.append(pose.array())
        commands.append(twist.array())
        if math.hypot(pose.x - path[-1][0], pose.y - path[-1][1]) < 0.5:
            break
    return np.array(poses), np.array(commands)


@pytest.fixture(scope="module")
def car():
    return component("robot", "jackal_ackermann")


@pytest.mark.parametrize("start", [Pose(0.78, -0.23, 1.0), Pose(0.7, 0.25, -1.0), Pose(0.72, -0.35, 1.3)])
def test_a_car_that_comes_obliquely_to_a_gap_gets_through(build, observe, costmap, car, start):
    poses, _ = drive(build("jackal_ackermann"), car, observe, costmap(*GAP), PATH, start, 250)
    assert poses[-1, 0] > 1.9


def test_a_car_with_its_path_behind_it_turns_round_and_drives_there_forwards(build, observe, costmap, car):
    poses, commands = drive(
        build("jackal_ackermann"), car, observe, costmap((2.9, 3.0, 2.9, 3.0)), AWAY, Pose(0.0, 0.0, 0.0), 200
    )
    assert poses[-1, 0] < -1.9
    assert commands[-5:, 0].min() > 0.0
    assert math.cos(poses[-1, 2]) < -0.8


def test_as_released_a_car_knows_no_way_out(build, observe, costmap, car):
    planner = build("jackal_ackermann", "dwa_as_released")
    drive(planner, car, observe, costmap(*GAP), PATH, Pose(0.78, -0.23, 1.0), 60)
    assert not planner._way_out.is_active


def test_ends_lie_in_the_narrow_place_and_fit(build, costmap):
    body = build("jackal_ackermann")._own.body._replace(padding=0.005)
    path, none = np.column_stack((PATH, np.zeros(51))), np.zeros(1)
    for gear, heading in ((1.0, 0.0), (-1.0, math.pi)):
        ends = fitting_poses(
            BodyOnWindow(window_of(costmap(*GAP)), body),
            path,
            (0.6, 0.0),
            gear,
            np.linspace(-0.6, 0.6, 25),
            np.linspace(-0.06, 0.06, 7),
        )
        assert len(ends) > 1
        assert np.cos(ends[:, 2] - heading).min() > 0.8
        assert 0.8 < ends[:, 0].min() <= ends[:, 0].max() < 1.2
        assert ends[:, 3].min() >= 0.005
    assert (
        len(
            fitting_poses(
                BodyOnWindow(window_of(costmap((1.0, 1.2, -3.1, 3.1))), body), path, (0.6, 0.0), 1.0, none, none
            )
        )
        == 0
    )


def test_legs_part_where_the_car_changes_its_direction():
    found = path_segments(Pose(1.0, 2.0, 0.5), np.array(((-0.4, 2.0), (0.3, 1.0), (0.2, 0.0), (0.0, -1.0))))
    assert [sign for sign, _ in found] == [-1.0, 1.0]
    assert [len(leg) for _, leg in found] == [40, 50]
    steps = np.hypot(*np.diff(np.vstack([leg for _, leg in found])[:, :2], axis=0).T)
    assert steps == pytest.approx(STEP, rel=0.01)
    assert found[0][1][-1, 2] == pytest.approx(0.5 - 0.8)
    assert found[1][1][-1, 2] == pytest.approx(0.5 - 0.8 + 0.3)


def test_a_car_waits_a_while_for_what_stands_in_its_way(build):
    manoeuvre = Manoeuvre(0.005, build("jackal_ackermann")._own.limits)
    ahead = np.array((0.3, 0.0, 0.1))
    assert manoeuvre.hold_if_blocked(5.0, ahead, free=True) is ahead
    assert manoeuvre.hold_if_blocked(5.0 + 0.9 * PATIENCE, ahead, free=False).tolist() == [0.0, 0.0, 0.0]
    assert manoeuvre.hold_if_blocked(5.0 + 1.1 * PATIENCE, ahead, free=False) is None
