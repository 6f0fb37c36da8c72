"""move_base's action, against Debian's actionlib: served while a robot is driven, and asked for where
another node is the planner.
"""

from __future__ import annotations

import signal
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from subprocess import Popen

import pytest

from arena_core.records import read_record
from arena_ros.testing import ARENA, RobotProbe, run_process, wait_until, world_overrides
from arena_ros.testing.drives import drive_command, run_robot
from arena_ros.testing.processes import has_printed, run_to_end
from arena_ros.testing.site import GOAL
from arena_ros1.transport import Ros1

pytestmark = [pytest.mark.ros1, pytest.mark.filterwarnings("ignore")]  # rospy leaves sockets to be collected
PYTHON = "/usr/bin/python3"
STOPS_WITHIN = 2.0**2 / (2.0 * 2.5)  # m, at full speed with what tyres hold


def sent(*words: object) -> list[str]:
    return run_to_end(PYTHON, str(Path(__file__).with_name("send_goal.py")), *map(str, words)).stdout.split()


@contextmanager
def driven(site: Path, folder: Path, *words: str) -> Iterator[Popen[str]]:
    """A robot that is driven to whatever goal comes."""
    log = folder / "drive.txt"
    with (
        run_robot("ros1", site, folder / "robot.txt"),
        run_process(*drive_command("ros1", site, folder / "run", *words, goal=False), log=log) as driver,
    ):
        yield driver


def test_goals_of_the_action_are_driven_to_and_answered(site: Path, probe: RobotProbe, tmp_path: Path) -> None:
    with driven(site, tmp_path) as driver:
        state, text, heard, x = sent(*GOAL)
        assert (state, text) == ("SUCCEEDED", "goal_reached")
        assert int(heard) > 10
        assert abs(float(x) - GOAL[0]) < 0.7
        assert abs(probe.xs[-1] - GOAL[0]) < 0.3 + STOPS_WITHIN
        assert sent(2.0, 3.0, "odom")[0] == "REJECTED"
        state, *text, _, _ = sent(2.0, 3.0, "map", 20)
        assert (state, " ".join(text)) == ("PREEMPTED", "the goal was cancelled")
        wait_until(lambda: probe.speed() < 0.01, 20.0)
        driver.send_signal(signal.SIGTERM)
        driver.wait(30)
    outcomes = [read_record(tmp_path / "run" / "records" / f"{k:04d}.npz").meta["error"] for k in range(2)]
    assert outcomes == ["", "the goal was cancelled"]


def test_goal_of_the_topic_takes_the_place_of_one_of_the_action(
    site: Path, probe: RobotProbe, node: Ros1, tmp_path: Path
) -> None:
    from arena_core import Pose
    from arena_ros import conversions as to
    from arena_ros.codec import get_codec

    own, send = get_codec(1), node.publisher("/move_base_simple/goal", to.POSE_STAMPED)
    log = tmp_path / "sender.txt"
    with (
        driven(site, tmp_path),
        run_process(PYTHON, str(Path(__file__).with_name("send_goal.py")), *map(str, GOAL), log=log) as sender,
    ):
        wait_until(lambda: probe.speed() > 0.3, 120.0)
        send(own.encode(to.pose_stamped_msg(own, Pose(2.0, 3.0), 1, "map"), to.POSE_STAMPED))
        sender.wait(60)
    assert log.read_text().startswith("PREEMPTED another goal came")


def run(site: Path, out: Path, episodes: int) -> list[str]:
    rest = [
        f"episodes={episodes}",
        "executor=serial",
        "report=false",
        f"hydra.run.dir={out}",
        "planner.transport=ros1",
        "planner.action=/move_base",
    ]
    return [
        ARENA,
        "run",
        "planner=ros_external",
        "planner.stamped=false",
        "planner.silence=0.3",
        *world_overrides(site),
        *rest,
    ]


@pytest.fixture
def simulated_time(node: Ros1) -> Iterator[None]:
    """Nodes that begin now live by the simulated clock."""
    import rospy

    rospy.set_param("/use_sim_time", True)
    yield
    rospy.delete_param("/use_sim_time")


def move_base(what: str, topic: str = "/odom") -> list[str]:
    return [PYTHON, str(Path(__file__).with_name("move_base.py")), what, topic]


def test_a_node_that_serves_the_action_is_a_planner(site: Path, simulated_time: None, tmp_path: Path) -> None:
    with run_process(*move_base("FOLLOW"), log=tmp_path / "node.txt"):
        ended = run_to_end(*run(site, tmp_path / "run", 2))
    assert ended.returncode == 0, ended.stdout + ended.stderr + (tmp_path / "node.txt").read_text()
    outcomes = [read_record(tmp_path / "run" / "records" / f"{k:04d}.npz").meta["outcome"] for k in range(2)]
    assert outcomes == ["goal_reached"] * 2


def test_a_node_that_gives_its_goal_up_is_an_error_that_says_so(
    site: Path, simulated_time: None, tmp_path: Path
) -> None:
    with run_process(*move_base("GIVE_UP"), log=tmp_path / "node.txt"):
        ended = run_to_end(*run(site, tmp_path / "run", 1))
    assert ended.returncode == 1, ended.stdout + ended.stderr + (tmp_path / "node.txt").read_text()
    record = read_record(tmp_path / "run" / "records" / "0000.npz")
    assert record.meta["error"].endswith("/move_base says aborted (no way)")


def test_a_simulated_robot_sends_its_goal_and_says_what_became_of_it(
    site: Path, simulated_time: None, probe: RobotProbe, tmp_path: Path
) -> None:
    log = tmp_path / "robot.txt"
    node = move_base("FOLLOW", "/ground_truth")
    with run_process(*node, log=tmp_path / "node.txt"), run_robot("ros1", site, log, "action=/move_base", "rate=3"):
        wait_until(has_printed(log, "straight/0000: /move_base says succeeded"), 60.0)
    assert abs(probe.xs[-1] - GOAL[0]) < 0.2
