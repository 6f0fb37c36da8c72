"""Tests of driving a simulated robot in another process: to its goal, stopped, lost, and killed."""

from __future__ import annotations

import signal
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from subprocess import Popen
from typing import ClassVar

import numpy as np

from arena_core.records import read_record
from arena_ros import conversions as to
from arena_ros.testing.bystanders import Probe
from arena_ros.testing.processes import ARENA, another_publisher, done, running, said, until
from arena_ros.testing.site import GOAL, START, world


@contextmanager
def robot(transport: str, site: Path, log: Path, *words: str) -> Iterator[Popen[str]]:
    """Have a robot on the air within the block."""
    with running(ARENA, "ros", "simulate", f"transport={transport}", *world(site), *words, log=log) as process:
        until(lambda: "on the air" in log.read_text() or process.poll() is not None, 120.0)
        yield process


def drive(transport: str, site: Path, out: Path, *words: str, goal: bool = True) -> list[str]:
    """Return the words that drive it."""
    where = [f"map={site}/map.yaml", "start={},{},{}".format(*START), f"out={out}", *(["goal={},{}".format(*GOAL)] * goal)]
    return [ARENA, "ros", "drive", f"transport={transport}", "planner=pure_pursuit", "robot=jackal", *where, *words]


class DriveTests:
    """Facts of ``arena ros drive`` and ``arena ros watchdog``; the tests of a transport derive from it and bring ``site`` and ``probe``."""

    transport: ClassVar[str]

    def test_a_robot_in_another_process_is_driven_to_its_goal(self, site: Path, probe: Probe, tmp_path: Path) -> None:
        keeps = ["recording.scans=true", "recording.tracks=true", "recording.considered=true"]
        with robot(self.transport, site, tmp_path / "robot.txt"):
            ended = done(*drive(self.transport, site, tmp_path / "run", *keeps))
        assert ended.returncode == 0, ended.stdout + ended.stderr
        record = read_record(tmp_path / "run" / "records" / "0000.npz")
        assert record.meta["outcome"] == "goal_reached"
        assert record.meta["truth"] == "estimated"
        np.testing.assert_allclose(record["pose"][-1, :2], GOAL, atol=0.4)  # where it believed to be
        assert abs(probe.xs[-1] - GOAL[0]) < 0.6  # where it was
        assert probe.speed() < 0.05  # and there it stands
        assert np.diff(record["command"][:-1, 0]).max() <= 20.0 * 0.1 + 1e-6
        assert len(record["scan_ranges"]) == len(record["stamp"]) - 1
        assert len(record["track_rows"]) == len(record["considered_rows"]) == len(record["stamp"])

    def test_a_pose_from_elsewhere_counts_as_true(self, site: Path, probe: Probe, tmp_path: Path) -> None:
        with robot(self.transport, site, tmp_path / "robot.txt"):
            ended = done(*drive(self.transport, site, tmp_path / "run", "pose=/ground_truth"))
        assert ended.returncode == 0, ended.stdout + ended.stderr
        record = read_record(tmp_path / "run" / "records" / "0000.npz")
        assert record.meta["truth"] == "reference"
        np.testing.assert_allclose(record["pose"][0, :2], START[:2], atol=0.2)

    def test_killed_driver_leaves_a_robot_that_stands_within_half_a_second(self, site: Path, probe: Probe, tmp_path: Path) -> None:
        watch, log = [ARENA, "ros", "watchdog", f"transport={self.transport}"], tmp_path / "watch.txt"
        with robot(self.transport, site, tmp_path / "robot.txt"), running(*watch, log=log):
            until(said(log, "watching"), 60.0)
            with running(*drive(self.transport, site, tmp_path / "run", "cmd_vel=/arena/cmd_vel")) as driver:
                until(lambda: probe.speed() > 0.4, 120.0)
                driver.kill()
                killed = time.monotonic()
                until(lambda: probe.speeds[-1][0] > killed + 1.0, 20.0)
        moving = [stamp for stamp, speed in probe.speeds if killed < stamp < killed + 1.0 and speed > 0.01]
        assert max(moving, default=killed) - killed <= 0.5

    def test_sigterm_stops_the_robot_and_keeps_the_record(self, site: Path, probe: Probe, tmp_path: Path) -> None:
        log = tmp_path / "drive.txt"
        with (
            robot(self.transport, site, tmp_path / "robot.txt"),
            running(*drive(self.transport, site, tmp_path / "run", "speed=0.25"), log=log) as driver,
        ):
            until(lambda: probe.speed() > 0.4, 120.0)
            driver.terminate()
            assert driver.wait(30) == 1, log.read_text()
            until(lambda: probe.speed() < 0.01, 5.0)
        record = read_record(tmp_path / "run" / "records" / "0000.npz")
        assert (record.meta["outcome"], record.meta["error"]) == ("error", "stopped by SIGTERM")
        assert abs(record["pose"][-1, 0] - probe.xs[-1]) < 0.5  # at half a metre a second

    def test_a_robot_that_does_not_answer_is_sent_zeros(self, site: Path, probe: Probe, tmp_path: Path) -> None:
        log = tmp_path / "drive.txt"
        with (
            robot(self.transport, site, tmp_path / "robot.txt") as asleep,
            running(*drive(self.transport, site, tmp_path / "run"), log=log) as driver,
        ):
            until(lambda: probe.speed() > 0.4, 120.0)
            asleep.send_signal(signal.SIGSTOP)
            stopped = time.monotonic()
            until(lambda: probe.commands[-1][0] > stopped + 1.5, 10.0)
            late = [value for stamp, value in probe.commands if stamp > stopped + 0.9]
            assert late
            assert not any(late)
            asleep.send_signal(signal.SIGCONT)  # it goes on where it can again
            assert driver.wait(60) == 0, log.read_text()
        record = read_record(tmp_path / "run" / "records" / "0000.npz")
        assert "safety_stop" in {event["kind"] for event in record.meta["events"]}

    def test_a_dry_run_moves_nothing(self, site: Path, probe: Probe, tmp_path: Path) -> None:
        log = tmp_path / "drive.txt"
        with (
            robot(self.transport, site, tmp_path / "robot.txt"),
            running(*drive(self.transport, site, tmp_path / "run", "--dry-run"), log=log) as driver,
        ):
            until(lambda: "/arena/dry_run/cmd_vel" in probe.node.topics(), 120.0)
            time.sleep(2.0)
            assert driver.poll() is None
            assert probe.speed() < 0.01

    def test_what_is_missing_or_of_another_type_is_one_line(self, site: Path, probe: Probe, tmp_path: Path) -> None:
        nothing = done(*drive(self.transport, site, tmp_path / "a", "patience=1"))
        assert nothing.returncode == 2
        assert "no scan of use on /scan within 1 s; published are" in nothing.stderr.splitlines()[-1]
        with another_publisher(self.transport, "/scan", to.TEXT, tmp_path / "other.txt"):
            typed = done(*drive(self.transport, site, tmp_path / "b", "patience=1"))
        assert typed.returncode == 2
        assert "/scan is a std_msgs/msg/String; allowed: sensor_msgs/msg/LaserScan" in typed.stderr.splitlines()[-1]
