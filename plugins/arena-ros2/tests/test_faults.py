"""What can go wrong with a robot on the air: it stands, a line says why, the record keeps it, and driving goes on where it can."""

from __future__ import annotations

import os
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from arena_core import Pose, read_record
from arena_core.cli.main import main
from arena_ros import conversions as to
from arena_ros.live.guard import Guard
from arena_ros2.dds import Dds

pytestmark = pytest.mark.slow
SCAN, ODOMETRY, POSE = "stopped: no scan of use on /scan", "stopped: no odometry of use on /odom", "stopped: no pose on /tf"


@pytest.fixture(scope="module")
def domain() -> Iterator[None]:
    """A domain of its own, on this machine alone."""
    before = dict(os.environ)
    os.environ |= {"ROS_DOMAIN_ID": str(100 + (os.getpid() + 50) % 100), "ROS_LOCALHOST_ONLY": "1"}
    yield
    os.environ.clear()
    os.environ |= before


@pytest.fixture
def site(tmp_path: Path) -> Path:
    """A room of 10 m by 6 m."""
    cells = np.full((120, 200), 254, np.uint8)
    cells[[0, -1]] = cells[:, [0, -1]] = 0
    (tmp_path / "map.pgm").write_bytes(b"P5\n200 120\n255\n" + cells.tobytes())
    figures = "image: map.pgm\nresolution: 0.05\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"
    (tmp_path / "map.yaml").write_text(figures)
    return tmp_path


def drive(site: Path, *words: str, patience: str = "60") -> int:
    where = [f"map={site}/map.yaml", "goal=8.5,3", f"out={site}/run", "speed=0.25", f"patience={patience}", "overrun=5"]
    return main(["ros", "drive", "transport=ros2-dds", "planner=pure_pursuit", "robot=jackal", *where, *words])


def reasons(site: Path) -> str:
    record = read_record(site / "run" / "records" / "0000.npz")
    return str([event for event in record.meta["events"] if event["kind"] == "safety_stop"])


def test_each_fault_of_a_sensor_is_a_stop_with_its_reason(site: Path, domain: None, puppet: Any) -> None:
    faults = [("scans of NaN", SCAN), ("a scan that stays the same", SCAN), ("rubbish on /scan", SCAN), ("nothing on /scan", SCAN)]
    faults += [("odometry of NaN", ODOMETRY), ("rubbish on /odom", ODOMETRY)]
    faults += [("nothing on /tf", POSE), ("tf of NaN", POSE), ("tf of another frame", POSE)]
    puppet.face(faults)
    with puppet:
        assert drive(site, "pose=/tf") == 0
        assert puppet.faced == [fault for fault, _ in faults]
        assert puppet.command.vx == 0.0
    kept = reasons(site)
    assert "no scan of use" in kept
    assert "no odometry of use" in kept
    assert "no pose" in kept


def test_stamps_that_jump_by_an_hour_change_nothing(site: Path, domain: None, puppet: Any) -> None:
    puppet.fault = "the clock jumps"
    with puppet:
        assert drive(site, "pose=/tf") == 0


def test_a_robot_with_two_masters_stands(site: Path, domain: None, puppet: Any) -> None:
    others: list[Dds] = []

    def join(fault: str) -> None:
        if fault:
            others.append(Dds("joystick"))
            others[0].publisher("/cmd_vel", to.TWIST)
        else:
            others.pop().close()

    puppet.face([("another master", "publishes /cmd_vel, too")], join)
    with puppet:
        assert drive(site, "pose=/tf") == 0
        assert puppet.faced == ["another master"]
    assert "publishes /cmd_vel, too" in reasons(site)


def test_a_planner_that_hangs_leaves_a_robot_that_stands(site: Path, domain: None, puppet: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    from arena_pure_pursuit import PurePursuit

    usual, hung = PurePursuit.compute_velocity, []

    def hang(self: Any, observation: Any) -> Any:
        if not hung and puppet.command.vx > 0.1:
            end = time.monotonic() + 60.0
            while puppet.command.vx != 0.0 and time.monotonic() < end:
                time.sleep(0.01)
            hung.append(puppet.command.vx)
        return usual(self, observation)

    monkeypatch.setattr(PurePursuit, "compute_velocity", hang)
    with puppet:
        assert drive(site, "pose=/tf") == 0
    assert hung == [0.0]
    assert "a control step took" in reasons(site)


def test_a_pose_in_a_foreign_frame_is_one_line(site: Path, domain: None, puppet: Any, capsys: pytest.CaptureFixture[str]) -> None:
    from arena_ros.codec import codec

    own, node, over = codec(2), Dds("camera"), threading.Event()
    send = node.publisher("/mocap/pose", to.POSE_STAMPED)
    message = own.encode(to.pose_stamped(own, Pose(1.0, 1.0), 1, "camera"), to.POSE_STAMPED)

    def see() -> None:
        while not over.wait(0.1):
            send(message)

    camera = threading.Thread(target=see, daemon=True)
    camera.start()
    with puppet:
        assert drive(site, "pose=/mocap/pose", patience="10") == 2
    over.set()
    camera.join()
    node.close()
    said = capsys.readouterr().err
    assert "/mocap/pose is in the frame camera and does not count; allowed: map" in said
    assert "no pose on /mocap/pose within 10 s" in said.splitlines()[-1]


def test_guard_is_quiet_before_the_first_command_and_after_the_last() -> None:
    stops: list[float] = []
    with Guard(lambda: stops.append(time.monotonic()), 0.05, None) as guard:
        time.sleep(0.2)
        assert not stops
        guard.sent()
        while not stops:
            time.sleep(0.01)
        guard.rest()
        time.sleep(0.1)
        count = len(stops)
        time.sleep(0.2)
        assert len(stops) == count
