"""DynaBARN from the experiment to the score, and which planners both BARN experiments take."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from arena_core.config.configuration import compose, to_plain
from arena_core.hosting import load_registry
from arena_core.runs.jobs.benchmark import build_benchmark

CLASSIC = ("dwa", "teb", "mpc", "mppi", "orca", "pure_pursuit")
LEARNED = ("rosnav", "gring", "navrep", "navrep_v_only", "aio")
POST = """<sdf version='1.6'><world name='default'><model name='post'><static>1</static><pose>-3.5 8 0 0 0 0</pose>
<link name='link'><collision name='collision'><geometry><cylinder><radius>0.075</radius><length>1</length></cylinder>
</geometry></collision></link></model></world></sdf>"""


def benchmark(*overrides):
    return build_benchmark(to_plain(compose([*overrides])), load_registry())


def driven(folder: Path, *overrides, episode=0):
    built = benchmark("experiment=dynabarn", "metrics=[barn]", *overrides)
    record = built.run(episode, folder)
    return record, {metric.name: metric.compute(record) for metric in built.metrics["barn"]}


@pytest.mark.slow
@pytest.mark.parametrize("planner", [*CLASSIC, *LEARNED])
def test_every_planner_is_taken_by_both_experiments(tmp_path, planner):
    (tmp_path / "world_1.world").write_text(POST)
    for experiment in (("experiment=barn", f"world.path={tmp_path}"), ("experiment=dynabarn",)):
        built = benchmark(*experiment, f"planner={planner}")
        assert built.robot.footprint.radius == pytest.approx(0.309, abs=1e-3)
        said = built.navigator.planner.untuned
        assert any("trained with a footprint of radius 0.267 m" in note for note in said) == (planner in LEARNED)


@pytest.mark.slow
def test_dwa_crosses_a_field_and_is_scored_by_the_straight_way(tmp_path):
    alone = ("world.easy.obstacles_min=1", "world.easy.obstacles_max=1")
    record, found = driven(tmp_path, "planner=dwa", *alone, episode=2)
    assert record.meta["outcome"] == "goal_reached"
    assert record.meta["columns"]["n_pedestrians"] == 1
    assert found["optimal_time"] == 10.0
    assert found["success"] == 1.0
    assert found["score"] == pytest.approx(10.0 / max(found["time"], 20.0))


@pytest.mark.slow
def test_obstacles_move_as_told_whatever_the_robot_does(tmp_path):
    runs = [
        driven(tmp_path, f"planner={planner}", "stop_on_collision=false", "task.time_limit=4.0")[0]
        for planner in ("pure_pursuit", "dwa")
    ]
    steps = min(len(run["stamp"]) for run in runs)
    tracks = [run["pedestrian_positions"][:steps] for run in runs]
    clear = [np.isfinite(track).all(axis=2) for track in tracks]
    both = clear[0] & clear[1]
    apart = np.hypot(*np.moveaxis(tracks[0] - tracks[1], 2, 0))[both]
    assert np.median(apart) < 1e-6
    assert (np.hypot(*np.moveaxis(tracks[0][-1] - tracks[0][0], 1, 0))[both[0] & both[-1]] > 1.0).all()


@pytest.mark.slow
def test_pure_pursuit_who_sees_nothing_coming_hits_someone_or_is_hit(tmp_path):
    outcomes = [
        driven(tmp_path, "planner=pure_pursuit", episode=episode)[0].meta["outcome"] for episode in (20, 21, 22)
    ]
    assert "collision" in outcomes
    assert "error" not in outcomes
