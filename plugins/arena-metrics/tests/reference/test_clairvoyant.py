"""The planners that see the truth, driven by the benchmark as any other."""

from contextlib import suppress
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from arena_core import EpisodeRecord, EpisodeStart, NoValidCommand
from arena_core.hosting import build_benchmark, compose, load_registry, to_plain
from arena_core.records import is_success
from arena_core.testing import component, observation

WORDS = ["world=empty", "task.pedestrians=8", "localizer=ground_truth", "executor=serial"]


def drive(planner: str, robot: str, tmp_path: Path, *words: str) -> EpisodeRecord:
    """Return the record of one episode."""
    config = to_plain(compose([f"planner={planner}", f"robot={robot}", *WORDS, *words]))
    return build_benchmark(config, load_registry()).run(0, tmp_path)


@pytest.mark.parametrize("robot", ["jackal", "robotino", "jackal_ackermann"])
def test_the_clairvoyant_touches_nobody_and_is_no_sooner_than_the_bound(robot: str, tmp_path: Path) -> None:
    record = drive("clairvoyant", robot, tmp_path)
    notes = record.meta["notes"]
    assert is_success(record, collisions_allowed=0)
    assert notes["time_lower_static"] <= notes["time_lower"] <= record["stamp"][-1]
    assert notes["time_planned"] == pytest.approx(record["stamp"][-1])


@pytest.mark.slow
def test_it_is_driven_on_wheels_in_three_dimensions_too(tmp_path: Path) -> None:
    record = drive("clairvoyant", "jackal", tmp_path, "simulator=mujoco", "task.pedestrians=3")
    assert is_success(record, collisions_allowed=0)


def test_the_sighted_planner_arrives(tmp_path: Path) -> None:
    record = drive("sighted", "jackal", tmp_path)
    assert record.meta["outcome"] == "goal_reached"
    assert "planner sighted" in record.meta["columns"]["privileged"]
    assert record["command"][:-1, 0].min() >= -0.3 - 1e-9  # its lidar does not see what is behind


@pytest.mark.parametrize(("reaction", "bounded"), [("ignore", False), ("yield", True)])
def test_only_people_who_do_not_react_bound_the_time(stage, reaction: str, bounded: bool) -> None:
    """A row of people across the room: nobody passes unless they step aside."""
    set_up = stage(walks=[((0.0, y), (0.0, y), 0.1) for y in np.arange(-3.6, 3.7, 0.6).tolist()])
    people = tuple(replace(one, behaviour={"reaction": reaction}) for one in set_up.scenario.pedestrians)
    set_up.truth.scenario = replace(set_up.scenario, pedestrians=people)
    planner = component("planner", "clairvoyant", robot=set_up.robot)
    planner.see(set_up.truth)
    planner.reset(EpisodeStart(None, set_up.scenario.goal, 0.1, np.random.default_rng(0)))
    with suppress(NoValidCommand):
        planner.compute_velocity(observation(set_up.scenario.start, body=set_up.robot))
    notes = planner.notes()
    assert np.isfinite(notes["time_lower_static"])
    assert (notes["time_lower"] == notes["time_lower_static"]) == bounded


def test_the_same_episode_is_driven_alike_twice(tmp_path: Path) -> None:
    one, other = (drive("clairvoyant", "jackal", tmp_path) for _ in range(2))
    assert np.array_equal(one["pose"], other["pose"])
