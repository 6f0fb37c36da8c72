"""The older Flatland format is read: scenes, discs on their ways, watchers that start them."""

import copy
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from arena_core import InputFileError, Pose
from arena_tasks.scenario_files.problem import PersonDefaults, Problem
from arena_tasks.scenario_files.scenario_file import read_scenario_file, read_scenarios, save_scenarios

DEFAULTS = PersonDefaults(0.5, 0.3)
DISC: dict[str, Any] = {
    "obstacle_radius": 0.4,
    "linear_velocity": 0.1,
    "type": "circle",
    "start_pos": [4, 9, 0],
    "waypoints": [[0, -6, 0], [1, -6, 0]],
    "is_waypoint_relative": True,
    "mode": "yoyo",
    "triggers": ["watcher_0"],
}
SCENE: dict[str, Any] = {
    "scene_name": "hall",
    "repeats": 5,
    "dynamic_obstacles": {"dynamic_obs_0": DISC},
    "static_obstacles": {
        "static_obs_0": {"shape": "circle", "x": 0, "y": -2.6, "radius": 1},
        "static_obs_1": {"shape": "polygon", "vertices": [[2, 4], [5, 5], [5, 4], [2, 5]]},
    },
    "robot": {"start_pos": [0.0, 7.0, 0.5], "goal_pos": [24, 7, 0]},
    "watchers": {"watcher_0": {"pos": [2, 8.5], "range": 2}, "watcher_1": {"pos": [9, 9], "range": 1}},
}


def read(folder: Path, content: object) -> tuple[Problem, ...]:
    path = folder / "scenes.json"
    path.write_text(json.dumps(content))
    return read_scenarios(path, DEFAULTS)


def scene(**changes: object) -> dict[str, Any]:
    return {**SCENE, **changes}


def disc(**changes: object) -> dict[str, Any]:
    return scene(dynamic_obstacles={"dynamic_obs_0": {**DISC, **changes}})


@pytest.mark.parametrize("title", ["scenarios", "scenerios"])
def test_every_key_is_read(tmp_path: Path, title: str) -> None:
    (problem,) = read(tmp_path, {title: [SCENE]})
    assert (problem.name, problem.repeats) == ("hall", 5)
    assert (problem.start, problem.goal) == (Pose(0.0, 7.0, 0.5), Pose(24.0, 7.0, 0.0))
    (person,) = problem.pedestrians
    assert (person.id, person.desired_speed, person.radius) == (0, 0.1, 0.4)
    assert person.position_xy.tolist() == [4.0, 9.0]
    assert person.behaviour == {
        "start_up_mode": "trigger_zone",
        "trigger_zone_x": 2,
        "trigger_zone_y": 8.5,
        "trigger_zone_radius": 2,
    }
    circle, polygon = problem.obstacles
    assert (circle.vertices_xy.tolist(), circle.radius) == ([[0.0, -2.6]], 1.0)
    assert sorted(polygon.vertices_xy.tolist()) == [[2, 4], [2, 5], [5, 4], [5, 5]]
    assert problem.keys.people == (f"{title}[0].dynamic_obstacles.dynamic_obs_0",)


@pytest.mark.parametrize(
    ("changes", "waypoints"),
    [
        ({}, [[4, 3], [5, 3], [4, 3], [4, 9]]),
        ({"mode": "loop"}, [[4, 3], [5, 3], [4, 9]]),
        ({"waypoints": [[0, -6, 0]]}, [[4, 3], [4, 9]]),
        ({"is_waypoint_relative": False}, [[0, -6], [1, -6], [0, -6], [4, 9]]),
        ({"waypoints": []}, []),
        ({"mode": "once", "waypoints": [[0, -6, 0]]}, [[4, 3]]),
        ({"mode": "once"}, [[4, 3], [5, 3], [4, 3], [4, 9]]),
        ({"linear_velocity": 0}, []),
    ],
)
def test_a_way_becomes_a_round(tmp_path: Path, changes: dict[str, Any], waypoints: list[list[float]]) -> None:
    (problem,) = read(tmp_path, {"scenarios": [disc(**changes)]})
    assert problem.pedestrians[0].waypoints_xy.tolist() == waypoints
    assert problem.pedestrians[0].waypoints_xy.shape == (len(waypoints), 2)
    assert problem.pedestrians[0].desired_speed > 0.0


def test_without_a_trigger_a_person_starts_at_once(tmp_path: Path) -> None:
    for triggers in ({"triggers": []}, {}):
        content = {**{key: value for key, value in DISC.items() if key != "triggers"}, **triggers}
        (problem,) = read(tmp_path, {"scenarios": [scene(dynamic_obstacles=[content])]})
        assert problem.pedestrians[0].behaviour == {}


def test_several_watchers_are_several_zones(tmp_path: Path) -> None:
    (problem,) = read(tmp_path, {"scenarios": [disc(triggers=["watcher_1", "watcher_0"])]})
    assert problem.pedestrians[0].behaviour == {
        "start_up_mode": "trigger_zone",
        **{"trigger_zone_x": 9, "trigger_zone_y": 9, "trigger_zone_radius": 1},
        **{"trigger_zone_2_x": 2, "trigger_zone_2_y": 8.5, "trigger_zone_2_radius": 2},
    }


def test_what_goes_only_once_is_noted_where_it_goes_to_and_fro(tmp_path: Path) -> None:
    notes = [
        read(tmp_path, {"scenarios": [disc(mode="once", waypoints=ways)]})[0].notes
        for ways in ([[0, -6, 0]], DISC["waypoints"])
    ]
    assert notes == [(), ("mode once goes to and fro here where it has several waypoints",)]


def test_pedestrians_keys_are_renamed_and_their_amount_counts(tmp_path: Path) -> None:
    own = {
        "amount": 3,
        "chatting_probability": 0.2,
        "obstacle_force_factor": 4,
        "desire_force_factor": 2,
        "triggers": [],
    }
    (problem,) = read(tmp_path, {"scenarios": [disc(**own)]})
    assert len(problem.pedestrians) == 3
    assert problem.pedestrians[2].behaviour == {
        "chatting_probability": 0.2,
        "force_factor_obstacle": 4,
        "force_factor_desired": 2,
    }


def test_scenes_that_are_switched_off_are_left_out_and_equal_names_are_told_apart(tmp_path: Path) -> None:
    scenes = [SCENE, scene(repeats=0), scene(repeats=-1, scene_name="off"), scene(scene_name="yard"), SCENE]
    assert [(p.name, p.repeats) for p in read(tmp_path, {"scenarios": scenes})] == [
        ("hall", 5),
        ("yard", 5),
        ("hall-2", 5),
    ]


def test_it_survives_our_own_format(tmp_path: Path) -> None:
    problems = read(tmp_path, {"scenarios": [SCENE, scene(scene_name="yard", repeats=1)]})
    save_scenarios(tmp_path / "ours.json", problems)
    again = read_scenario_file(tmp_path / "ours.json", DEFAULTS).problems
    for given, found in zip(problems, again, strict=True):
        assert (given.name, given.start, given.goal, given.repeats) == (
            found.name,
            found.start,
            found.goal,
            found.repeats,
        )
        assert [p.waypoints_xy.tolist() for p in given.pedestrians] == [
            p.waypoints_xy.tolist() for p in found.pedestrians
        ]
        assert [p.behaviour for p in given.pedestrians] == [p.behaviour for p in found.pedestrians]
        assert [o.vertices_xy.tolist() for o in given.obstacles] == [o.vertices_xy.tolist() for o in found.obstacles]


def changed(*keys: str, value: object) -> Callable[[], dict[str, Any]]:
    def content() -> dict[str, Any]:
        made = copy.deepcopy(SCENE)
        place = made
        for key in keys[:-1]:
            place = place[key]
        place[keys[-1]] = value
        return made

    return content


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (changed("repeats", value="many"), r'scenarios\[0\]\.repeats is "many"; allowed: a whole number'),
        (changed("repeats", value=0), r"scenarios is .*; allowed: at least one scene with repeats above 0"),
        (changed("scene_name", value=""), r'scene_name is ""; allowed: a text'),
        (changed("robot", "start_pos", value=[1]), r"robot\.start_pos is \[1\]; allowed: \[x, y\] or \[x, y, theta\]"),
        (
            changed("static_obstacles", "static_obs_0", "shape", value="box"),
            r'static_obs_0\.shape is "box"; allowed: circle or polygon',
        ),
        (
            changed("static_obstacles", "static_obs_0", "radius", value=0),
            r"static_obs_0\.radius is 0; allowed: a number > 0",
        ),
        (
            changed("static_obstacles", "static_obs_1", "vertices", value=[[0, 0], [1, 1]]),
            r"vertices is .*; allowed: three or more",
        ),
        (
            changed("dynamic_obstacles", "dynamic_obs_0", "mode", value="back"),
            r'dynamic_obs_0\.mode is "back"; allowed: yoyo, loop, once',
        ),
        (
            changed("dynamic_obstacles", "dynamic_obs_0", "triggers", value=["gone"]),
            r'triggers\[0\] is "gone"; allowed: watcher_0, watcher_1',
        ),
        (
            changed("dynamic_obstacles", "dynamic_obs_0", "triggers", value=["watcher_0"] * 9),
            r"triggers is .*; allowed: at most 8 watchers",
        ),
        (
            changed("dynamic_obstacles", "dynamic_obs_0", "is_waypoint_relative", value=1),
            r"is 1; allowed: true or false",
        ),
        (
            changed("dynamic_obstacles", "dynamic_obs_0", "linear_velocity", value=-1),
            r"linear_velocity is -1; allowed: a number >= 0",
        ),
        (
            changed("watchers", "watcher_0", "range", value=-1),
            r"watchers\.watcher_0\.range is -1; allowed: a number >= 0",
        ),
        (changed("watchers", value={}), r'triggers\[0\] is "watcher_0"; allowed: no trigger'),
    ],
)
def test_wrong_value_says_file_key_and_what_is_allowed(
    tmp_path: Path, content: Callable[[], dict[str, Any]], said: str
) -> None:
    with pytest.raises(InputFileError, match=rf"scenes\.json: .*{said}") as error:
        read(tmp_path, {"scenarios": [content()]})
    assert "\n" not in str(error.value)
