"""Tests of what can go wrong with a robot on the air: it stands, a line says why, the record keeps it, and
driving goes on where it can.
"""

from __future__ import annotations

import sys
import threading
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from subprocess import CompletedProcess
from typing import ClassVar

from arena_core import Pose
from arena_core.records import read_record
from arena_ros import conversions as to
from arena_ros.codec import get_codec
from arena_ros.testing.fake_robot import FakeRobot
from arena_ros.testing.processes import ARENA, another_publisher, run_to_end
from arena_ros.testing.site import GOAL
from arena_ros.transport import Transport

SCAN, ODOMETRY, POSE = (
    "stopped: no scan of use on /scan",
    "stopped: no odometry of use on /odom",
    "stopped: no pose on /tf",
)
FAULTS = {
    "scans of NaN": SCAN,
    "a scan that stays the same": SCAN,
    "rubbish on /scan": SCAN,
    "nothing on /scan": SCAN,
    "odometry of NaN": ODOMETRY,
    "rubbish on /odom": ODOMETRY,
    "nothing on /tf": POSE,
    "tf of NaN": POSE,
    "tf of another frame": POSE,
}
HANGS = """
import sys, time
from arena_core.cli.main import main
from arena_ros.live.views import Seen
usual, hung = Seen.compute_velocity, []
def hang(self, observation):
    if not hung and observation.twist.vx > 0.1:
        hung.append(True)
        time.sleep(3.0)
    return usual(self, observation)
Seen.compute_velocity = hang
sys.exit(main(sys.argv[1:]))
"""


class FaultTests:
    """Facts of ``arena ros drive``; the tests of a transport derive from it and
    bring ``site``, ``node`` and ``puppet``.
    """

    transport: ClassVar[str]

    def drive(self, site: Path, out: Path, *words: str, by: Sequence[str] = (ARENA,)) -> CompletedProcess[str]:
        """Drive the puppet to its goal, slowly, by a pose from elsewhere."""
        where = [
            f"map={site}/map.yaml",
            "goal={},{}".format(*GOAL),
            f"out={out}",
            "speed=0.25",
            "patience=60",
            "overrun=5",
        ]
        usual = [
            each
            for each in ("pose=/tf", *where)
            if each.partition("=")[0] not in [word.partition("=")[0] for word in words]
        ]
        return run_to_end(
            *by, "ros", "drive", f"transport={self.transport}", "planner=pure_pursuit", "robot=jackal", *usual, *words
        )

    def test_each_fault_of_a_sensor_is_a_stop_with_its_reason(
        self, site: Path, puppet: FakeRobot, tmp_path: Path
    ) -> None:
        with puppet.inject_faults(list(FAULTS.items())):
            ended = self.drive(site, tmp_path)
            assert ended.returncode == 0, ended.stdout + ended.stderr
            assert puppet.faced == list(FAULTS)
            assert puppet.command.vx == 0.0
        kept = stop_reasons(tmp_path)
        for fault in ("no scan of use", "no odometry of use", "no pose"):
            assert fault in kept

    def test_stamps_that_jump_by_an_hour_change_nothing(self, site: Path, puppet: FakeRobot, tmp_path: Path) -> None:
        puppet.fault = "the clock jumps"
        with puppet:
            ended = self.drive(site, tmp_path)
        assert ended.returncode == 0, ended.stdout + ended.stderr

    def test_a_robot_with_two_masters_stands(self, site: Path, puppet: FakeRobot, tmp_path: Path) -> None:
        others = ExitStack()

        def join(fault: str) -> None:
            if fault:
                others.enter_context(another_publisher(self.transport, "/cmd_vel", to.TWIST, tmp_path / "joystick.txt"))
            else:
                others.close()

        with others, puppet.inject_faults([("another master", "publishes /cmd_vel, too")], join):
            ended = self.drive(site, tmp_path)
            assert ended.returncode == 0, ended.stdout + ended.stderr
            assert puppet.faced == ["another master"]
        assert "publishes /cmd_vel, too" in stop_reasons(tmp_path)

    def test_a_planner_that_hangs_leaves_a_robot_that_stands(
        self, site: Path, puppet: FakeRobot, tmp_path: Path
    ) -> None:
        with puppet:
            ended = self.drive(site, tmp_path, by=(sys.executable, "-c", HANGS))
            assert ended.returncode == 0, ended.stdout + ended.stderr
            driven = [k for k, vx in enumerate(puppet.commands) if vx > 0.1]
            assert 0.0 in puppet.commands[driven[0] : driven[-1]]  # it stood, and went on
        assert "a control step took" in stop_reasons(tmp_path)

    def test_a_pose_in_a_foreign_frame_is_one_line(
        self, site: Path, node: Transport, puppet: FakeRobot, tmp_path: Path
    ) -> None:
        with publish_pose(node, "/mocap/pose", "camera"), puppet:
            ended = self.drive(site, tmp_path, "pose=/mocap/pose", "patience=10")
        assert ended.returncode == 2
        assert "/mocap/pose is in the frame camera and does not count; allowed: map" in ended.stderr
        assert "no pose on /mocap/pose within 10 s" in ended.stderr.splitlines()[-1]


def stop_reasons(run: Path) -> str:
    """Return why the robot stopped, as its record has it."""
    record = read_record(run / "records" / "0000.npz")
    return str([event for event in record.meta["events"] if event["kind"] == "safety_stop"])


@contextmanager
def publish_pose(node: Transport, topic: str, frame: str) -> Iterator[None]:
    """Send a pose in some frame ten times a second within the block."""
    own, over = get_codec(node.ros), threading.Event()
    send = node.publisher(topic, to.POSE_STAMPED)
    message = own.encode(to.pose_stamped_msg(own, Pose(1.0, 1.0), 1, frame), to.POSE_STAMPED)

    def see() -> None:
        while not over.wait(0.1):
            send(message)

    thread = threading.Thread(target=see, daemon=True)
    thread.start()
    try:
        yield
    finally:
        over.set()
        thread.join()
