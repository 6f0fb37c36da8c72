"""A robot in another process, over DDS: driven, stopped, lost, and killed."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

import numpy as np
import pytest

from arena_core import read_record
from arena_ros import conversions as to
from arena_ros.codec import codec
from arena_ros2.dds import Dds

pytestmark = pytest.mark.slow
ARENA = [str(Path(sys.executable).with_name("arena"))]


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A room of 10 m by 6 m, and a problem in it: straight on for 7 m."""
    folder = tmp_path_factory.mktemp("site")
    cells = np.full((120, 200), 254, np.uint8)
    cells[[0, -1]] = cells[:, [0, -1]] = 0
    (folder / "map.pgm").write_bytes(b"P5\n200 120\n255\n" + cells.tobytes())
    figures = "image: map.pgm\nresolution: 0.05\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"
    (folder / "map.yaml").write_text(figures)
    problem = {"name": "straight", "start": [1.5, 3.0, 0.0], "goal": [8.5, 3.0]}
    (folder / "straight.json").write_text(json.dumps({"format": "arena-scenario", "version": 2, "scenarios": [problem]}))
    return folder


@pytest.fixture(scope="module")
def domain() -> Iterator[None]:
    """A domain of its own, on this machine alone."""
    before = dict(os.environ)
    os.environ |= {"ROS_DOMAIN_ID": str(100 + os.getpid() % 100), "ROS_LOCALHOST_ONLY": "1"}
    yield
    os.environ.clear()
    os.environ |= before


class Probe:
    """What a bystander hears."""

    def __init__(self) -> None:
        self.node = Dds("probe")
        self.speeds: list[tuple[float, float]] = []
        self.xs: list[float] = []
        self.commands: list[tuple[float, float]] = []
        self.node.subscribe("/ground_truth", to.ODOMETRY, self._hear)
        self.node.subscribe("/cmd_vel", to.TWIST, self._hear_command)

    def _hear(self, content: bytes) -> None:
        message = codec(2).decode(content, to.ODOMETRY)
        self.speeds.append((time.monotonic(), abs(message.twist.twist.linear.x)))
        self.xs.append(message.pose.pose.position.x)

    def _hear_command(self, content: bytes) -> None:
        self.commands.append((time.monotonic(), codec(2).decode(content, to.TWIST).linear.x))

    def speed(self) -> float:
        return self.speeds[-1][1] if self.speeds else 0.0


@pytest.fixture(scope="module")
def probe(domain: None) -> Iterator[Probe]:
    found = Probe()
    yield found
    found.node.close()


@contextmanager
def running(*words: str, log: Path | None = None) -> Iterator[subprocess.Popen[str]]:
    with ExitStack() as stack:
        out = stack.enter_context(log.open("w")) if log else subprocess.DEVNULL
        process = subprocess.Popen(words, stdout=out, stderr=subprocess.STDOUT, text=True)  # type: ignore[call-overload]
        try:
            yield process
        finally:
            process.send_signal(signal.SIGCONT)
            process.terminate()
            try:
                process.wait(20)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()


def until(condition, seconds: float) -> None:  # type: ignore[no-untyped-def]
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, "it did not come so far"
        time.sleep(0.01)


@contextmanager
def robot(site: Path, log: Path) -> Iterator[subprocess.Popen[str]]:
    world = ["world=ros_map", f"world.path={site}/map.yaml", "task=scenario", f"task.path={site}/straight.json"]
    with running(*ARENA, "ros", "simulate", "transport=ros2-dds", "robot=jackal", *world, log=log) as process:
        until(lambda: "on the air" in log.read_text() or process.poll() is not None, 60.0)
        yield process


def drive(site: Path, out: Path, *words: str) -> list[str]:
    where = [f"map={site}/map.yaml", "start=1.5,3,0", "goal=8.5,3", f"out={out}"]
    return [*ARENA, "ros", "drive", "transport=ros2-dds", "planner=pure_pursuit", "robot=jackal", *where, *words]


def test_a_robot_in_another_process_is_driven_to_its_goal(site: Path, probe: Probe, tmp_path: Path) -> None:
    with robot(site, tmp_path / "robot.txt"):
        done = subprocess.run(drive(site, tmp_path / "run", "recording.scans=true"), capture_output=True, text=True, timeout=90)
    assert done.returncode == 0, done.stdout + done.stderr
    record = read_record(tmp_path / "run" / "records" / "0000.npz")
    assert record.meta["outcome"] == "goal_reached"
    assert record.meta["truth"] == "estimated"
    np.testing.assert_allclose(record["pose"][-1, :2], [8.5, 3.0], atol=0.4)  # where it believed to be
    assert abs(probe.xs[-1] - 8.5) < 0.6  # where it was
    assert probe.speed() < 0.05  # and there it stands
    assert np.diff(record["command"][:-1, 0]).max() <= 20.0 * 0.1 + 1e-6
    assert len(record["scan_ranges"]) == len(record["stamp"]) - 1


def test_a_pose_from_elsewhere_counts_as_true(site: Path, probe: Probe, tmp_path: Path) -> None:
    with robot(site, tmp_path / "robot.txt"):
        done = subprocess.run(drive(site, tmp_path / "run", "pose=/ground_truth"), capture_output=True, text=True, timeout=90)
    assert done.returncode == 0, done.stdout + done.stderr
    record = read_record(tmp_path / "run" / "records" / "0000.npz")
    assert record.meta["truth"] == "reference"
    np.testing.assert_allclose(record["pose"][0, :2], [1.5, 3.0], atol=0.2)


def test_killed_driver_leaves_a_robot_that_stands_within_half_a_second(site: Path, probe: Probe, tmp_path: Path) -> None:
    watch = [*ARENA, "ros", "watchdog", "transport=ros2-dds"]
    with robot(site, tmp_path / "robot.txt"), running(*watch, log=tmp_path / "watch.txt"):
        until(lambda: "watching" in (tmp_path / "watch.txt").read_text(), 30.0)
        with running(*drive(site, tmp_path / "run", "cmd_vel=/arena/cmd_vel")) as driver:
            until(lambda: probe.speed() > 0.4, 60.0)
            driver.kill()
            killed = time.monotonic()
            until(lambda: probe.speeds[-1][0] > killed + 1.0, 10.0)
    moving = [stamp for stamp, speed in probe.speeds if killed < stamp < killed + 1.0 and speed > 0.01]
    assert max(moving, default=killed) - killed <= 0.5


def test_sigterm_stops_the_robot_and_keeps_the_record(site: Path, probe: Probe, tmp_path: Path) -> None:
    with robot(site, tmp_path / "robot.txt"), running(*drive(site, tmp_path / "run"), log=tmp_path / "drive.txt") as driver:
        until(lambda: probe.speed() > 0.4, 60.0)
        driver.terminate()
        assert driver.wait(20) == 1, (tmp_path / "drive.txt").read_text()
        until(lambda: probe.speed() < 0.01, 5.0)
    record = read_record(tmp_path / "run" / "records" / "0000.npz")
    assert (record.meta["outcome"], record.meta["error"]) == ("error", "stopped by SIGTERM")
    assert abs(record["pose"][-1, 0] - probe.xs[-1]) < 0.3


def test_a_robot_that_does_not_answer_is_sent_zeros(site: Path, probe: Probe, tmp_path: Path) -> None:
    with robot(site, tmp_path / "robot.txt") as asleep, running(*drive(site, tmp_path / "run"), log=tmp_path / "drive.txt") as driver:
        until(lambda: probe.speed() > 0.4, 60.0)
        asleep.send_signal(signal.SIGSTOP)
        stopped = time.monotonic()
        until(lambda: probe.commands[-1][0] > stopped + 1.5, 10.0)
        late = [value for stamp, value in probe.commands if stamp > stopped + 0.9]
        assert late
        assert not any(late)
        asleep.send_signal(signal.SIGCONT)  # it goes on where it can again
        assert driver.wait(60) == 0, (tmp_path / "drive.txt").read_text()
    record = read_record(tmp_path / "run" / "records" / "0000.npz")
    assert "safety_stop" in {event["kind"] for event in record.meta["events"]}


def test_a_dry_run_moves_nothing(site: Path, probe: Probe, tmp_path: Path) -> None:
    with robot(site, tmp_path / "robot.txt"), running(*drive(site, tmp_path / "run", "--dry-run"), log=tmp_path / "drive.txt") as driver:
        until(lambda: "/arena/dry_run/cmd_vel" in probe.node.topics(), 60.0)
        time.sleep(2.0)
        assert driver.poll() is None
        assert probe.speed() < 0.01


def test_what_is_missing_or_of_another_type_is_one_line(site: Path, probe: Probe, tmp_path: Path) -> None:
    nothing = subprocess.run(drive(site, tmp_path / "a", "patience=1"), capture_output=True, text=True, timeout=60)
    assert nothing.returncode == 2
    assert "no scan of use on /scan within 1 s; published are" in nothing.stderr.splitlines()[-1]
    own = codec(2)
    wrong = probe.node.publisher("/scan", to.TEXT, latched=True)
    wrong(own.encode(to.text(own, "no scan"), to.TEXT))
    typed = subprocess.run(drive(site, tmp_path / "b", "patience=1"), capture_output=True, text=True, timeout=60)
    assert typed.returncode == 2
    assert "/scan is a std_msgs/msg/String; allowed: sensor_msgs/msg/LaserScan" in typed.stderr.splitlines()[-1]


def test_a_domain_that_cannot_be_is_one_line(site: Path, tmp_path: Path) -> None:
    somewhere = {**os.environ, "ROS_DOMAIN_ID": "nowhere"}
    done = subprocess.run(drive(site, tmp_path / "run"), capture_output=True, text=True, timeout=60, env=somewhere)
    assert done.returncode == 2
    assert "ROS_DOMAIN_ID is nowhere; allowed: 0 .. 232" in done.stderr.splitlines()[-1]


def follower(steps: str = "-") -> list[str]:
    return [sys.executable, str(Path(__file__).with_name("follower.py")), steps, os.environ["ROS_DOMAIN_ID"]]


def benchmark(site: Path, out: Path, *words: str) -> list[str]:
    world = ["world=ros_map", f"world.path={site}/map.yaml", "task=scenario", f"task.path={site}/straight.json"]
    rest = ["episodes=1", "executor=serial", "report=false", f"hydra.run.dir={out}", "planner.transport=ros2-dds"]
    return [*ARENA, "run", "planner=ros_external", "robot=jackal", *world, *rest, *words]


def test_a_ros_node_is_a_planner_and_repeats_itself_bit_for_bit(site: Path, domain: None, tmp_path: Path) -> None:
    for name in ("a", "b"):
        with running(*follower(), log=tmp_path / "node.txt"):
            began = time.monotonic()
            done = subprocess.run(benchmark(site, tmp_path / name), capture_output=True, text=True, timeout=120)
            assert done.returncode == 0, done.stdout + done.stderr
            assert time.monotonic() - began < 120.0
    first, second = (read_record(tmp_path / name / "records" / "0000.npz") for name in ("a", "b"))
    assert first.meta["outcome"] == "goal_reached"
    for name, array in first.arrays.items():
        np.testing.assert_array_equal(second[name], array, err_msg=name)
    assert (first.timing["planner_seconds"] > 0.0).all()


def test_a_node_that_falls_silent_is_an_error_with_its_record(site: Path, domain: None, tmp_path: Path) -> None:
    with running(*follower("30")):
        done = subprocess.run(benchmark(site, tmp_path / "run", "planner.budget=0.5"), capture_output=True, text=True, timeout=120)
    assert done.returncode == 1, done.stdout + done.stderr
    record = read_record(tmp_path / "run" / "records" / "0000.npz")
    assert record.meta["outcome"] == "error"
    assert "no command on /cmd_vel for this step within 0.5 s" in record.meta["error"]
    assert len(record["stamp"]) > 10
