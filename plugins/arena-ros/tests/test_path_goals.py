"""When a path of Nav2's FollowPath is given up, without a ROS."""

from types import SimpleNamespace

import numpy as np
import pytest

from arena_core import ConfigurationError, Pose
from arena_core.hosting import build_benchmark, compose, load_registry
from arena_ros import conversions as to
from arena_ros.action_protocol import GoalStatus, ReceivedGoal
from arena_ros.codec import get_codec
from arena_ros.live.nav2_goals import action_type
from arena_ros.live.path_goals import FOLLOW_PATH, NO_COMMAND, Checkers, PathGoals, PluginNames
from arena_ros.transport import Transport

CODEC = get_codec(2)
CHECKERS = Checkers(failure_tolerance=0.3, progress_radius=0.5, progress_time=10.0, sensor_timeout=3.0)
TURNED = Pose(1.0, 2.0, np.pi / 2)


class Air(Transport):
    """A transport on which a test is the only other node."""

    ros = 2

    def __init__(self, node="test"):
        self.send = None

    def publisher(self, topic, type, *, latched=False):
        return lambda content: None

    def subscribe(self, topic, type, heard, *, latched=False):
        pass

    def topics(self):
        return {}

    def rivals(self, topic):
        return []

    def serve_action(self, name, type, heard):
        self.send = heard

    def close(self):
        pass


class Asked(ReceivedGoal):
    """A goal that notes what becomes of it."""

    is_cancelled = False

    def __init__(self, points, frame="map", **fields):
        names = {"controller_id": "", "goal_checker_id": "", "progress_checker_id": ""} | fields
        path = to.path_msg(CODEC, np.array([[*point, 0.0] for point in points]).reshape(-1, 3), 0, frame)
        self.request = CODEC.make(f"{FOLLOW_PATH}_Goal", path=path, **names)
        self.ends = []

    def publish_feedback(self, message):
        self.feedback = message

    def end(self, status, result):
        self.ends.append((status, result.error_code))


@pytest.fixture(scope="module")
def navigator():
    words = ["planner=pure_pursuit", "robot=jackal", "world=empty", "localizer=ground_truth"]
    return build_benchmark(compose(words), load_registry()).navigator


@pytest.fixture
def goals(navigator):
    air = Air()
    goals = PathGoals(air, "/follow_path", PluginNames(["FollowPath"], ["goal"], ["progress"]), CHECKERS, navigator)
    goals.odom = lambda: ("odom", TURNED)
    goals.send = air.send
    return goals


def decision(x=0.0, *kinds):
    events = [SimpleNamespace(kind=kind) for kind in kinds]
    return SimpleNamespace(events=events, compiled=False, estimate=SimpleNamespace(pose=Pose(x, 0.0)))


def begin(goals, asked):
    goals.send(asked)
    return goals.take()


def test_a_path_in_the_frame_of_odometry_leads_to_where_that_is_in_the_map(goals):
    goal = begin(goals, Asked([(0.0, 0.0), (3.0, 0.0)], "odom"))
    np.testing.assert_allclose(goal.array(), [1.0, 5.0, np.pi / 2])


def test_a_planner_without_a_valid_command_is_given_up_after_a_while(goals):
    asked = Asked([(0.0, 0.0), (3.0, 0.0)])
    begin(goals, asked)
    assert goals.judge(decision(0.0), 1.0) == ""
    assert goals.judge(decision(0.0, NO_COMMAND), 1.2) == ""
    said = goals.judge(decision(0.0, NO_COMMAND), 1.4)
    assert said == "no valid command for 0.4 s"
    goals.end(said, reached=False)
    assert asked.ends == [(GoalStatus.ABORTED, 104)]


def test_progress_is_half_a_metre_in_ten_seconds(goals):
    asked = Asked([(0.0, 0.0), (3.0, 0.0)])
    begin(goals, asked)
    steps = [(0.0, 0.0), (9.0, 0.6), (18.9, 0.6), (19.1, 1.0)]
    said = [goals.judge(decision(x), stamp) for stamp, x in steps]
    assert said == ["", "", "", "within 0.5 m for 10 s"]
    goals.end(said[-1], reached=False)
    assert asked.ends == [(GoalStatus.ABORTED, 105)]


@pytest.mark.parametrize(("fault", "code"), [("no pose on /tf", 102), ("no scan of use on /scan", 107)])
def test_a_sensor_that_stays_away_ends_the_path(goals, fault, code):
    asked = Asked([(0.0, 0.0), (3.0, 0.0)])
    begin(goals, asked)
    assert [goals.stall(fault, stamp) for stamp in (1.0, 3.9, 4.0)] == ["", "", fault]
    goals.end(fault, reached=False)
    assert asked.ends == [(GoalStatus.ABORTED, code)]


def test_a_sensor_that_comes_back_begins_its_time_anew(goals):
    begin(goals, Asked([(0.0, 0.0), (3.0, 0.0)]))
    assert goals.stall("no scan", 1.0) == ""
    goals.judge(decision(0.0), 3.0)
    assert goals.stall("no scan", 5.0) == ""


def test_of_paths_that_came_together_the_last_one_counts(goals):
    older, newer = Asked([(0.0, 0.0), (3.0, 0.0)]), Asked([(0.0, 0.0), (0.0, 3.0)])
    goals.send(older)
    assert begin(goals, newer).y == 3.0
    assert (older.ends, newer.ends) == ([(GoalStatus.ABORTED, 0)], [])


@pytest.mark.parametrize(
    ("asked", "code"),
    [
        (Asked([]), 103),
        (Asked([(0.0, 0.0), (np.nan, 0.0)]), 103),
        (Asked([(0.0, 0.0)]), 103),
        (Asked([(0.0, 0.0), (1.0, 0.0)], "moon"), 102),
        (Asked([(0.0, 0.0), (1.0, 0.0)], controller_id="Nobody"), 101),
        (Asked([(0.0, 0.0), (1.0, 0.0)], progress_checker_id="Nobody"), 100),
    ],
)
def test_a_path_that_cannot_be_followed_is_answered_at_once(goals, asked, code):
    assert begin(goals, asked) is None
    assert asked.ends == [(GoalStatus.ABORTED, code)]


def test_an_action_that_is_none_of_nav2_is_refused():
    assert action_type("/robot/follow_path") == FOLLOW_PATH
    with pytest.raises(
        ConfigurationError, match="action is /move_base; allowed in ROS 2: a name that ends in follow_path"
    ):
        action_type("/move_base")


def test_actions_need_a_transport_that_has_them():
    with pytest.raises(
        ConfigurationError, match=r"/follow_path cannot be asked by Air; allowed .*transport=ros2-rclpy"
    ):
        Air().send_goals("/follow_path", FOLLOW_PATH, lambda: None)
