"""Scenario files go from format to format and come back; a spoilt file of any format is one line."""

import copy
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from arena_core import InputFileError, Obstacle, PedestrianSpec, Pose
from arena_core.cli.main import main
from arena_tasks.scenario_files.arena_rosnav_writer import arena_rosnav_text, world_name
from arena_tasks.scenario_files.arena_tools_writer import (
    AGENT,
    arena_tools_text,
    flatland_model_text,
    unsupported_parts,
)
from arena_tasks.scenario_files.problem import Keys, PersonDefaults, Problem
from arena_tasks.scenario_files.scenario_file import read_scenario_file, read_scenarios, save_scenarios

TOP = Path(__file__).parents[3]
FILES = sorted(
    path
    for data in (TOP / "tests" / "data", TOP.parent / "shared" / "data")
    for path in (data / "scenarios").rglob("*.json")
)
DEFAULTS = PersonDefaults(0.5, 0.3)
KEYS_OF_AN_AGENT = [
    "name",
    "id",
    "pos",
    "type",
    "yaml_file",
    "number_of_peds",
    "vmax",
    *list(AGENT)[1:],
    "waypoints",
    "waypoint_mode",
]

coordinates = st.floats(-100, 100).map(lambda value: round(value, 3))
positions = st.tuples(coordinates, coordinates).map(np.array)
behaviours = st.fixed_dictionaries(
    {},
    optional={
        "type": st.sampled_from(["adult", "child", "forklift"]),
        "waypoint_mode": st.just(1.0),
        "group": st.text(max_size=3),
        **{key: st.floats(0, 9) for key in list(AGENT)[2:]},
    },
)


@st.composite
def people(draw: st.DrawFn) -> PedestrianSpec:
    waypoints = np.array(draw(st.lists(positions, max_size=4))).reshape(-1, 2)
    return PedestrianSpec(0, draw(positions), waypoints, draw(st.floats(0.01, 3)), 0.3, draw(behaviours))


@st.composite
def obstacles(draw: st.DrawFn) -> Obstacle:
    if draw(st.booleans()):
        return Obstacle(draw(positions)[None], draw(st.floats(0.1, 3)))
    angles = np.sort(draw(st.lists(st.floats(0, 6), min_size=3, max_size=12, unique_by=lambda angle: round(angle, 2))))
    reach = draw(st.floats(1, 3)) * np.where(np.arange(len(angles)) % 2, 1.0, draw(st.floats(0.4, 1.0)))
    ring = np.stack((reach * np.cos(angles), reach * np.sin(angles)), axis=1) + draw(positions)
    return Obstacle(
        ring
        if shapely.Polygon(ring).is_valid and shapely.Polygon(ring).area > 0.01
        else np.array([[0, 0], [1, 0], [0, 1.0]])
    )


@st.composite
def problems(draw: st.DrawFn) -> Problem:
    crowd = tuple(
        PedestrianSpec(k, p.position_xy, p.waypoints_xy, p.desired_speed, p.radius, p.behaviour)
        for k, p in enumerate(draw(st.lists(people(), max_size=3)))
    )
    ends = [Pose(*draw(positions).tolist()) for _ in range(2)]
    return Problem(
        "site",
        *ends,
        crowd,
        tuple(draw(st.lists(obstacles(), max_size=2))),
        None,
        None,
        Keys("", "", ()),
        draw(st.integers(1, 30)),
    )


def shape(obstacles: tuple[Obstacle, ...]) -> shapely.Geometry:
    return shapely.union_all(
        [
            shapely.Point(o.vertices_xy[0]).buffer(o.radius) if o.radius else shapely.Polygon(o.vertices_xy)
            for o in obstacles
        ]
    )


@given(problem=problems())
@settings(deadline=None, max_examples=60)
def test_a_problem_survives_arena_tools(tmp_path_factory: pytest.TempPathFactory, problem: Problem) -> None:
    folder = tmp_path_factory.getbasetemp()
    names = [f"model_{number}.yaml" for number in range(len(problem.obstacles))]
    for name, obstacle in zip(names, problem.obstacles, strict=True):
        (folder / name).write_text(flatland_model_text(obstacle))
    (folder / "site.json").write_text(arena_tools_text(problem, "maps/site/map.yaml", names))
    (found,) = read_scenarios(folder / "site.json", DEFAULTS)
    assert (found.name, found.start, found.goal, found.repeats) == (
        problem.name,
        problem.start,
        problem.goal,
        problem.repeats,
    )
    for given_person, person in zip(problem.pedestrians, found.pedestrians, strict=True):
        assert person.id == given_person.id
        assert person.position_xy.tolist() == given_person.position_xy.tolist()
        assert person.waypoints_xy.tolist() == given_person.waypoints_xy.tolist()
        assert person.desired_speed == given_person.desired_speed
        assert person.behaviour == {**AGENT, **given_person.behaviour}
    assert shape(found.obstacles).symmetric_difference(shape(problem.obstacles)).area < 1e-6
    assert unsupported_parts(problem) == []


@given(problem=problems())
@settings(deadline=None, max_examples=60)
def test_a_problem_survives_arena_rosnav(tmp_path_factory: pytest.TempPathFactory, problem: Problem) -> None:
    folder = tmp_path_factory.getbasetemp()
    names = [f"rosnav_{number}" for number in range(len(problem.obstacles))]
    for name, obstacle in zip(names, problem.obstacles, strict=True):
        (folder / f"{name}.model.yaml").write_text(flatland_model_text(obstacle))
    (folder / "site.json").write_text(arena_rosnav_text(problem, "hall", names))
    (found,) = read_scenarios(folder / "site.json", DEFAULTS)
    assert (found.name, found.start, found.goal, found.repeats, found.notes) == (
        "site",
        problem.start,
        problem.goal,
        problem.repeats,
        (),
    )
    for given_person, person in zip(problem.pedestrians, found.pedestrians, strict=True):
        assert person.position_xy.tolist() == given_person.position_xy.tolist()
        assert person.waypoints_xy.tolist() == given_person.waypoints_xy.tolist()
        assert person.desired_speed == given_person.desired_speed
        assert person.behaviour == {"type": "adult", **given_person.behaviour}
    assert shape(found.obstacles).symmetric_difference(shape(problem.obstacles)).area < 1e-6


@pytest.mark.parametrize(
    ("path", "name"),
    [
        ("worlds/hall/map/map.yaml", "hall"),
        ("/a/hall/map.yaml", "hall"),
        ("hall.yaml", ""),
        ("", ""),
        ("C:\\hall\\m.yaml", "hall"),
    ],
)
def test_a_world_is_called_as_the_folder_of_its_map(path: str, name: str) -> None:
    assert world_name(path) == name


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.name)
def test_every_published_scenario_goes_to_our_format_and_back_key_for_key(tmp_path: Path, path: Path) -> None:
    assert main(["scenario", "convert", str(path), str(tmp_path / "ours.json")]) == 0
    assert (
        main(["scenario", "convert", str(tmp_path / "ours.json"), str(tmp_path / "theirs.json"), "format=arena-tools"])
        == 0
    )
    given_file, found = json.loads(path.read_text()), json.loads((tmp_path / "theirs.json").read_text())
    for key in ("robot_position", "robot_goal"):
        assert found[key] == given_file[key]
    assert found["resets"] == given_file.get("resets", 1)
    for agent, given_agent in zip(found["pedsim_agents"], given_file["pedsim_agents"], strict=True):
        assert list(agent) == list(given_agent) == KEYS_OF_AN_AGENT
        assert Path(agent["yaml_file"]).name == Path(given_agent["yaml_file"]).name
        assert {k: v for k, v in agent.items() if k not in ("name", "yaml_file")} == {
            k: v for k, v in given_agent.items() if k not in ("name", "yaml_file")
        }


def problem(**changes: Any) -> Problem:
    usual = {
        "name": "hall",
        "start": Pose(0.0, 1.0),
        "goal": Pose(8.0, 1.0),
        "pedestrians": (
            PedestrianSpec(0, np.array([4.0, 4.0]), np.array([[4.0, 8.0], [4.0, 4.0]]), 0.4, 0.3, {"type": "child"}),
        ),
        "obstacles": (Obstacle(np.array([[6.0, 6.0]]), 0.5),),
        "goal_radius": None,
        "time_limit": None,
        "keys": Keys("", "", ()),
    }
    return Problem(**{**usual, **changes})


def test_what_the_format_has_no_place_for_is_said(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    big = PedestrianSpec(1, np.array([1.0, 4.0]), np.empty((0, 2)), 0.4, 0.5, {"trigger_zone_x": 1.0})
    full = problem(
        start=Pose(0, 1, 2),
        goal=Pose(8, 1, 1),
        goal_radius=0.5,
        time_limit=9.0,
        pedestrians=(*problem().pedestrians, big),
    )
    save_scenarios(tmp_path / "ours.json", [full])
    assert (
        main(["scenario", "convert", str(tmp_path / "ours.json"), str(tmp_path / "out.json"), "format=arena-tools"])
        == 0
    )
    said = capsys.readouterr().out.splitlines()
    assert said[0] == f"written: {tmp_path / 'out.obstacle_0.model.yaml'}"
    assert said[1:6] == [
        f"left out: {what}"
        for what in ("the start's heading", "the goal's heading", "goal_radius", "time_limit", "the radii of people")
    ]
    assert said[6].startswith("left out: where trigger zones lie")
    assert said[7] == f"written: {tmp_path / 'out.json'}"


def test_one_of_several_problems_is_chosen_and_the_map_is_named_from_the_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    save_scenarios(tmp_path / "ours.json", [problem(), problem(name="yard", obstacles=())], "A hall", "maps/hall.yaml")
    (tmp_path / "sub").mkdir()
    assert main(["scenario", "convert", "ours.json", "sub/yard.json", "problem=yard"]) == 0
    file = read_scenario_file(Path("sub/yard.json"), DEFAULTS)
    assert ([p.name for p in file.problems], file.title, file.map) == (["yard"], "A hall", "../maps/hall.yaml")
    assert main(["scenario", "convert", "ours.json", "sub/theirs.json", "problem=yard", "format=arena-tools"]) == 0
    assert json.loads(Path("sub/theirs.json").read_text())["map_path"] == "maps/hall.yaml"
    assert main(["scenario", "convert", "sub/theirs.json", "sub/again.json", "map=maps/hall.yaml"]) == 0
    assert read_scenario_file(Path("sub/again.json"), DEFAULTS).map == "../maps/hall.yaml"


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["ours.json"], "arguments are ours.json; allowed: arena scenario convert IN out=FILE"),
        (
            ["ours.json", "out.json", "format=yaml"],
            "format is 'yaml'; allowed: one of arena-scenario, arena-tools, arena-rosnav",
        ),
        (
            ["ours.json", "out.json", "maps=a"],
            "there is no key maps; did you mean map? allowed: arena scenario convert IN out=FILE [format=",
        ),
        (["ours.json", "out.json", "problem="], "problem is empty; allowed"),
        (["ours.json", "out.json", "problem=gone"], "problem is gone; allowed, in ours.json: hall, yard"),
        (
            ["ours.json", "out.json", "format=arena-tools"],
            "ours.json holds 2 problems; allowed in format arena-tools: one",
        ),
        (["gone.json", "out.json"], "gone.json: cannot be read"),
        (["ours.json", "ours.json/out.json"], "cannot write ours.json/out.json"),
    ],
)
def test_what_cannot_be_converted_is_said_in_one_line(
    tmp_path, monkeypatch, capsys, words: list[str], said: str
) -> None:
    monkeypatch.chdir(tmp_path)
    save_scenarios(tmp_path / "ours.json", [problem(), problem(name="yard")])
    assert main(["scenario", "convert", *words]) == 2
    shown = capsys.readouterr().err
    assert said in shown
    assert shown.count("\n") == 1
    assert sorted(path.name for path in tmp_path.iterdir()) == ["ours.json"]


def test_show_tells_problems_and_people(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    save_scenarios(
        tmp_path / "ours.json",
        [problem(repeats=4), problem(name="yard", pedestrians=(), time_limit=60.0)],
        "A hall",
        "hall.yaml",
    )
    assert main(["scenario", "show", str(tmp_path / "ours.json")]) == 0
    lines = [line.split() for line in capsys.readouterr().out.splitlines()]
    assert lines[0][-2:] == ["A", "hall"]
    assert lines[1] == ["map:", "hall.yaml"]
    assert ["hall", "4", "(0.00,", "1.00)", "(8.00,", "1.00)", "8.0", "m", "1", "1", "the", "task's"] in lines
    assert ["yard", "1", "(0.00,", "1.00)", "(8.00,", "1.00)", "8.0", "m", "0", "1", "60", "s"] in lines
    assert ["hall", "0", "(4.00,", "4.00)", "2", "8.0", "m", "0.4", "m/s", "0.3", "m", "type=child"] in lines
    assert main(["scenario", "show"]) == 2


@pytest.mark.parametrize("name", ["check", "convert", "show"])
def test_a_subcommand_tells_how_it_is_used(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["scenario", name, "--help"]) == 0
    assert f"arena scenario {name}" in capsys.readouterr().out


SAMPLES: dict[str, Callable[[], dict[str, Any]]] = {
    "ours": lambda: {
        "format": "arena-scenario",
        "version": 2,
        "title": "t",
        "map": "m.yaml",
        "scenarios": [
            {
                "name": "a",
                "repeats": 2,
                "start": [0, 0, 0],
                "goal": [1, 1],
                "goal_radius": 0.3,
                "time_limit": 9,
                "pedestrians": [
                    {
                        "position": [1, 2],
                        "waypoints": [[1, 2]],
                        "desired_speed": 1,
                        "radius": 0.3,
                        "behaviour": {"type": "adult"},
                    }
                ],
                "obstacles": [{"center": [0, 0], "radius": 1}, {"vertices": [[0, 0], [1, 0], [0, 1]]}],
            }
        ],
    },
    "arena-tools": lambda: json.loads(arena_tools_text(problem(), "a/b.yaml", ["model.yaml"])),
    "arena-rosnav": lambda: json.loads(arena_rosnav_text(problem(), "hall", ["model"])),
    "flatland": lambda: {
        "scenerios": [
            {
                "scene_name": "a",
                "repeats": 1,
                "dynamic_obstacles": {
                    "d": {
                        "obstacle_radius": 0.3,
                        "linear_velocity": 0.2,
                        "start_pos": [0, 3, 0],
                        "waypoints": [[0, 7, 0]],
                        "is_waypoint_relative": True,
                        "mode": "yoyo",
                        "triggers": ["w"],
                        "amount": 2,
                    }
                },
                "static_obstacles": {
                    "s": {"shape": "circle", "x": 0, "y": 1, "radius": 1},
                    "p": {"shape": "polygon", "vertices": [[0, 0], [1, 0], [0, 1]]},
                },
                "robot": {"start_pos": [0, 0, 0], "goal_pos": [1, 1, 0]},
                "watchers": {"w": {"pos": [1, 1], "range": 2}},
            }
        ]
    },
}
values = st.recursive(
    st.none()
    | st.booleans()
    | st.integers()
    | st.just(10**400)
    | st.floats()
    | st.text(max_size=4)
    | st.sampled_from(["circle", "..", "\0"]),
    lambda inner: (
        st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=3) | st.just("a\nb"), inner, max_size=2)
    ),
    max_leaves=5,
)


def places(value: Any, at: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    """Return where the values inside a value stand."""
    inner = (
        list(value.items()) if isinstance(value, dict) else list(enumerate(value)) if isinstance(value, list) else []
    )
    return [found for key, member in inner for found in [(*at, key), *places(member, (*at, key))]]


def spoilt(content: Any, picks: list[tuple[int, Any]]) -> Any:
    """Return a copy in which some values are others, or are gone where the other is the word DELETED."""
    content = copy.deepcopy(content)
    for pick, value in picks:
        found = places(content)
        if not found:
            break
        *way, last = found[pick % len(found)]
        parent = content
        for key in way:
            parent = parent[key]
        if value == "DELETED":
            del parent[last]
        else:
            parent[last] = value
    return content


def refusal(path: Path) -> str | None:
    try:
        read_scenario_file(path, DEFAULTS)
    except InputFileError as error:
        return str(error)
    return None


@pytest.mark.parametrize("name", SAMPLES)
@given(picks=st.lists(st.tuples(st.integers(0, 10_000), st.just("DELETED") | values), min_size=1, max_size=3))
@settings(deadline=None, max_examples=150)
def test_a_spoilt_file_is_read_or_refused_in_one_line_with_its_name(
    tmp_path_factory: pytest.TempPathFactory, name: str, picks
) -> None:
    folder = tmp_path_factory.getbasetemp()
    (folder / "model.yaml").write_text(flatland_model_text(problem().obstacles[0]))
    path = folder / "spoilt.json"
    path.write_text(json.dumps(spoilt(SAMPLES[name](), picks)))
    said = refusal(path)
    assert said is None or (str(path) in said and "\n" not in said)


@pytest.mark.parametrize("name", SAMPLES)
def test_an_unspoilt_sample_is_read(tmp_path: Path, name: str) -> None:
    (tmp_path / "model.yaml").write_text(flatland_model_text(problem().obstacles[0]))
    (tmp_path / "whole.json").write_text(json.dumps(SAMPLES[name]()))
    assert refusal(tmp_path / "whole.json") is None


@given(content=st.binary(max_size=80) | st.text(max_size=80).map(str.encode))
@settings(deadline=None)
def test_any_bytes_are_refused_in_one_line(tmp_path_factory: pytest.TempPathFactory, content: bytes) -> None:
    path = tmp_path_factory.getbasetemp() / "bytes.json"
    path.write_bytes(content)
    said = refusal(path)
    assert said is not None
    assert str(path) in said
    assert "\n" not in said


@given(
    picks=st.lists(st.tuples(st.integers(0, 10_000), st.just("DELETED") | values), min_size=1, max_size=2),
    text=st.none() | st.text(max_size=40),
)
@settings(deadline=None)
def test_a_spoilt_flatland_model_is_read_or_refused_in_one_line(
    tmp_path_factory: pytest.TempPathFactory, picks, text: str | None
) -> None:
    folder = tmp_path_factory.getbasetemp()
    whole = {
        "bodies": [
            {
                "pose": [0, 0, 0],
                "footprints": [
                    {"type": "polygon", "points": [[0, 0], [1, 0], [0, 1]]},
                    {"type": "circle", "radius": 1},
                ],
            }
        ]
    }
    content = json.dumps(spoilt(whole, picks)) if text is None else text
    (folder / "spoilt_model.yaml").write_text(content)
    (folder / "uses_it.json").write_text(arena_tools_text(problem(), "", ["spoilt_model.yaml"]))
    said = refusal(folder / "uses_it.json")
    assert said is None or ("spoilt_model.yaml" in said and "\n" not in said)
