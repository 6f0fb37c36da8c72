"""A robot in another process, at a master in a third: driven, stopped, lost, and killed; and a
node of rospy as a planner.
"""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from arena_ros.testing import DriveTests, FaultTests, PlannerTests
from arena_ros.testing.drives import drive_command
from arena_ros.testing.processes import run_to_end
from arena_ros1.transport import Ros1

pytestmark = [pytest.mark.ros1, pytest.mark.filterwarnings("ignore")]  # rospy leaves sockets to be collected
ENDLESS = 10**9  # steps


def test_several_threads_may_ask_the_master(node: Ros1) -> None:
    with ThreadPoolExecutor(4) as threads:
        rivals = [threads.submit(node.rivals, "/rosout") for _ in range(100)]
        published = [threads.submit(node.topics) for _ in range(100)]
    assert all(asked.result() == [] for asked in rivals)
    assert all("/rosout" not in asked.result() for asked in published)


class TestDriving(DriveTests):
    transport = "ros1"

    def test_no_master_is_one_line(self, site: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setenv("ROS_MASTER_URI", "http://127.0.0.1:1")
        ended = run_to_end(*drive_command(self.transport, site, tmp_path / "run"))
        assert ended.returncode == 2
        assert "no ROS master at http://127.0.0.1:1" in ended.stderr.splitlines()[-1]


class TestFaults(FaultTests):
    transport = "ros1"


class TestPlanners(PlannerTests):
    transport = "ros1"

    def follower(self, steps: int | None = None) -> list[str]:
        return [
            "/usr/bin/python3",
            str(Path(__file__).with_name("follower.py")),
            str(ENDLESS if steps is None else steps),
        ]
