"""Ways for all robots of a team, searched one robot after the other and driven together."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from arena_core import ArenaError, EpisodeRecord, Footprint, Pose, Run, Twist, run
from arena_core.hosting import build_benchmark, compose, load_registry, to_plain
from arena_core.records import is_success, read_findings, read_record, record_path
from arena_core.testing import robot
from arena_reference.body import Walkers
from arena_reference.certifying import reference_runs
from arena_reference.costing import OF_A_TEAM, cost_of_run
from arena_reference.explaining import explain_run
from arena_reference.together import Team, beside, discs_of, walk_of, with_waiting
from arena_reference.ways import Attempt, SearchSettings, Way, WayFinder

ALL = [
    *("task.team=3", "task.time_limit=30", "robot=jackal", "world=empty", "pedestrians=none", "localizer=ground_truth"),
    *("executor=serial", "metrics=[si,team]", "report=false", "episodes=1"),
]
CROSSING = [*ALL, "task=antipodal", "task.radius=2.0", "world.width=7", "world.height=7"]


class Standing:
    """What is asked of the truth of a robot that stands at (1, 2) m."""

    scenario = SimpleNamespace(speed_share=1.0)

    def state(self) -> SimpleNamespace:
        return SimpleNamespace(pose=Pose(1.0, 2.0), twist=Twist(0.0))


def test_the_discs_of_a_robot_cover_its_outline() -> None:
    body = robot().footprint
    centres, radius = discs_of(body)
    corners = np.asarray(body.vertices_xy)
    away = np.hypot(*(corners[:, None] - centres).transpose(2, 0, 1)).min(axis=1)
    assert (away <= radius + 1e-9).all()
    disc, radius = discs_of(Footprint.circle(0.2))
    assert (disc.tolist(), radius) == ([[0.0, 0.0]], 0.2)


def test_discs_turn_with_the_robot_and_stand_when_it_has_arrived() -> None:
    finder = WayFinder(robot(), SearchSettings([Attempt(0.05, 8, 0.01, 0.01)], 0.3), 0.1)
    states = np.zeros((6, 6))
    states[:, 0], states[:, 2] = 0.1 * np.arange(6), np.linspace(0.0, math.pi / 2.0, 6)
    way = Way(np.zeros((5, 3)), states, start=2.0, period=0.1, arrives=True)
    people = Walkers(np.zeros((30, 1, 2)), np.array([0.3]), 2.0, 0.1)
    walk = walk_of(Standing(), finder, way, people, np.array([[0.5, 0.0], [0.0, 0.0]]))
    np.testing.assert_allclose(walk[0], [[0.5, 0.0], [0.0, 0.0]], atol=1e-12)
    np.testing.assert_allclose(walk[5:], np.broadcast_to([[0.5, 0.5], [0.5, 0.0]], (25, 2, 2)), atol=1e-12)
    both = beside(people, walk, 0.2)
    assert (both.positions.shape, both.radii.tolist()) == ((30, 3, 2), [0.3, 0.2, 0.2])


def test_who_has_no_way_yet_stands_for_a_while_and_is_then_gone() -> None:
    finder = WayFinder(robot(), SearchSettings([Attempt(0.05, 8, 0.01, 0.01)], 0.3), 0.1)
    truth = Standing()
    team = Team([truth], [finder], [(np.zeros((1, 2)), 0.2)])
    people = Walkers(np.zeros((50, 1, 2)), np.array([0.3]), 2.0, 0.1)
    assert with_waiting(team, [0], people, 0.0) is people
    walk = with_waiting(team, [0], people, 3.0).positions[:, 1]
    np.testing.assert_allclose(walk[:31], np.broadcast_to([1.0, 2.0], (31, 2)))
    assert np.isnan(walk[31:]).all()


def drive(tmp_path: Path, *words: str) -> Mapping[int, EpisodeRecord]:
    """Return the records of one team, by episode."""
    config = to_plain(compose(list(words)))
    return build_benchmark(config, load_registry()).run_all(0, tmp_path)


def test_a_clairvoyant_leads_its_whole_team_across_without_a_touch(tmp_path: Path) -> None:
    records = drive(tmp_path, *CROSSING, "planner=clairvoyant", "task.teammates=teb")
    assert len(records) == 3
    for record in records.values():
        assert is_success(record, collisions_allowed=0)
        assert record.meta["columns"]["planner"] == "clairvoyant"  # of all: it drives its team
        assert record.meta["columns"]["privileged"] == "planner clairvoyant"
        assert record.meta["notes"]["time_lower"] <= record["stamp"][-1]
        assert record.meta["notes"]["time_planned"] == pytest.approx(record["stamp"][-1])


@pytest.fixture(scope="module")
def crossed(tmp_path_factory: pytest.TempPathFactory) -> Run:
    """Return a run of a planner that knows of nobody, with a reference."""
    folder = tmp_path_factory.mktemp("crossed") / "run"
    run(["planner=pure_pursuit", *CROSSING], folder)
    reference_runs([Run(folder)], {"name": "serial"}, load_registry())
    return Run(folder)


def test_each_robot_of_a_run_has_a_bound_and_the_team_one_certificate(crossed: Run) -> None:
    found = next(kind.rows for kind in read_findings(crossed.folder) if kind.kind == "reference")
    assert sorted(found) == [0, 1, 2]
    for episode, row in found.items():
        certificate = read_record(record_path(crossed.folder / "reference", episode))
        assert certificate.meta["team"]["member"] == episode
        assert row["solvable"] == "yes"
        assert row["time_lower"] <= row["time_certified"] == certificate["stamp"][-1]
        assert row["avoidable"] == float(not is_success(crossed.record(episode), collisions_allowed=0))
    before = [record_path(crossed.folder / "reference", episode).stat().st_mtime_ns for episode in found]
    reference_runs([crossed], {"name": "serial"}, load_registry())
    assert [record_path(crossed.folder / "reference", k).stat().st_mtime_ns for k in found] == before


def test_contacts_of_teammates_are_told_and_no_way_out_is_looked_for(crossed: Run) -> None:
    told = [text for one in explain_run(crossed, load_registry(), None) for text in one.sentences()]
    assert any("robot 1" in text and text.endswith("in a team no way out is looked for") for text in told), told


def test_what_one_robot_of_a_team_cost_people_is_not_told(crossed: Run) -> None:
    found = cost_of_run(crossed, load_registry())
    assert {row["note"] for row in found.rows.values()} == {OF_A_TEAM}


def test_a_team_on_errands_has_no_goal_to_be_led_to(tmp_path: Path) -> None:
    record = drive(tmp_path, *ALL, "planner=clairvoyant", "task=patrol")[0]
    assert "this task sends robots on until the time limit" in record.meta["error"]


def test_who_sees_only_people_is_in_no_team(tmp_path: Path) -> None:
    record = drive(tmp_path, *CROSSING, "planner=sighted")[0]
    assert "allowed: a robot without teammates" in record.meta["error"]


def test_a_run_on_errands_is_refused_in_one_line(tmp_path: Path) -> None:
    run(["planner=pure_pursuit", *ALL, "task=patrol", "task.time_limit=3"], tmp_path / "run")
    with pytest.raises(ArenaError, match="were sent from place to place until the time limit"):
        reference_runs([Run(tmp_path / "run")], {"name": "serial"}, load_registry())
