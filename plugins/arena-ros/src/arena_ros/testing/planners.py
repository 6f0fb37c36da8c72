"""Tests of a ROS node as a planner of an ordinary run, in lock-step."""

from __future__ import annotations

from abc import ABC, abstractmethod
from pathlib import Path
from typing import ClassVar

import numpy as np

from arena_core.records import read_record
from arena_ros.testing.processes import ARENA, run_process, run_to_end
from arena_ros.testing.site import world_overrides


class PlannerTests(ABC):
    """Facts of ``planner=ros_external``; the tests of a transport derive from it and bring ``site`` and
    ``air``: something to meet on.
    """

    transport: ClassVar[str]

    @abstractmethod
    def follower(self, steps: int | None = None) -> list[str]:
        """Return the words that start a node which drives to waypoints, and falls silent after so many steps."""

    def run(self, site: Path, out: Path, *words: str) -> list[str]:
        """Return the words of a run whose planner is the node."""
        rest = [
            "episodes=1",
            "executor=serial",
            "report=false",
            f"hydra.run.dir={out}",
            f"planner.transport={self.transport}",
        ]
        return [ARENA, "run", "planner=ros_external", *world_overrides(site), *rest, *words]

    def test_a_ros_node_is_a_planner_and_repeats_itself_bit_for_bit(
        self, site: Path, air: None, tmp_path: Path
    ) -> None:
        for name in ("a", "b"):
            with run_process(*self.follower(), log=tmp_path / "node.txt"):
                ended = run_to_end(*self.run(site, tmp_path / name))
                assert ended.returncode == 0, ended.stdout + ended.stderr + (tmp_path / "node.txt").read_text()
        first, second = (read_record(tmp_path / name / "records" / "0000.npz") for name in ("a", "b"))
        assert first.meta["outcome"] == "goal_reached"
        for name, array in first.arrays.items():
            np.testing.assert_array_equal(second[name], array, err_msg=name)
        assert (first.timing["planner_seconds"] > 0.0).all()

    def test_a_node_that_falls_silent_is_an_error_with_its_record(self, site: Path, air: None, tmp_path: Path) -> None:
        with run_process(*self.follower(30)):
            ended = run_to_end(*self.run(site, tmp_path / "run", "planner.budget=0.5"))
        assert ended.returncode == 1, ended.stdout + ended.stderr
        record = read_record(tmp_path / "run" / "records" / "0000.npz")
        assert record.meta["outcome"] == "error"
        assert "no command on /cmd_vel for this step within 0.5 s" in record.meta["error"]
        assert len(record["stamp"]) > 10
