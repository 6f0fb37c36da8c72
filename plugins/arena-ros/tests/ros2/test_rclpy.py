"""Nodes of rclpy, with Fast DDS, beside ours that speak DDS by Cyclone: driven, relayed, asked as a planner."""

from __future__ import annotations

import sys
import time
from pathlib import Path

import pytest

from arena_core.records import read_record
from arena_ros.testing import ARENA, RobotProbe, run_process, wait_until, world_overrides, write_site
from arena_ros.testing.drives import LATE, drive_command, run_robot
from arena_ros.testing.processes import has_printed, run_to_end
from arena_ros2.dds import Dds

pytestmark = [pytest.mark.ros2, pytest.mark.usefixtures("wheels_of_ros2")]
ENDLESS = "1000000000"  # steps


@pytest.fixture
def site(tmp_path: Path) -> Path:
    """A room, and a problem in it."""
    return write_site(tmp_path)


def test_ros2_is_rclpy_where_rclpy_is() -> None:
    asked = (
        "from arena_ros.transport import open_transport as o; node = o('ros2', 'who'); "
        "print(type(node).__name__); node.close()"
    )
    ended = run_to_end(sys.executable, "-c", asked)
    assert ended.stdout == "Rclpy\n", ended.stderr


@pytest.mark.parametrize(("of_robot", "of_driver"), [("ros2-rclpy", "ros2-dds"), ("ros2-dds", "ros2-rclpy")])
def test_a_robot_is_driven_by_a_node_of_another_make(site: Path, of_robot: str, of_driver: str) -> None:
    with run_robot(of_robot, site, site / "robot.txt"):
        ended = run_to_end(*drive_command(of_driver, site, site / "run", "patience=60"))
    assert ended.returncode == 0, ended.stdout + ended.stderr
    assert read_record(site / "run" / "records" / "0000.npz").meta["outcome"] == "goal_reached"


def test_killed_driver_leaves_a_robot_that_is_told_to_stand_and_stands(site: Path) -> None:
    probe = RobotProbe(Dds("probe"))
    watch = [ARENA, "ros", "watchdog", "transport=ros2-rclpy"]
    with run_robot("ros2-rclpy", site, site / "robot.txt"), run_process(*watch, log=site / "watch.txt"):
        wait_until(has_printed(site / "watch.txt", "watching"), 60.0)
        with run_process(
            *drive_command("ros2-rclpy", site, site / "run", "patience=60", "cmd_vel=/arena/cmd_vel"),
            log=site / "drive.txt",
        ) as driver:
            wait_until(lambda: probe.speed() > 0.4, 120.0)
            driver.kill()
            killed = time.monotonic()
            wait_until(lambda: probe.commands[-1][1] == 0.0 and probe.speed() < 0.01, 20.0)
    probe.node.close()
    told = next(stamp for stamp, speed in probe.commands if stamp > killed and speed == 0.0)
    assert told - killed <= LATE


def test_a_node_of_rclpy_is_a_planner(site: Path) -> None:
    node = [sys.executable, str(Path(__file__).with_name("rclpy_follower.py")), ENDLESS]
    rest = ["episodes=1", "executor=serial", "report=false", f"hydra.run.dir={site}/run", "planner.transport=ros2-dds"]
    with run_process(*node, log=site / "node.txt"):
        run = [ARENA, "run", "planner=ros_external", *world_overrides(site), *rest]
        ended = run_to_end(*run)
    assert ended.returncode == 0, ended.stdout + ended.stderr + (site / "node.txt").read_text()
    assert read_record(site / "run" / "records" / "0000.npz").meta["outcome"] == "goal_reached"
