"""Whole runs on maps and scenarios of sites: drawn ones, and where they are there, real ones."""

import csv
import json
from pathlib import Path

import pytest

TOP = Path(__file__).resolve().parents[1]
SITES = {
    "drawn": (TOP / "tests" / "data", "maps/hall/map.yaml", "scenarios/hall_obs03.json", 3),
    "real": (TOP.parent / "shared" / "data", "maps/turtlebot3/map.yaml", "scenarios/small_warehouse_obs05.json", 5),
}


@pytest.fixture(params=SITES)
def site(request):
    """Return folder of maps, a map, a scenario file and how many people are in it."""
    folder, site, scenario, people = SITES[request.param]
    if not folder.is_dir():
        pytest.skip(f"real data is not there: {folder}")
    return folder / "maps", folder / site, folder / scenario, people


def rows():
    with Path("run/episodes.csv").open(newline="") as file:
        return list(csv.DictReader(file))


@pytest.mark.slow
def test_a_map_of_a_site_can_be_driven_on_among_people(arena, site):
    words = (
        "planner=dwa",
        "robot=turtlebot3",
        "world=ros_map",
        f"world.path={site[1]}",
        "task=random",
        "task.pedestrians=5",
        "episodes=2",
    )
    answer = arena("run", *words, "executor=serial", "report=false", "hydra.run.dir=run")
    assert answer.status == 0
    assert [row["n_pedestrians"] for row in rows()] == ["5", "5"]
    assert {row["outcome"] for row in rows()} <= {"goal_reached", "false_arrival", "time_out"}


@pytest.mark.slow
def test_a_scenario_of_another_tool_runs_on_its_map(arena, site):
    maps, _, scenario, people = site
    words = (
        "planner=dwa",
        "robot=jackal",
        "world=scenario_map",
        f"world.maps={maps}",
        "task=scenario",
        f"task.path={scenario}",
    )
    answer = arena("run", *words, "episodes=1", "executor=serial", "report=false", "hydra.run.dir=run")
    assert answer.status == 0, answer.errors
    assert (rows()[0]["n_pedestrians"], rows()[0]["error"]) == (str(people), "")


@pytest.mark.slow
def test_a_flatland_scenario_runs_in_a_world_from_gazebo(arena):
    disc = {
        "start_pos": [3, 3, 0],
        "waypoints": [[1, 0, 0]],
        "linear_velocity": 0.3,
        "obstacle_radius": 0.3,
        "mode": "yoyo",
        "triggers": ["w"],
    }
    robot = {"start_pos": [1.3, 1.3, 0], "goal_pos": [5, 1.3, 0]}
    scene = {
        "scene_name": "hall",
        "repeats": 1,
        "robot": robot,
        "dynamic_obstacles": {"d": disc},
        "watchers": {"w": {"pos": [3, 1.3], "range": 1}},
    }
    Path("scenes.json").write_text(json.dumps({"scenerios": [scene]}))
    assert arena("world", "generate", "kind=empty", "width=8", "height=8", "out=hall").status == 0
    assert arena("world", "convert", "hall/map.yaml", "hall.sdf").status == 0
    words = (
        "planner=dwa",
        "robot=jackal",
        "world=file",
        "world.path=hall.sdf",
        "task=scenario",
        "task.path=scenes.json",
        "episodes=1",
    )
    answer = arena("run", *words, "executor=serial", "report=false", "hydra.run.dir=run")
    assert answer.status == 0, answer.errors
    assert (rows()[0]["n_pedestrians"], rows()[0]["outcome"]) == ("1", "goal_reached")
