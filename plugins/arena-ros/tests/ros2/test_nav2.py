"""Nav2's actions by rclpy: FollowPath served as controller_server does, and asked as a client of Nav2 does.

The other side is rclpy's own action client and server, in another process that knows nothing of this project.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from arena_core import EpisodeRecord
from arena_core.records import read_record
from arena_ros.testing import ARENA, run_process, wait_until, world_overrides, write_site
from arena_ros.testing.drives import run_robot
from arena_ros.testing.processes import has_printed, run_to_end
from arena_ros.testing.site import GOAL

pytestmark = [pytest.mark.ros2, pytest.mark.usefixtures("wheels_of_ros2")]
SUCCEEDED, CANCELED, ABORTED = "4", "5", "6"  # of action_msgs/GoalStatus
# of Nav2's FollowPath
NONE, UNKNOWN, INVALID_CONTROLLER, TF_ERROR, INVALID_PATH, NO_PROGRESS = "0", "100", "101", "102", "103", "105"
UNHURRIED = [
    f"{key}=30" for key in ("scan_age", "odometry_age", "pose_age", "sensor_timeout")
]  # a busy machine is no fault
TRANSPORT = "transport=ros2-rclpy"
BUDGET = 6  # s of wall time for a command: a server that is gone takes it whole


def node_command(name: str, *words: str) -> list[str]:
    return [sys.executable, str(Path(__file__).with_name(name)), *words]


def controller_command(site: Path, *words: str, pose: str = "/ground_truth") -> list[str]:
    where = [TRANSPORT, "planner=pure_pursuit", "robot=jackal", f"map={site}/map.yaml", f"pose={pose}"]
    return [ARENA, "ros", "controller", *where, "patience=120", *UNHURRIED, *words]


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A room, and a problem in it."""
    return write_site(tmp_path_factory.mktemp("nav2"))


@pytest.fixture(scope="class")
def controllers(place: Path, wheels_of_ros2: None) -> Iterator[None]:
    """A robot, a controller that drives it, and one whose velocities reach no robot; then the clock is free."""
    log, stuck = place / "controller.txt", place / "stuck.txt"
    without = ["cmd_vel=/nowhere", "action=/stuck", "progress_time=1", f"out={place}/stuck"]
    with (
        run_robot("ros2-rclpy", place, place / "robot.txt"),
        run_process(*controller_command(place, f"out={place}/followed"), log=log),
        run_process(*controller_command(place, *without), log=stuck),
    ):
        wait_until(lambda: has_printed(log, "following paths")() and has_printed(stuck, "following paths")(), 300.0)
        yield


@pytest.mark.usefixtures("controllers")
class TestServedPaths:
    """What a client is told of its paths."""

    def ask(self, *words: str) -> list[list[str]]:
        """Return what the client says of each goal: status, code, feedbacks, distances, speed, message."""
        ended = run_to_end(*node_command("path_client.py", *words))
        assert ended.returncode == 0, ended.stdout + ended.stderr
        return [line.split(maxsplit=6) for line in ended.stdout.splitlines()]

    def test_a_path_is_followed_to_its_end_with_feedback(self) -> None:
        ((status, code, heard, first, last, speed),) = self.ask("STRAIGHT", "controller_id=FollowPath")
        assert (status, code) == (SUCCEEDED, NONE)
        assert int(heard) > 10
        assert abs(float(first) - 7.0) < 0.5  # m
        assert float(last) < 1.0  # m
        assert (
            0.5 < float(speed) < 4.0
        )  # m/s, of a Jackal that drives 2, seen through a clock that a busy machine stretches

    def test_a_goal_is_cancelled(self) -> None:
        ((status, code, *_, text),) = self.ask("STRAIGHT", "CANCEL")
        assert (status, code, text) == (CANCELED, NONE, "the goal was cancelled")

    def test_a_newer_path_takes_the_place_of_the_older_one(self) -> None:
        older, newer = self.ask("STRAIGHT", "SIDE")
        assert (older[0], older[1], older[6]) == (ABORTED, NONE, "a newer path came")
        assert (newer[0], newer[1]) == (SUCCEEDED, NONE)

    def test_a_newer_path_that_cannot_be_followed_ends_the_older_one(self) -> None:
        older, newer = self.ask("STRAIGHT", "EMPTY")
        assert (older[0], older[1]) == (ABORTED, NONE)
        assert (newer[0], newer[1], newer[6]) == (ABORTED, INVALID_PATH, "the path is empty")

    def test_paths_that_are_none_are_refused(self) -> None:
        assert [each[:2] for each in self.ask("NAN", "POINT")] == [[ABORTED, INVALID_PATH]] * 2

    @pytest.mark.parametrize(
        ("word", "code", "said"),
        [
            ("controller_id=Nobody", INVALID_CONTROLLER, "controller_id is Nobody; allowed: FollowPath"),
            ("goal_checker_id=Nobody", UNKNOWN, "goal_checker_id is Nobody; allowed: "),
            ("FRAME=moon", TF_ERROR, "no transform leads from moon to map; allowed: map, odom"),
        ],
    )
    def test_what_is_not_known_is_said(self, word: str, code: str, said: str) -> None:
        ((status, given, *_, text),) = self.ask("STRAIGHT", word)
        assert (status, given) == (ABORTED, code)
        assert text.startswith(said)

    def test_a_robot_that_makes_no_progress_is_given_up(self) -> None:
        ((status, code, *_, text),) = self.ask("STRAIGHT", "ACTION=/stuck")
        assert (status, code, text) == (ABORTED, NO_PROGRESS, "within 0.5 m for 1 s")


def run_command(site: Path, folder: Path, action: str, *words: str) -> list[str]:
    own = [f"planner.{TRANSPORT}", f"planner.action=/{action}", "planner.patience=120", f"hydra.run.dir={folder}/run"]
    rest = ["executor=serial", "report=false", *own, *words]
    return [ARENA, "run", "planner=ros_external", *world_overrides(site), *rest]


def ask_node(site: Path, folder: Path, action: str, plan: str, *words: str) -> tuple[list[str], list[EpisodeRecord]]:
    """Drive an episode for each letter of a plan of the stand-in for Nav2; return the goals that came, and records."""
    with run_process(*node_command("nav2_server.py", action, plan), log=folder / "node.txt"):
        ended = run_to_end(*run_command(site, folder, action, f"episodes={len(plan)}", *words))
    said = (folder / "node.txt").read_text()
    assert ended.returncode == 1, ended.stdout + ended.stderr + said
    return said.splitlines(), [read_record(folder / "run" / "records" / f"{k:04d}.npz") for k in range(len(plan))]


@pytest.fixture(scope="module")
def episodes(place: Path, tmp_path_factory: pytest.TempPathFactory, wheels_of_ros2: None) -> list[EpisodeRecord]:
    """Episodes of a server that drives, gives up, refuses, arrives too early, dies, and is not there any more."""
    folder = tmp_path_factory.mktemp("episodes")
    _, records = ask_node(place, folder, "navigate_to_pose", "FAREDF", f"planner.budget={BUDGET}", "task.time_limit=20")
    return records


class TestAskedPlanners:
    """What becomes of an episode whose planner is a server of Nav2's action NavigateToPose."""

    def test_its_commands_drive_the_robot_to_the_goal(self, episodes: list[EpisodeRecord]) -> None:
        assert episodes[0].meta["outcome"] == "goal_reached"

    def test_an_aborted_goal_ends_the_episode_with_its_reason(self, episodes: list[EpisodeRecord]) -> None:
        assert episodes[1].meta["outcome"] == "error"
        assert episodes[1].meta["error"].endswith("/navigate_to_pose says aborted (TF_ERROR 9002: no way)")

    def test_a_rejected_goal_ends_the_episode(self, episodes: list[EpisodeRecord]) -> None:
        assert episodes[2].meta["outcome"] == "error"
        assert episodes[2].meta["error"].endswith("/navigate_to_pose says rejected")

    def test_the_robot_stands_where_the_server_has_arrived_and_the_suite_has_not(
        self, episodes: list[EpisodeRecord]
    ) -> None:
        assert episodes[3].meta["outcome"] == "time_out"
        np.testing.assert_array_equal(episodes[3]["command"][-10:-1], 0.0)

    def test_a_server_that_dies_ends_the_episode_with_its_record(self, episodes: list[EpisodeRecord]) -> None:
        assert episodes[4].meta["outcome"] == "error"
        assert f"no command on /cmd_vel for this step within {BUDGET} s" in episodes[4].meta["error"]
        assert len(episodes[4]["stamp"]) > 5

    def test_a_server_that_is_gone_ends_the_next_episode_too(self, episodes: list[EpisodeRecord]) -> None:
        assert episodes[5].meta["outcome"] == "error"
        assert f"no server of /navigate_to_pose has taken the goal within {BUDGET} s" in episodes[5].meta["error"]


def test_a_server_that_follows_paths_is_a_planner_and_is_asked_for_a_controller(place: Path, tmp_path: Path) -> None:
    goals, records = ask_node(place, tmp_path, "follow_path", "FA", "planner.controller=DWB", "planner.budget=60")
    assert [record.meta["outcome"] for record in records] == ["goal_reached", "error"]
    assert records[1].meta["error"].endswith("/follow_path says aborted (TF_ERROR 102: no way)")
    assert goals[0] == f"{GOAL[0]} {GOAL[1]} DWB"
    assert set(goals) == {goals[0], "cancelled"}  # that of the first episode, which is over before its server says so


def test_a_planner_of_ours_is_one_of_nav2_for_us_in_lock_step(place: Path, tmp_path: Path) -> None:
    log, words = tmp_path / "controller.txt", ["stamped=true", f"out={tmp_path}/followed"]
    with run_process(*controller_command(place, *words, pose="/tf"), log=log):
        ended = run_to_end(*run_command(place, tmp_path, "follow_path", "episodes=1", "planner.budget=60"))
    assert ended.returncode == 0, ended.stdout + ended.stderr + log.read_text()
    record = read_record(tmp_path / "run" / "records" / "0000.npz")
    assert record.meta["outcome"] == "goal_reached"
    assert (record.timing["planner_seconds"] > 0.0).all()
