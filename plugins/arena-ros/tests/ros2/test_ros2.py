"""A robot in another process, over DDS: driven, stopped, lost, and killed; and a node that speaks DDS as a planner."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import pytest

from arena_ros.testing import DriveTests, PlannerTests
from arena_ros.testing.drives import drive_command
from arena_ros.testing.processes import run_to_end

pytestmark = pytest.mark.slow
ENDLESS = 10**9  # steps


class TestDriving(DriveTests):
    transport = "ros2-dds"

    def test_a_domain_that_cannot_be_is_one_line(
        self, site: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        monkeypatch.setenv("ROS_DOMAIN_ID", "nowhere")
        ended = run_to_end(*drive_command(self.transport, site, tmp_path / "run"))
        assert ended.returncode == 2
        assert "ROS_DOMAIN_ID is nowhere; allowed: 0 .. 232" in ended.stderr.splitlines()[-1]


class TestPlanners(PlannerTests):
    transport = "ros2-dds"

    def follower(self, steps: int | None = None) -> list[str]:
        node = str(Path(__file__).with_name("follower.py"))
        return [sys.executable, node, str(ENDLESS if steps is None else steps), os.environ["ROS_DOMAIN_ID"]]
