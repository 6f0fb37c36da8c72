"""Nodes of rclpy, with Fast DDS, beside ours that speak DDS by Cyclone: driven, relayed, asked as a planner."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest

from arena_core import read_record
from arena_ros import conversions as to
from arena_ros.codec import codec
from arena_ros2.dds import Dds

pytestmark = pytest.mark.ros2
ARENA = str(Path(sys.executable).with_name("arena"))


@pytest.fixture
def site(tmp_path: Path) -> Path:
    """A room of 10 m by 6 m, and a problem in it: straight on for 7 m."""
    cells = np.full((120, 200), 254, np.uint8)
    cells[[0, -1]] = cells[:, [0, -1]] = 0
    (tmp_path / "map.pgm").write_bytes(b"P5\n200 120\n255\n" + cells.tobytes())
    figures = "image: map.pgm\nresolution: 0.05\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"
    (tmp_path / "map.yaml").write_text(figures)
    problem = {"name": "straight", "start": [1.5, 3.0, 0.0], "goal": [8.5, 3.0]}
    (tmp_path / "straight.json").write_text(json.dumps({"format": "arena-scenario", "version": 2, "scenarios": [problem]}))
    return tmp_path


@pytest.fixture(scope="module", autouse=True)
def domain() -> Iterator[None]:
    """A domain of its own, on this machine alone; processes that are started find the wheels of ROS 2, this one does not."""
    before, wheels = dict(os.environ), Path(sys.prefix) / "ros2"
    packages = wheels / "lib" / f"python{sys.version_info.major}.{sys.version_info.minor}" / "site-packages"
    libraries = [wheels / "lib", *wheels.glob("*.libs")]
    os.environ |= {"ROS_DOMAIN_ID": str(100 + os.getpid() % 100), "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"}
    os.environ |= {"PYTHONPATH": f"{packages}:{wheels}", "LD_LIBRARY_PATH": ":".join(map(str, libraries))}
    yield
    os.environ.clear()
    os.environ |= before


@contextmanager
def running(*words: str, log: Path) -> Iterator[subprocess.Popen[str]]:
    with log.open("w") as out:
        process = subprocess.Popen(words, stdout=out, stderr=subprocess.STDOUT, text=True)
        try:
            yield process
        finally:
            process.terminate()
            try:
                process.wait(60)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()


def until(condition, seconds: float) -> None:  # type: ignore[no-untyped-def]
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, "it did not come so far"
        time.sleep(0.01)


def world(site: Path) -> list[str]:
    return ["robot=jackal", "world=ros_map", f"world.path={site}/map.yaml", "task=scenario", f"task.path={site}/straight.json"]


@contextmanager
def robot(site: Path, transport: str) -> Iterator[None]:
    log = site / "robot.txt"
    with running(ARENA, "ros", "simulate", f"transport={transport}", *world(site), log=log) as process:
        until(lambda: "on the air" in log.read_text() or process.poll() is not None, 120.0)
        yield


def drive(site: Path, transport: str, *words: str) -> list[str]:
    where = [f"map={site}/map.yaml", "start=1.5,3,0", "goal=8.5,3", f"out={site}/run", "patience=60"]
    return [ARENA, "ros", "drive", f"transport={transport}", "planner=pure_pursuit", "robot=jackal", *where, *words]


def test_ros2_is_rclpy_where_rclpy_is() -> None:
    asked = "from arena_ros.transport import open_transport as o; node = o('ros2', 'who'); print(type(node).__name__); node.close()"
    done = subprocess.run([sys.executable, "-c", asked], capture_output=True, text=True, timeout=60)
    assert done.stdout == "Rclpy\n", done.stderr


@pytest.mark.parametrize(("of_robot", "of_driver"), [("ros2-rclpy", "ros2-dds"), ("ros2-dds", "ros2-rclpy")])
def test_a_robot_is_driven_by_a_node_of_another_make(site: Path, of_robot: str, of_driver: str) -> None:
    with robot(site, of_robot):
        done = subprocess.run(drive(site, of_driver), capture_output=True, text=True, timeout=240)
    assert done.returncode == 0, done.stdout + done.stderr
    assert read_record(site / "run" / "records" / "0000.npz").meta["outcome"] == "goal_reached"


def test_killed_driver_leaves_a_robot_that_stands_within_half_a_second(site: Path) -> None:
    speeds: list[tuple[float, float]] = []
    node = Dds("probe")

    def hear(content: bytes) -> None:
        speeds.append((time.monotonic(), codec(2).decode(content, to.ODOMETRY).twist.twist.linear.x))

    node.subscribe("/ground_truth", to.ODOMETRY, hear)
    watch = [ARENA, "ros", "watchdog", "transport=ros2-rclpy"]
    with robot(site, "ros2-rclpy"), running(*watch, log=site / "watch.txt"):
        until(lambda: "watching" in (site / "watch.txt").read_text(), 60.0)
        with running(*drive(site, "ros2-rclpy", "cmd_vel=/arena/cmd_vel"), log=site / "drive.txt") as driver:
            until(lambda: speeds and speeds[-1][1] > 0.4, 120.0)
            driver.kill()
            killed = time.monotonic()
            until(lambda: speeds[-1][0] > killed + 1.0, 20.0)
    node.close()
    moving = [stamp for stamp, speed in speeds if killed < stamp < killed + 1.0 and abs(speed) > 0.01]
    assert max(moving, default=killed) - killed <= 0.5


def test_a_node_of_rclpy_is_a_planner(site: Path) -> None:
    node = [sys.executable, str(Path(__file__).with_name("follower.py"))]
    rest = ["episodes=1", "executor=serial", "report=false", f"hydra.run.dir={site}/run", "planner.transport=ros2-dds"]
    with running(*node, log=site / "node.txt"):
        run = [ARENA, "run", "planner=ros_external", *world(site), *rest]
        done = subprocess.run(run, capture_output=True, text=True, timeout=240)
    assert done.returncode == 0, done.stdout + done.stderr + (site / "node.txt").read_text()
    assert read_record(site / "run" / "records" / "0000.npz").meta["outcome"] == "goal_reached"
