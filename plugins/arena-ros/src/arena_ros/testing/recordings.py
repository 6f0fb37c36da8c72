"""Recordings of a laboratory as long as one likes, written message by message, and what importing one takes."""

from __future__ import annotations

import math
import os
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from arena_core import LaserScan, Pose, Twist
from arena_ros import conversions as to
from arena_ros.bags.exporting import GOAL, open_writer
from arena_ros.codec import PEOPLE, Codec, get_codec

RATE = 20  # Hz of everything but pictures
PICTURES = 10  # Hz
LAP = 30.0  # s from goal to goal
RADIUS, SPEED = 3.0, 0.5  # m, m/s: round and round
BEAMS = 360
BEGIN = 1000 * 10**9  # ns
IMPORT = """
import sys, time
from pathlib import Path
from arena_ros.bags.importing import Request, import_bags, reading_of
begin, used = time.perf_counter(), time.process_time()
reading = reading_of(0.1, 0.3, 180.0, 0.3, "")
import_bags([Path(sys.argv[1])], Path(sys.argv[2]), Request({}, "jackal", "recorded", None, False, reading))
print(time.perf_counter() - begin, time.process_time() - used)
"""


@dataclass(frozen=True, slots=True)
class ImportCost:
    """What an import took: s of wall and of CPU time, s of wall time with its
    process, and the most memory of that, MB.
    """

    seconds: float
    cpu_seconds: float
    whole_seconds: float
    megabytes: float


def write_laboratory(path: Path, seconds: float, picture: int = 0) -> Path:
    """Write a robot that drives in circles past five people; pictures of so many bytes come beside. Return the file."""
    own = get_codec(1 if path.suffix == ".bag" else 2)
    noise = np.random.default_rng(0).integers(0, 256, picture, np.uint8)
    with open_writer(path, own) as write:
        write("/tf_static", to.TF, BEGIN, to.transforms_msg(own, [("base_link", "laser", Pose(0.1, 0.0))], BEGIN))
        for tick in range(round(seconds * RATE)):
            stamp = BEGIN + tick * 10**9 // RATE
            _write_step(own, write, tick, stamp)
            if picture and tick % (RATE // PICTURES) == 0:
                write("/camera", "sensor_msgs/msg/CompressedImage", stamp, _make_picture(own, noise, stamp))
    return next(iter(path.glob(f"*{path.suffix}"))) if path.is_dir() else path


def _write_step(own: Codec, write: Any, tick: int, stamp: int) -> None:
    angle = SPEED / RADIUS * tick / RATE
    pose = Pose(RADIUS * math.cos(angle), RADIUS * math.sin(angle), angle + math.pi / 2)
    if tick % round(LAP * RATE) == 0:
        ahead = angle + SPEED / RADIUS * 0.9 * LAP
        goal = Pose(RADIUS * math.cos(ahead), RADIUS * math.sin(ahead))
        write(GOAL[own.ros], to.POSE_STAMPED, stamp, to.pose_stamped_msg(own, goal, stamp, "map"))
    write(
        "/tf",
        to.TF,
        stamp,
        to.transforms_msg(own, [("map", "odom", Pose(0.0, 0.2)), ("odom", "base_link", pose)], stamp),
    )
    write(
        "/odom",
        to.ODOMETRY,
        stamp,
        to.odometry_msg(own, pose, Twist(SPEED, 0.0, SPEED / RADIUS), to.Header(stamp, "odom"), "base_link"),
    )
    write("/cmd_vel", to.TWIST, stamp, to.twist_msg(own, Twist(SPEED, 0.0, SPEED / RADIUS)))
    ranges = (4.0 + np.sin(np.arange(BEAMS) * 0.1 + tick * 0.01)).astype(np.float32)
    write(
        "/scan",
        to.SCAN,
        stamp,
        to.scan_msg(
            own, LaserScan(0.0, 0.0, math.tau / BEAMS, 0.1, 30.0, ranges, Pose(0.0, 0.0)), stamp, "laser", 0.05
        ),
    )
    places = np.stack((np.arange(5.0), np.full(5, 5.0 + 0.001 * (tick % 1000))), axis=1)
    write("/people", PEOPLE, stamp, to.people_msg(own, range(5), places, np.zeros((5, 2)), to.Header(stamp, "map")))


def _make_picture(own: Codec, noise: Any, stamp: int) -> Any:
    return own.make("sensor_msgs/msg/CompressedImage", header=own.header(stamp, "camera"), format="jpeg", data=noise)


def import_apart(bag: Path, out: Path) -> ImportCost:
    """Import a recording in a process of its own."""
    begin = time.perf_counter()
    process = subprocess.Popen(  # noqa: S603 - words of this file
        [sys.executable, "-c", IMPORT, str(bag), str(out)], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
    )
    assert process.stdout is not None
    with process.stdout:
        said = process.stdout.read()
    _, status, used = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    assert process.returncode == 0, said
    seconds, cpu_seconds = map(float, said.split())
    return ImportCost(seconds, cpu_seconds, time.perf_counter() - begin, used.ru_maxrss / 1e3)
