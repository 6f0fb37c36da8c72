from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from arena_core import run as run_benchmark
from arena_ros import conversions as to
from arena_ros.bags.exporting import open_writer
from arena_ros.codec import PEOPLE, get_codec

pytest.register_assert_rewrite("arena_ros.testing")  # here first: others who use it find it as they want it

SECOND = 10**9


@pytest.fixture(scope="session")
def finished_run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run of two short episodes among people, with scans."""
    words = [
        "planner=pure_pursuit",
        "robot=jackal",
        "world=empty",
        "world.width=8",
        "world.height=8",
        "task=random",
        "task.pedestrians=3",
    ]
    rest = ["episodes=2", "recording.scans=true", "executor=serial", "report=false"]
    folder: Path = run_benchmark([*words, *rest], tmp_path_factory.mktemp("run") / "run")[0].folder
    return folder


def _write_recording(
    path: Path, goals: list[tuple[float, float, float]], seconds: float = 10.0, people: bool = True
) -> Path:
    """Write a robot that drives along x at 0.5 m/s from 0, its odometry 0.2 m behind in y, a wall 5 m ahead of the
    start.

    ``goals``: when (s), x and y. A person stands at (2, 2).
    """
    own = get_codec(1 if path.suffix == ".bag" else 2)
    goal_topic = "/move_base_simple/goal" if own.ros == 1 else "/goal_pose"
    begin, pending = 1000 * SECOND, list(goals)
    with open_writer(path, own) as write:
        write("/tf_static", to.TF, begin, to.transforms_msg(own, [("base_link", "laser", to.Pose(0.1, 0.0))], begin))
        for tick in range(int(seconds * 20) + 1):
            stamp, x = begin + tick * SECOND // 20, 0.5 * tick / 20
            while pending and pending[0][0] * SECOND <= stamp - begin:
                _, gx, gy = pending.pop(0)
                write(goal_topic, to.POSE_STAMPED, stamp, to.pose_stamped_msg(own, to.Pose(gx, gy), stamp, "map"))
            write("/tf", to.TF, stamp, to.transforms_msg(own, [("map", "odom", to.Pose(0.0, 0.2))], stamp))
            odometry = to.odometry_msg(own, to.Pose(x, -0.2), to.Twist(0.5), to.Header(stamp, "odom"), "base_link")
            write("/odom", to.ODOMETRY, stamp, odometry)
            write("/cmd_vel", to.TWIST, stamp, to.twist_msg(own, to.Twist(0.5)))
            if tick % 2 == 0:
                ranges = np.full(8, np.inf, np.float32)
                ranges[0] = 5.0 - x - 0.1
                ranges[3] = np.nan
                scan = to.LaserScan(0.0, 0.0, np.pi / 4, 0.1, 30.0, ranges, to.Pose(0.0, 0.0))
                write("/scan", to.SCAN, stamp, to.scan_msg(own, scan, stamp, "laser", 0.1))
                if people:
                    seen = to.people_msg(own, [7], np.array([[2.0, 2.0]]), np.zeros((1, 2)), to.Header(stamp, "map"))
                    write("/people", PEOPLE, stamp, seen)
    return next(iter(path.glob(f"*{path.suffix}"))) if path.is_dir() else path


@pytest.fixture(scope="session")
def write_recording() -> Callable[..., Path]:
    """Return what writes a recording of a robot that drives straight on."""
    return _write_recording
