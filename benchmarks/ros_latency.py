"""Measure a drive over ROS 2 (DDS, three processes): jitter of the control loop, and what lies beyond the planner.

The wire is measured apart: half of the way there and back of a scan that another process sends on as it came.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from arena_core import LaserScan, Pose
from arena_ros import conversions as to
from arena_ros.codec import get_codec
from arena_ros.testing import ARENA, run_process
from arena_ros2.dds import Dds

ROBOT = "jackal"
GOALS = (Pose(12.0, 3.0), Pose(2.0, 3.0))
STEP = 0.05  # s of a control step
ECHOES = 2000
ECHO = """
import time
from arena_ros import conversions as to
from arena_ros2.dds import Dds
node = Dds("echo")
back = node.publisher("/echo/back", to.SCAN)
node.subscribe("/echo/there", to.SCAN, back)
time.sleep(1e6)
"""


def wire_latency() -> tuple[float, float]:
    """Return median and p99 of one way of a scan of 360 beams, s."""
    own, node = get_codec(2), Dds("wire")
    came: list[float] = []
    scan = LaserScan(0.0, 0.0, 0.0175, 0.1, 30.0, np.full(360, 5.0, np.float32), Pose(0.0, 0.0))
    content = own.encode(to.scan_msg(own, scan, 0, "laser", 0.1), to.SCAN)
    send = node.publisher("/echo/there", to.SCAN)
    node.subscribe("/echo/back", to.SCAN, lambda content: came.append(time.perf_counter()))
    with (
        tempfile.TemporaryDirectory() as folder,
        run_process(sys.executable, "-c", ECHO, log=Path(folder) / "echo.txt"),
    ):
        while not came:
            send(content)
            time.sleep(0.1)
        ways = []
        for _ in range(ECHOES):
            came.clear()
            begin = time.perf_counter()
            send(content)
            while not came and time.perf_counter() - begin < 1.0:
                time.sleep(0.0001)
            if came:
                ways.append((came[0] - begin) / 2.0)
            time.sleep(0.005)
    node.close()
    return float(np.median(ways)), float(np.percentile(ways, 99))


def write_hall(folder: Path) -> None:
    """Write a hall of 14 m by 6 m with three pillars, and a problem in it."""
    cells = np.full((120, 280), 254, np.uint8)
    cells[[0, -1]] = cells[:, [0, -1]] = 0
    for x in (100, 150, 200):
        cells[54:66, x : x + 8] = 0
    (folder / "map.pgm").write_bytes(b"P5\n280 120\n255\n" + cells.tobytes())
    figures = (
        "image: map.pgm\nresolution: 0.05\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"
    )
    (folder / "map.yaml").write_text(figures)
    problem = {"name": "hall", "start": [2.0, 3.0, 0.0], "goal": [12.0, 3.0]}
    (folder / "hall.json").write_text(json.dumps({"format": "arena-scenario", "version": 2, "scenarios": [problem]}))


def drive_goals(seconds: float, planner: str, folder: Path) -> str:
    """Drive to and fro in the hall; return what the driver said at the end."""
    write_hall(folder)
    world = ["world=ros_map", f"world.path={folder}/map.yaml", "task=scenario", f"task.path={folder}/hall.json"]
    robot = [ARENA, "ros", "simulate", "transport=ros2-dds", f"robot={ROBOT}", *world]
    words = [
        f"planner={planner}",
        f"robot={ROBOT}",
        f"robot.control_period={STEP}",
        f"map={folder}/map.yaml",
        "start=2,3,0",
        "patience=120",
        f"out={folder}/run",
    ]
    own, node = get_codec(2), Dds("goals")
    send = node.publisher("/goal_pose", to.POSE_STAMPED)
    said: list[str] = []
    node.subscribe(
        "/arena/status", to.TEXT, lambda content: said.append(json.loads(own.decode(content, to.TEXT).data)["status"])
    )
    words = [ARENA, "ros", "drive", "transport=ros2-dds", *words]
    with run_process(*robot, log=folder / "robot.txt"), run_process(*words, log=folder / "drive.txt") as driver:
        end, count = time.monotonic() + seconds, 0
        while time.monotonic() < end and driver.poll() is None:
            if said and said[-1] == "waits for a goal":
                send(own.encode(to.pose_stamped_msg(own, GOALS[count % 2], time.time_ns(), "map"), to.POSE_STAMPED))
                said.clear()
                count += 1
            time.sleep(0.2)
    node.close()
    return (folder / "drive.txt").read_text()


def main() -> None:
    """Print the figures."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--minutes", type=float, default=10.0)
    parser.add_argument("--planner", default="teb")
    chosen = parser.parse_args()
    os.environ |= {"ROS_DOMAIN_ID": str(100 + os.getpid() % 100), "ROS_LOCALHOST_ONLY": "1"}
    median, slowest = wire_latency()
    print(
        f"one way of a scan: {1e3 * median:.2f} ms, p99 {1e3 * slowest:.2f} ms; load {os.getloadavg()[0]:.1f}",
        flush=True,
    )
    with tempfile.TemporaryDirectory() as folder:
        said = drive_goals(60.0 * chosen.minutes, chosen.planner, Path(folder))
    lines = said.splitlines()
    reached = sum("goal_reached" in line for line in lines)
    print(f"{reached} goals; " + next((line for line in lines if line.startswith("control steps")), said))
    print(
        f"load {', '.join(f'{each:.1f}' for each in os.getloadavg())} (1, 5, 15 minutes), {os.cpu_count()} hyperthreads"
    )


if __name__ == "__main__":
    main()
