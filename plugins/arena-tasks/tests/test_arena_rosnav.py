"""The format of today's arena-rosnav is read: robots, obstacles by their models' names, people;
what cannot be kept is noted.
"""

import json
from pathlib import Path
from typing import Any

import pytest

from arena_core import InputFileError, Pose
from arena_core.testing import component
from arena_tasks.scenario_files.arena_tools import STANDS
from arena_tasks.scenario_files.flatland_model import SOLID
from arena_tasks.scenario_files.problem import PersonDefaults, Problem, reading_notes
from arena_tasks.scenario_files.published_models import published_models
from arena_tasks.scenario_files.scenario_file import read_scenarios

DEFAULTS = PersonDefaults(0.5, 0.3)
PERSON: dict[str, Any] = {
    "name": "Doctor_1",
    "pos": [14.0, 2.0, 0.5],
    "type": "adult",
    "model": "actor1",
    "waypoints": [[2.0, 14.0, 0.0], [14.0, 2.0, 0.0]],
    "waypoint_mode": 1,
}
GOOD: dict[str, Any] = {
    "robots": [{"start": [24.0, 20.0, 0.7], "goal": [2.0, 2.0, 0.0]}],
    "obstacles": {
        "static": [{"name": "long", "model": "long_shelf", "pos": [13.0, 11.0, 0.0]}],
        "dynamic": [PERSON],
        "interactive": [],
    },
    "resets": 50,
    "map": "hospital",
}


def read(folder: Path, content: object, name: str = "default.json") -> Problem:
    path = folder / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(content))
    (problem,) = read_scenarios(path, DEFAULTS)
    return problem


def with_obstacles(**parts: object) -> dict[str, Any]:
    return {**GOOD, "obstacles": {**GOOD["obstacles"], **parts}}


def with_person(**changes: object) -> dict[str, Any]:
    return with_obstacles(dynamic=[{**PERSON, **changes}])


def test_every_key_is_read(tmp_path: Path) -> None:
    problem = read(tmp_path, GOOD)
    assert (problem.name, problem.start, problem.goal, problem.repeats) == (
        "default",
        Pose(24.0, 20.0, 0.7),
        Pose(2.0, 2.0),
        50,
    )
    (person,) = problem.pedestrians
    assert (person.position_xy.tolist(), person.desired_speed, person.radius) == ([14.0, 2.0], 0.5, 0.3)
    assert person.waypoints_xy.tolist() == [[2.0, 14.0], [14.0, 2.0]]
    assert person.behaviour == {"type": "adult", "waypoint_mode": 1.0}
    (shelf,) = problem.obstacles
    assert sorted(shelf.vertices_xy.tolist()) == [[12.7, 8.25], [12.7, 13.6], [13.3, 8.25], [13.3, 13.6]]
    assert problem.notes == ()
    assert problem.keys.people == ("obstacles.dynamic[0]",)


@pytest.mark.parametrize("key", ["static", "dynamic", "interactive", "resets", "map"])
def test_what_is_not_there_is_nothing(tmp_path: Path, key: str) -> None:
    content = {
        **{k: v for k, v in GOOD.items() if k != key},
        "obstacles": {k: v for k, v in GOOD["obstacles"].items() if k != key},
    }
    assert read(tmp_path, content).start == Pose(24.0, 20.0, 0.7)
    assert read(tmp_path, {"robots": GOOD["robots"]}).pedestrians == ()


def test_headings_may_be_left_out_and_people_may_stand(tmp_path: Path) -> None:
    content = {**with_person(pos=[1, 2], waypoints=[]), "robots": [{"start": [1.5, 2], "goal": [3, 4]}]}
    problem = read(tmp_path, content)
    assert (problem.start, problem.goal) == (Pose(1.5, 2.0), Pose(3.0, 4.0))
    assert problem.pedestrians[0].waypoints_xy.shape == (0, 2)


@pytest.mark.parametrize("name", ["arena-tools", "arena-rosnav", None])
def test_it_is_told_by_its_robots_whatever_it_calls_itself(tmp_path: Path, name: str | None) -> None:
    assert read(tmp_path, {**GOOD, "format": name, "resets": 0}).repeats == 1


@pytest.mark.parametrize(
    "obstacle",
    [
        {"model": "long_shelf", "pos": [1.0, 2.0, 1.5]},
        {"model": "long_shelf.yaml", "pos": [1.0, 2.0], "angle": 1.5},
        {"model_path": "/home/a/obstacles/long_shelf.model.yaml", "pos": [1.0, 2.0], "angle": 1.5},
        {"yaml_path": "C:\\obstacles\\long_shelf.yaml", "pos": [1.0, 2.0, 0.5], "angle": 1.0},
    ],
)
def test_older_ways_to_name_a_model_and_its_heading_mean_the_same(tmp_path: Path, obstacle: dict[str, Any]) -> None:
    (usual,) = read(tmp_path, with_obstacles(static=[{"model": "long_shelf", "pos": [1.0, 2.0, 1.5]}])).obstacles
    (found,) = read(tmp_path, with_obstacles(static=[obstacle])).obstacles
    assert found.vertices_xy.tolist() == usual.vertices_xy.tolist()


@pytest.mark.parametrize(
    "place",
    [
        "entities/obstacles/static/bench/yaml/bench.yaml",
        "entities/obstacles/static/bench/bench.model.yaml",
        "worlds/hall/scenarios/bench.model.yaml",
        "worlds/hall/obstacles/bench.yaml",
    ],
)
@pytest.mark.parametrize("wrapped", [True, False])
def test_models_are_found_where_arena_simulation_setup_has_them(tmp_path: Path, place: str, wrapped: bool) -> None:
    footprint = {
        "type": "polygon",
        "points": [[-0.2, 0.5], [0.2, 0.5], [0.2, -0.5], [-0.2, -0.5]],
        "collision": "false",
        "layers": ["static"],
    }
    model: dict[str, Any] = {"bodies": [{"name": "base", "footprints": [footprint]}]}
    (tmp_path / place).parent.mkdir(parents=True)
    (tmp_path / place).write_text(json.dumps({"/**": {"ros__parameters": model}} if wrapped else model))
    problem = read(
        tmp_path,
        with_obstacles(static=[{"model": "bench", "pos": [1.0, 2.0, 0.0]}]),
        "worlds/hall/scenarios/default.json",
    )
    (bench,) = problem.obstacles
    assert sorted(bench.vertices_xy.tolist()) == [[0.8, 1.5], [0.8, 2.5], [1.2, 1.5], [1.2, 2.5]]
    assert problem.notes == (SOLID,)


def test_every_published_model_has_a_shape(tmp_path: Path) -> None:
    names = list(published_models())
    problem = read(tmp_path, with_obstacles(static=[{"model": name, "pos": [3.0, 4.0, 0.3]} for name in names]))
    assert len(problem.obstacles) == len(names) > 10


def test_a_forklift_is_told_by_its_model(tmp_path: Path) -> None:
    content = {k: v for k, v in {**PERSON, "model": "big_forklift"}.items() if k != "type"}
    assert read(tmp_path, with_obstacles(dynamic=[content])).pedestrians[0].behaviour["type"] == "forklift"


def test_who_has_no_place_begins_at_the_first_waypoint(tmp_path: Path) -> None:
    problem = read(tmp_path, with_obstacles(dynamic=[{k: v for k, v in PERSON.items() if k != "pos"}]))
    assert problem.pedestrians[0].position_xy.tolist() == [2.0, 14.0]
    assert problem.notes == ("people without pos begin at their first waypoint (1)",)


@pytest.mark.parametrize(
    ("content", "note"),
    [
        ({**GOOD, "robots": GOOD["robots"] * 3}, "robots after the first are left out (2), for here one robot drives"),
        (with_person(skin=2, max_vel=1.1), "people's max_vel, skin is not read"),
        (with_person(type="pedestrian"), "people of type pedestrian are adults here"),
        (
            with_obstacles(static=[{"model": "piano", "pos": [1, 2, 0]}]),
            "piano is left out, for no model of that name was found",
        ),
        (with_obstacles(interactive=[{"model": "long_shelf", "pos": [1, 2, 0]}]), STANDS),
        (with_obstacles(static=[{"model": "shelf", "pos": [k, 2, 0]} for k in range(3)]), f"{SOLID}, 3 times"),
    ],
)
def test_what_is_not_representable_is_noted_in_one_line(tmp_path: Path, content: dict[str, Any], note: str) -> None:
    assert reading_notes([read(tmp_path, content)]) == note


def test_a_round_of_a_kind_that_nobody_knows_is_a_loop_and_noted(tmp_path: Path) -> None:
    problem = read(tmp_path, with_person(waypoint_mode=2))
    assert "waypoint_mode" not in problem.pedestrians[0].behaviour
    assert "people of waypoint_mode 2 walk their waypoints in a loop (1)" in problem.notes


@pytest.mark.parametrize(
    ("content", "said"),
    [
        ({**GOOD, "robots": []}, r"robots is \[\]; allowed: at least one robot"),
        ({**GOOD, "robots": [{"start": [0, 0, 0]}]}, r"robots\[0\]\.goal is missing"),
        (
            {**GOOD, "robots": [{"start": ["X", "Y"], "goal": [0, 0]}]},
            r'robots\[0\]\.start\[0\] is "X"; allowed: a finite number',
        ),
        ({**GOOD, "obstacles": {"dynamic": ["<AGENT>"]}}, r'obstacles\.dynamic\[0\] is "<AGENT>"; allowed: a mapping'),
        (
            with_person(waypoints=[[1]]),
            r"obstacles\.dynamic\[0\]\.waypoints\[0\] is \[1\]; allowed: \[x, y\] or \[x, y, theta\]",
        ),
        (with_person(waypoint_mode="2"), r'obstacles\.dynamic\[0\]\.waypoint_mode is "2"; allowed: a whole number'),
        (with_obstacles(dynamic=[{"waypoints": []}]), r"obstacles\.dynamic\[0\]\.pos is missing"),
        (with_obstacles(static=[{"pos": [1, 2, 3]}]), r"obstacles\.static\[0\]\.model is missing"),
        (
            with_obstacles(static=[{"model": "", "pos": [1, 2, 3]}]),
            r'obstacles\.static\[0\]\.model is ""; allowed: a text',
        ),
    ],
)
def test_a_wrong_value_is_one_line_with_file_and_key(tmp_path: Path, content: dict[str, Any], said: str) -> None:
    with pytest.raises(InputFileError, match=rf"default\.json: {said}") as error:
        read(tmp_path, content)
    assert "\n" not in str(error.value)


def test_its_map_is_that_of_its_world(tmp_path: Path) -> None:
    content = {k: v for k, v in GOOD.items() if k != "map"}
    for name in ("default.json", "4/scenario.json"):
        read(tmp_path, content, f"worlds/hall/scenarios/{name}")
    (tmp_path / "worlds/hall/map").mkdir()
    (tmp_path / "worlds/hall/map/map.yaml").write_text(
        "/**: {ros__parameters: {image: m.pgm, resolution: 1.0, origin: [-4, -4, 0], negate: 0, occupied_thresh: "
        "0.65, free_thresh: 0.196}}"
    )
    (tmp_path / "worlds/hall/map/m.pgm").write_bytes(b"P5\n8 8\n255\n" + bytes([254] * 64))
    for scenario in ("default.json", "4/scenario.json"):
        chosen = [f"world.scenario={tmp_path}/worlds/hall/scenarios/{scenario}"]
        assert component("world", "scenario_map", chosen).world(0, 0).grid.data.shape == (8, 8)
    elsewhere = tmp_path / "elsewhere.json"
    elsewhere.write_text(json.dumps({**GOOD, "map": "hall"}))
    found = component("world", "scenario_map", [f"world.scenario={elsewhere}", f"world.maps={tmp_path}"])
    assert found.world(0, 0).grid.data.shape == (8, 8)
    with pytest.raises(
        InputFileError, match=r"elsewhere\.json: map: no hall/map/map\.yaml below .*; allowed: world\.maps"
    ):
        component("world", "scenario_map", [f"world.scenario={elsewhere}"])
    elsewhere.write_text(json.dumps(content))
    with pytest.raises(InputFileError, match=r"elsewhere\.json: map is missing; allowed: the name of a world"):
        component("world", "scenario_map", [f"world.scenario={elsewhere}"])
