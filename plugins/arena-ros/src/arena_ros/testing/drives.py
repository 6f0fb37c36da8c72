"""Tests of driving a simulated robot in another process: to its goal, stopped, lost, and killed."""

from __future__ import annotations

import signal
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from subprocess import Popen
from typing import ClassVar

import numpy as np

from arena_core.records import read_record
from arena_ros import conversions as to
from arena_ros.codec import get_codec
from arena_ros.testing.fake_robot import RobotProbe
from arena_ros.testing.processes import ARENA, another_publisher, has_printed, run_process, run_to_end, wait_until
from arena_ros.testing.site import GOAL, PAIR_Y, START, world_overrides
from arena_ros.transport import Transport

LATE = 2.0  # s: ten times what the watchdog waits, so that a busy machine does not count


@contextmanager
def run_robot(transport: str, site: Path, log: Path, *words: str, problem: str = "straight") -> Iterator[Popen[str]]:
    """Have a robot, or those of another problem, on the air within the block."""
    with run_process(
        ARENA, "ros", "simulate", f"transport={transport}", *world_overrides(site, problem), *words, log=log
    ) as process:
        wait_until(lambda: "on the air" in log.read_text() or process.poll() is not None, 120.0)
        yield process


def drive_command(
    transport: str, site: Path, out: Path, *words: str, goal: bool = True, y: float = START[1]
) -> list[str]:
    """Return the words that drive it straight on at ``y`` m."""
    where = [
        f"map={site}/map.yaml",
        f"start={START[0]},{y},{START[2]}",
        f"out={out}",
        *([f"goal={GOAL[0]},{y}"] * goal),
    ]
    return [ARENA, "ros", "drive", f"transport={transport}", "planner=pure_pursuit", "robot=jackal", *where, *words]


def _links_of(node: Transport, content: bytes) -> list[tuple[str, str]]:
    """Return the frames that a message of /tf links."""
    found = to.links_from_msg(get_codec(node.ros).decode(content, to.TF))
    return [(parent, child) for parent, child, _, _ in found]


class DriveTests:
    """Facts of ``arena ros drive`` and ``arena ros watchdog``; the tests of a transport derive from it and
    bring ``site`` and ``probe``.
    """

    transport: ClassVar[str]

    def test_a_robot_in_another_process_is_driven_to_its_goal(
        self, site: Path, probe: RobotProbe, tmp_path: Path
    ) -> None:
        keeps = ["recording.scans=true", "recording.tracks=true", "recording.considered=true"]
        with run_robot(self.transport, site, tmp_path / "robot.txt"):
            ended = run_to_end(*drive_command(self.transport, site, tmp_path / "run", *keeps))
            assert ended.returncode == 0, ended.stdout + ended.stderr
            wait_until(lambda: probe.speed() < 0.05, 20.0)  # it brakes, and there it stands
        record = read_record(tmp_path / "run" / "records" / "0000.npz")
        assert record.meta["outcome"] == "goal_reached"
        assert record.meta["truth"] == "estimated"
        np.testing.assert_allclose(record["pose"][-1, :2], GOAL, atol=0.4)  # where it believed to be
        assert abs(probe.xs[-1] - GOAL[0]) < 1.5  # where it stands: it brakes from up to 2 m/s, which takes 0.8 m
        assert np.diff(record["command"][:-1, 0]).max() <= 20.0 * 0.1 + 1e-6
        assert len(record["scan_ranges"]) == len(record["stamp"]) - 1
        assert len(record["track_rows"]) == len(record["considered_rows"]) == len(record["stamp"])

    def test_two_robots_of_a_team_are_driven_at_once_each_in_its_namespace(
        self, site: Path, probe: RobotProbe, tmp_path: Path
    ) -> None:
        links: set[tuple[str, str]] = set()
        probe.node.subscribe("/tf", to.TF, lambda content: links.update(_links_of(probe.node, content)))
        with run_robot(self.transport, site, tmp_path / "robots.txt", problem="pair"), ExitStack() as stack:
            for member, y in enumerate(PAIR_Y):
                words = drive_command(self.transport, site, tmp_path / f"run{member}", f"namespace=robot{member}", y=y)
                stack.enter_context(run_process(*words, log=tmp_path / f"drive{member}.txt"))
            for member in range(len(PAIR_Y)):
                wait_until(has_printed(tmp_path / f"drive{member}.txt", "driven_0000: "), 120.0)
        assert "/robot0, /robot1 are on the air" in (tmp_path / "robots.txt").read_text()
        records = [read_record(tmp_path / f"run{member}" / "records" / "0000.npz") for member in range(2)]
        assert [record.meta["outcome"] for record in records] == ["goal_reached", "goal_reached"]
        np.testing.assert_allclose([record["pose"][-1, 1] for record in records], PAIR_Y, atol=0.4)
        own_frames = {(f"robot{member}/odom", f"robot{member}/base_link") for member in range(2)}
        assert links == own_frames | {("map", "robot0/odom"), ("map", "robot1/odom")}

    def test_a_pose_from_elsewhere_counts_as_true(self, site: Path, probe: RobotProbe, tmp_path: Path) -> None:
        with run_robot(self.transport, site, tmp_path / "robot.txt"):
            ended = run_to_end(*drive_command(self.transport, site, tmp_path / "run", "pose=/ground_truth"))
        assert ended.returncode == 0, ended.stdout + ended.stderr
        record = read_record(tmp_path / "run" / "records" / "0000.npz")
        assert record.meta["truth"] == "reference"
        np.testing.assert_allclose(record["pose"][0, :2], START[:2], atol=0.2)

    def test_killed_driver_leaves_a_robot_that_is_told_to_stand_and_stands(
        self, site: Path, probe: RobotProbe, tmp_path: Path
    ) -> None:
        watch, log = [ARENA, "ros", "watchdog", f"transport={self.transport}"], tmp_path / "watch.txt"
        with run_robot(self.transport, site, tmp_path / "robot.txt"), run_process(*watch, log=log):
            wait_until(has_printed(log, "watching"), 60.0)
            with run_process(
                *drive_command(self.transport, site, tmp_path / "run", "cmd_vel=/arena/cmd_vel")
            ) as driver:
                wait_until(lambda: probe.speed() > 0.4, 120.0)
                driver.kill()
                killed = time.monotonic()
                wait_until(lambda: probe.commands[-1][1] == 0.0 and probe.speed() < 0.01, 20.0)
            told = next(stamp for stamp, speed in probe.commands if stamp > killed and speed == 0.0)
        assert told - killed <= LATE

    def test_sigterm_stops_the_robot_and_keeps_the_record(self, site: Path, probe: RobotProbe, tmp_path: Path) -> None:
        log = tmp_path / "drive.txt"
        with (
            run_robot(self.transport, site, tmp_path / "robot.txt"),
            run_process(*drive_command(self.transport, site, tmp_path / "run", "speed=0.25"), log=log) as driver,
        ):
            wait_until(lambda: probe.speed() > 0.4, 120.0)
            driver.terminate()
            assert driver.wait(30) == 1, log.read_text()
            wait_until(lambda: probe.speed() < 0.01, 20.0)
        record = read_record(tmp_path / "run" / "records" / "0000.npz")
        assert (record.meta["outcome"], record.meta["error"]) == ("error", "stopped by SIGTERM")
        assert abs(record["pose"][-1, 0] - probe.xs[-1]) < 0.5  # at half a metre a second

    def test_a_robot_that_does_not_answer_is_sent_zeros(self, site: Path, probe: RobotProbe, tmp_path: Path) -> None:
        log = tmp_path / "drive.txt"
        with (
            run_robot(self.transport, site, tmp_path / "robot.txt") as asleep,
            run_process(*drive_command(self.transport, site, tmp_path / "run"), log=log) as driver,
        ):
            wait_until(lambda: probe.speed() > 0.4, 120.0)
            asleep.send_signal(signal.SIGSTOP)
            stopped = time.monotonic()
            wait_until(lambda: probe.commands[-1][0] > stopped + LATE + 0.5, 20.0)
            late = [value for stamp, value in probe.commands if stamp > stopped + LATE]
            assert late
            assert not any(late)
            asleep.send_signal(signal.SIGCONT)  # it goes on where it can again
            assert driver.wait(60) == 0, log.read_text()
        record = read_record(tmp_path / "run" / "records" / "0000.npz")
        assert "safety_stop" in {event["kind"] for event in record.meta["events"]}

    def test_a_dry_run_moves_nothing(self, site: Path, probe: RobotProbe, tmp_path: Path) -> None:
        log = tmp_path / "drive.txt"
        with (
            run_robot(self.transport, site, tmp_path / "robot.txt"),
            run_process(*drive_command(self.transport, site, tmp_path / "run", "--dry-run"), log=log) as driver,
        ):
            wait_until(lambda: "/arena/dry_run/cmd_vel" in probe.node.topics(), 120.0)
            time.sleep(2.0)
            assert driver.poll() is None
            assert probe.speed() < 0.01

    def test_what_is_missing_or_of_another_type_is_one_line(
        self, site: Path, probe: RobotProbe, tmp_path: Path
    ) -> None:
        nothing = run_to_end(*drive_command(self.transport, site, tmp_path / "a", "patience=1"))
        assert nothing.returncode == 2
        assert "no scan of use on /scan within 1 s; published are" in nothing.stderr.splitlines()[-1]
        with another_publisher(self.transport, "/scan", to.TEXT, tmp_path / "other.txt"):
            typed = run_to_end(*drive_command(self.transport, site, tmp_path / "b", "patience=1"))
        assert typed.returncode == 2
        assert "/scan is a std_msgs/msg/String; allowed: sensor_msgs/msg/LaserScan" in typed.stderr.splitlines()[-1]
