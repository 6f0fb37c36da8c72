"""The format of arena-tools is read as its authors meant it, and what cannot be kept is refused."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from arena_core import InputFileError, Pose, WorldSource
from arena_core.testing import component
from arena_tasks.scenario_files.arena_tools import STANDS
from arena_tasks.scenario_files.flatland_model import NOWHERE, SENSOR, SOLID
from arena_tasks.scenario_files.problem import PersonDefaults
from arena_tasks.scenario_files.scenario_file import read_scenarios, save_scenarios
from arena_tasks.scenario_files.scenario_task import ScenarioTask

DATA = Path(__file__).parents[3].parent / "shared" / "data"
DRAWN = Path(__file__).parents[3] / "tests" / "data"
needs_data = pytest.mark.skipif(
    not DATA.is_dir(), reason="the collection of public maps and scenarios is not at ../shared/data"
)
DEFAULTS = PersonDefaults(0.5, 0.3)
AGENT: dict[str, Any] = {
    "name": "1",
    "id": 0,
    "pos": [1.0, 2.0],
    "type": "adult",
    "yaml_file": "/somewhere/person.yaml",
    "number_of_peds": 1,
    "vmax": 0.2,
    "force_factor_social": 5,
    "waypoints": [[3.0, 2.0], [1.0, 2.0]],
    "waypoint_mode": 0,
}
GOOD: dict[str, Any] = {
    "pedsim_agents": [AGENT],
    "static_obstacles": [],
    "robot_position": [0.0, 0.0],
    "robot_goal": [4.0, 0.0],
    "resets": 30,
    "map_path": "/somewhere/map.yaml",
    "format": "arena-tools",
}
SITES = [
    pytest.param(DRAWN, "hall_obs03", "hall/map.yaml", 3, id="drawn"),
    pytest.param(
        DATA, "small_warehouse_obs05", "arena_bench/small_warehouse/map.yaml", 5, id="small_warehouse", marks=needs_data
    ),
    pytest.param(DATA, "map5_obs05", "arena_bench/map5/map.yaml", 5, id="map5", marks=needs_data),
]
site = pytest.mark.parametrize(("data", "name", "map_name", "count"), SITES)


def write(folder: Path, content: object) -> Path:
    path = folder / "site.json"
    path.write_text(json.dumps(content))
    return path


def test_every_used_key_is_read(tmp_path: Path) -> None:
    (problem,) = read_scenarios(write(tmp_path, GOOD), DEFAULTS)
    assert (problem.name, problem.start, problem.goal, problem.repeats) == ("site", Pose(0.0, 0.0), Pose(4.0, 0.0), 30)
    (person,) = problem.pedestrians
    assert (person.id, person.desired_speed, person.radius) == (0, 0.2, 0.3)
    assert person.position_xy.tolist() == [1.0, 2.0]
    assert person.waypoints_xy.tolist() == [[3.0, 2.0], [1.0, 2.0]]
    assert person.behaviour == {"type": "adult", "force_factor_social": 5}


def test_a_round_at_random_is_left_to_the_model(tmp_path: Path) -> None:
    (problem,) = read_scenarios(write(tmp_path, {**GOOD, "pedsim_agents": [{**AGENT, "waypoint_mode": 1}]}), DEFAULTS)
    assert problem.pedestrians[0].behaviour["waypoint_mode"] == 1


def test_a_round_of_a_kind_that_nobody_knows_is_a_loop_and_noted(tmp_path: Path) -> None:
    agents = [{**AGENT, "waypoint_mode": mode} for mode in (2, 0, 7, 2)]
    (problem,) = read_scenarios(write(tmp_path, {**GOOD, "pedsim_agents": agents}), DEFAULTS)
    assert [person.behaviour.get("waypoint_mode") for person in problem.pedestrians] == [None] * 4
    assert problem.notes == ("people of waypoint_mode 2, 7 walk their waypoints in a loop (3)",)


MODEL = """
bodies:
  - name: base
    pose: [1.0, 0.0, 0.0]
    footprints:
      - {type: polygon, points: [[-0.3, 0.9], [0.3, -0.9], [0.3, 0.9], [-0.3, -0.9]], density: 1}
      - {type: circle, radius: 0.5, center: [0.0, 2.0]}
      - {type: circle, radius: 0.7, center: [0.0, -2.0], collision: false}
      - {type: circle, radius: 9.0, sensor: true}
      - {type: circle, radius: 8.0, layers: []}
"""


@pytest.mark.parametrize("place", [".", "obstacles", "../obstacles"])
def test_static_obstacles_have_the_shapes_of_their_flatland_model(tmp_path: Path, place: str) -> None:
    folder = tmp_path / "scenarios"
    (folder / place).mkdir(parents=True)
    (folder / place / "shelf.yaml").write_text(MODEL)
    shelf = {"name": "3", "model_path": "C:\\somewhere\\shelf.yaml", "pos": [10.0, 5.0], "angle": np.pi / 2}
    disc = {"shape": "circle", "x": 1.0, "y": 2.0, "radius": 0.4}
    (problem,) = read_scenarios(write(folder, {**GOOD, "static_obstacles": [shelf, disc]}), DEFAULTS)
    polygon, circle, passable, own = problem.obstacles
    assert sorted(polygon.vertices_xy.round(6).tolist()) == [[9.1, 5.7], [9.1, 6.3], [10.9, 5.7], [10.9, 6.3]]
    assert polygon.radius == 0.0
    assert (circle.vertices_xy.round(6).tolist(), circle.radius) == ([[8.0, 6.0]], 0.5)
    assert (passable.vertices_xy.round(6).tolist(), passable.radius) == ([[12.0, 6.0]], 0.7)
    assert (own.vertices_xy.tolist(), own.radius) == ([[1.0, 2.0]], 0.4)
    assert problem.notes == (SOLID, SENSOR, NOWHERE)


def test_a_model_that_is_nowhere_is_a_published_one_or_left_out_and_noted(tmp_path: Path) -> None:
    shelf, own = ({"model_path": f"/a/{name}.yaml", "pos": [1.0, 2.0]} for name in ("shelf", "our_bench"))
    (problem,) = read_scenarios(write(tmp_path, {**GOOD, "static_obstacles": [shelf, own]}), DEFAULTS)
    (obstacle,) = problem.obstacles
    assert sorted(obstacle.vertices_xy.round(3).tolist()) == [
        [0.605, 1.56],
        [0.605, 2.44],
        [1.005, 1.56],
        [1.005, 2.44],
    ]
    assert problem.notes == (SOLID, "our_bench is left out, for no model of that name was found")


def test_interactive_obstacles_stand_there(tmp_path: Path) -> None:
    content = {
        **GOOD,
        "interactive_obstacles": [{"name": "s", "yaml_path": "/a/shelf.yaml", "pos": [1.0, 2.0], "angle": 0.0}],
    }
    (problem,) = read_scenarios(write(tmp_path, content), DEFAULTS)
    assert len(problem.obstacles) == 1
    assert problem.notes == (SOLID, STANDS)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("bodies: 3", r"bodies is 3; allowed: a list"),
        ("{}", r"bodies is missing"),
        ("bodies: [{footprints: [{type: mesh}]}]", r'type is "mesh"; allowed: circle or polygon'),
        ("bodies: [{footprints: [{type: circle, radius: 0}]}]", r"radius is 0; allowed: a number > 0"),
        (
            "bodies: [{footprints: [{type: polygon, points: [[0, 0], [1, 1], [2, 2]]}]}]",
            r"points is .*; allowed: three or more",
        ),
        ("bodies: [{footprints: [{type: polygon, points: 2026-01-01}]}]", r'points is "2026-01-01"; allowed: a list'),
        ("a: &a [1]\nbodies: *a", r"is no YAML \(it has aliases\); allowed: a Flatland model"),
        ("bodies: [", r"is no YAML"),
        ("!!python/object:os.system []", r"is no YAML"),
    ],
)
def test_flatland_model_that_cannot_be_read_is_said_in_one_line(tmp_path: Path, text: str, said: str) -> None:
    (tmp_path / "shelf.yaml").write_text(text)
    content = {**GOOD, "static_obstacles": [{"model_path": "shelf.yaml", "pos": [0, 0], "angle": 0}]}
    with pytest.raises(InputFileError, match=said) as error:
        read_scenarios(write(tmp_path, content), DEFAULTS)
    assert "shelf.yaml" in str(error.value)
    assert "\n" not in str(error.value)


def test_it_is_recognised_by_its_content_when_it_says_no_format(tmp_path: Path) -> None:
    assert len(read_scenarios(write(tmp_path, {k: v for k, v in GOOD.items() if k != "format"}), DEFAULTS)) == 1


def test_a_group_stands_close_together_without_touching(tmp_path: Path) -> None:
    agents = [{**AGENT, "number_of_peds": 12}, AGENT]
    (problem,) = read_scenarios(write(tmp_path, {**GOOD, "pedsim_agents": agents}), DEFAULTS)
    positions = np.array([p.position_xy for p in problem.pedestrians[:12]])
    gaps = np.hypot(*(positions[:, None] - positions).transpose(2, 0, 1))[np.triu_indices(12, 1)]
    assert gaps.min() >= 0.6
    assert gaps.max() < 6.0
    assert positions[0].tolist() == [1.0, 2.0]
    assert [p.id for p in problem.pedestrians] == list(range(13))
    assert problem.keys.people == ("pedsim_agents[0]",) * 12 + ("pedsim_agents[1]",)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ({**GOOD, "interactive_obstacles": [{"name": "shelf"}]}, r"interactive_obstacles\[0\]\.pos is missing"),
        (
            {**GOOD, "static_obstacles": [{"name": "shelf", "pos": [0, 0]}]},
            r"static_obstacles\[0\]\.model_path is missing",
        ),
        (
            {**GOOD, "static_obstacles": [{"shape": "box"}]},
            r"static_obstacles\[0\]\.shape is \"box\"; allowed: circle or polygon",
        ),
        ({**GOOD, "robot_goal": [1]}, r"robot_goal is \[1\]; allowed: \[x, y\]"),
        ({k: v for k, v in GOOD.items() if k != "robot_position"}, "robot_position is missing"),
        (
            {**GOOD, "pedsim_agents": [{**AGENT, "waypoint_mode": 0.5}]},
            r"pedsim_agents\[0\]\.waypoint_mode is 0\.5; allowed: a whole number",
        ),
        (
            {**GOOD, "pedsim_agents": [{**AGENT, "number_of_peds": 0}]},
            r"pedsim_agents\[0\]\.number_of_peds is 0; allowed: a whole number 1 \.\. 10000",
        ),
        ({**GOOD, "pedsim_agents": [{**AGENT, "vmax": 0}]}, r"pedsim_agents\[0\]\.vmax is 0; allowed: a number > 0"),
        ({**GOOD, "pedsim_agents": {}}, r"pedsim_agents is \{\}; allowed: a list"),
    ],
)
def test_what_cannot_be_kept_is_refused(tmp_path: Path, content: object, message: str) -> None:
    with pytest.raises(InputFileError, match=rf"site\.json: {message}"):
        read_scenarios(write(tmp_path, content), DEFAULTS)


def world(path: Path) -> WorldSource:
    return component("world", "ros_map", [f"world.path={path}"])  # type: ignore[no-any-return]


@site
def test_published_scenario_lies_in_free_cells_of_its_map(data: Path, name: str, map_name: str, count: int) -> None:
    (problem,) = read_scenarios(data / "scenarios" / f"{name}.json", DEFAULTS)
    assert len(problem.pedestrians) == count
    grid = world(data / "maps" / map_name).world(0, 0).grid
    ends = np.array([(problem.start.x, problem.start.y), (problem.goal.x, problem.goal.y)])
    places = np.vstack(
        (ends, *(np.vstack((person.position_xy, person.waypoints_xy)) for person in problem.pedestrians))
    )
    assert len(places) >= 2 + 3 * count
    assert (grid.data[tuple(grid.cells(places).T)] == 0).all()


@pytest.mark.parametrize("robot", ["turtlebot3", "jackal", "robotino", "jackal_ackermann"])
@site
def test_published_scenario_can_be_run_by_every_robot(
    data: Path, name: str, map_name: str, count: int, robot: str
) -> None:
    body = component("robot", robot)
    task = ScenarioTask(
        body, world(data / "maps" / map_name), str(data / "scenarios" / f"{name}.json"), 0.3, 0.3, 0.3, 180.0
    )
    assert len(task.scenario(0, 0).pedestrians) == count


@site
def test_published_scenario_survives_our_own_format(
    tmp_path: Path, data: Path, name: str, map_name: str, count: int
) -> None:
    source = data / "scenarios" / f"{name}.json"
    task = ScenarioTask(
        component("robot", "jackal"), world(data / "maps" / map_name), str(source), 0.3, 0.3, 0.3, 180.0
    )
    scenario = task.scenario(0, 0)
    save_scenarios(tmp_path / "ours.json", [scenario])
    (again,) = read_scenarios(tmp_path / "ours.json", DEFAULTS)
    ends = [Pose(*json.loads(source.read_text())[key]) for key in ("robot_position", "robot_goal")]
    assert (again.start, again.goal, again.time_limit, len(again.pedestrians)) == (*ends, 180.0, count)
    assert [p.waypoints_xy.tolist() for p in again.pedestrians] == [
        p.waypoints_xy.tolist() for p in scenario.pedestrians
    ]
    assert [p.behaviour for p in again.pedestrians] == [p.behaviour for p in scenario.pedestrians]


@pytest.mark.parametrize(
    ("path", "count"),
    [
        pytest.param(DRAWN / "scenarios/hall_vehicles.json", 3, id="drawn"),
        pytest.param(
            DATA / "scenarios/arena_rosnav_configs/examples/example_scenario.json", 2, id="real", marks=needs_data
        ),
    ],
)
def test_vehicles_of_arena_tools_are_read(path: Path, count: int) -> None:
    (problem,) = read_scenarios(path, DEFAULTS)
    assert [p.desired_speed for p in problem.pedestrians] == [1.0] * count
    assert problem.pedestrians[0].behaviour["type"] == "vehicle"
