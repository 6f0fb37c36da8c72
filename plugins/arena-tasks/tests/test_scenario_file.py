"""Our scenario format is read strictly, written back unchanged, and each slip is one line with file and key."""

import copy
import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arena_core import InputFileError, Obstacle, PedestrianSpec, Pose, Scenario, World, testing
from arena_core.hosting import RunFolderError
from arena_tasks.scenario_files.problem import PersonDefaults, Problem
from arena_tasks.scenario_files.scenario_file import read_scenario_file, read_scenarios, save_scenarios

EXACT = settings(derandomize=True, deadline=None, max_examples=60)
DEFAULTS = PersonDefaults(0.3, 0.25)
GOOD: dict[str, Any] = {
    "format": "arena-scenario",
    "version": 2,
    "title": "Two problems",
    "map": "room.yaml",
    "scenarios": [
        {
            "name": "crossing",
            "start": [0.0, 0.5, 1.5],
            "goal": [3, 1],
            "goal_radius": 0.4,
            "time_limit": 60,
            "pedestrians": [
                {"position": [1, 1]},
                {
                    "position": [2.0, 2.0],
                    "waypoints": [[2.0, 0.0], [2.0, 2.0]],
                    "desired_speed": 1.2,
                    "radius": 0.35,
                    "behaviour": {"force_factor_social": 2, "type": "elder"},
                },
            ],
            "obstacles": [{"center": [0.0, -2.0], "radius": 0.5}, {"vertices": [[-1, -1], [-2, -1], [-2, -2]]}],
        },
        {"name": "nobody", "start": [0, 0], "goal": [1, 1]},
    ],
}


def write(folder: Path, content: object) -> Path:
    path = folder / "problem.json"
    path.write_text(content if isinstance(content, str) else json.dumps(content))
    return path


def as_scenario(problem: Problem) -> Scenario:
    return Scenario(
        problem.name,
        0,
        World("room", testing.room()),
        problem.start,
        problem.goal,
        problem.pedestrians,
        problem.obstacles,
        0.3,
        180.0,
    )


def people(problem: Scenario | Problem) -> list[object]:
    return [
        (p.id, p.position_xy.tolist(), p.waypoints_xy.tolist(), p.desired_speed, p.radius, p.behaviour)
        for p in problem.pedestrians
    ]


def obstacles(problem: Scenario | Problem) -> list[object]:
    return [(o.vertices_xy.tolist(), o.radius) for o in problem.obstacles]


def test_the_former_name_of_the_desired_speed_is_read(tmp_path: Path) -> None:
    content = copy.deepcopy(GOOD)
    person = content["scenarios"][0]["pedestrians"][1]
    person["max_speed"] = person.pop("desired_speed")
    (crossing, _) = read_scenarios(write(tmp_path, content), DEFAULTS)
    assert crossing.pedestrians[1].desired_speed == 1.2


def test_every_key_is_read(tmp_path: Path) -> None:
    crossing, nobody = read_scenarios(write(tmp_path, GOOD), DEFAULTS)
    assert (crossing.name, crossing.start, crossing.goal) == ("crossing", Pose(0.0, 0.5, 1.5), Pose(3.0, 1.0))
    assert (crossing.goal_radius, crossing.time_limit) == (0.4, 60.0)
    assert people(crossing) == [
        (0, [1.0, 1.0], [], 0.3, 0.25, {}),
        (1, [2.0, 2.0], [[2.0, 0.0], [2.0, 2.0]], 1.2, 0.35, {"force_factor_social": 2.0, "type": "elder"}),
    ]
    assert obstacles(crossing) == [([[0.0, -2.0]], 0.5), ([[-1.0, -1.0], [-2.0, -1.0], [-2.0, -2.0]], 0.0)]
    assert (nobody.goal_radius, nobody.time_limit, nobody.pedestrians, nobody.obstacles) == (None, None, (), ())
    assert crossing.pedestrians[0].waypoints_xy.shape == (0, 2)


NUMBER = st.floats(-1e6, 1e6)
POINT = st.tuples(NUMBER, NUMBER)
SIZE = st.floats(0.01, 100.0)
PERSON = st.builds(
    lambda position, waypoints, speed, radius, behaviour: (position, waypoints, speed, radius, behaviour),
    POINT,
    st.lists(POINT, max_size=4),
    SIZE,
    SIZE,
    st.dictionaries(st.text(min_size=1, max_size=6), NUMBER | st.text(max_size=6), max_size=3),
)


@EXACT
@given(
    st.text(min_size=1, max_size=20),
    POINT,
    POINT,
    st.lists(PERSON, max_size=3),
    st.lists(st.tuples(POINT, SIZE), max_size=3),
    SIZE,
)
def test_what_is_saved_is_read_back(
    tmp_path_factory: pytest.TempPathFactory,
    name: str,
    start: tuple[float, float],
    goal: tuple[float, float],
    crowd: list[tuple[Any, ...]],
    discs: list[tuple[tuple[float, float], float]],
    size: float,
) -> None:
    scenario = Scenario(
        name=name,
        seed=3,
        world=World("room", testing.room()),
        start=Pose(*start, 0.1),
        goal=Pose(*goal, -1.0),
        pedestrians=tuple(
            PedestrianSpec(k, np.array(at), np.array(to).reshape(-1, 2), speed, radius, behaviour)
            for k, (at, to, speed, radius, behaviour) in enumerate(crowd)
        ),
        obstacles=(
            *(Obstacle(np.array([center]), radius) for center, radius in discs),
            Obstacle(np.array([(0.0, 0.0), (size, 0.0), (size, size), (0.1 * size, 0.3 * size)])),
        ),
        goal_radius=size,
        time_limit=10.0 * size,
    )
    path = tmp_path_factory.mktemp("saved") / "saved.json"
    save_scenarios(path, [scenario])
    (found,) = read_scenarios(path, DEFAULTS)
    assert (found.name, found.start, found.goal) == (scenario.name, scenario.start, scenario.goal)
    assert (found.goal_radius, found.time_limit) == (scenario.goal_radius, scenario.time_limit)
    assert people(found) == people(scenario)
    assert obstacles(found) == obstacles(scenario)
    assert [file.name for file in path.parent.iterdir()] == ["saved.json"]


@EXACT
@given(
    st.lists(st.integers(1, 1000), min_size=1, max_size=4),
    st.text(min_size=1, max_size=20),
    st.text(min_size=1, max_size=20),
)
def test_problems_with_repeats_title_and_map_are_read_back(
    tmp_path_factory: pytest.TempPathFactory, repeats: list[int], title: str, map_file: str
) -> None:
    path = tmp_path_factory.mktemp("saved") / "saved.json"
    (problem, *_) = read_scenarios(write(path.parent, GOOD), DEFAULTS)
    problems = [replace(problem, name=f"problem {k}", repeats=times) for k, times in enumerate(repeats)]
    save_scenarios(path, problems, title, map_file)
    found = read_scenario_file(path, DEFAULTS)
    assert (found.title, found.map) == (title, map_file)
    assert [(p.name, p.repeats) for p in found.problems] == [(p.name, p.repeats) for p in problems]
    assert all(people(p) == people(problem) and p.goal_radius == problem.goal_radius for p in found.problems)


def test_files_of_the_first_version_are_read(tmp_path: Path) -> None:
    old = {key: value for key, value in GOOD.items() if key not in ("title", "map")}
    assert [p.repeats for p in read_scenarios(write(tmp_path, {**old, "version": 1}), DEFAULTS)] == [1] * len(
        GOOD["scenarios"]
    )


def test_writing_where_nothing_can_be_written_is_one_line(tmp_path: Path) -> None:
    scenario = as_scenario(read_scenarios(write(tmp_path, GOOD), DEFAULTS)[0])
    (tmp_path / "file").touch()
    with pytest.raises(RunFolderError, match=r"cannot write .*saved\.json: "):
        save_scenarios(tmp_path / "file" / "saved.json", [scenario])


def broken(change: Callable[[dict[str, Any]], object]) -> dict[str, Any]:
    content: dict[str, Any] = json.loads(json.dumps(GOOD))
    change(content)
    return content


def first(content: dict[str, Any]) -> dict[str, Any]:
    return content["scenarios"][0]  # type: ignore[no-any-return]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda c: c.update(version=3), "version is 3; allowed: 1 or 2"),
        (lambda c: c.pop("version"), "version is missing"),
        (lambda c: c.update(maps="x"), "maps is unknown; allowed: format, version, title, card, map, scenarios"),
        (lambda c: c.update(map=3), "map is 3; allowed: a text"),
        (lambda c: first(c).update(repeats=0), r"scenarios\[0\]\.repeats is 0; allowed: a whole number 1"),
        (lambda c: c.update(scenarios={}), r"scenarios is \{\}; allowed: a list"),
        (lambda c: c.update(scenarios=[]), r"scenarios is \[\]; allowed: at least one"),
        (lambda c: c.update(scenarios=[3]), r"scenarios\[0\] is 3; allowed: a mapping"),
        (lambda c: first(c).update(name=""), r'scenarios\[0\]\.name is ""; allowed: a text'),
        (lambda c: first(c).update(name="nobody"), r'scenarios\[1\]\.name is "nobody"; allowed: names that differ'),
        (lambda c: first(c).pop("start"), r"scenarios\[0\]\.start is missing"),
        (lambda c: first(c).update(start=[1]), r"scenarios\[0\]\.start is \[1\]; allowed: \[x, y\] or \[x, y, theta\]"),
        (lambda c: first(c).update(start=[1, "2"]), r'scenarios\[0\]\.start\[1\] is "2"; allowed: a finite number'),
        (
            lambda c: first(c).update(start=[1, 10**400]),
            r"scenarios\[0\]\.start\[1\] is 1000+\.\.\.0+; allowed: a finite number",
        ),
        (
            lambda c: first(c).update(start=[1, -1e300]),
            r"scenarios\[0\]\.start\[1\] is -1e\+300; allowed: a coordinate within 1e\+06 m",
        ),
        (lambda c: first(c).update(goal={"x": 1}), r"scenarios\[0\]\.goal is .*; allowed: a list"),
        (lambda c: first(c).update(goal_radius=0), r"scenarios\[0\]\.goal_radius is 0; allowed: a number > 0"),
        (lambda c: first(c).update(time_limit=True), r"scenarios\[0\]\.time_limit is true; allowed: a number > 0"),
        (
            lambda c: first(c).update(robot=[]),
            r"scenarios\[0\]\.robot is unknown; allowed: name, repeats, start, goal",
        ),
        (
            lambda c: first(c)["pedestrians"][0].pop("position"),
            r"scenarios\[0\]\.pedestrians\[0\]\.position is missing",
        ),
        (
            lambda c: first(c)["pedestrians"][1].update(desired_speed=-1),
            r"pedestrians\[1\]\.desired_speed is -1; allowed: a number > 0",
        ),
        (
            lambda c: first(c)["pedestrians"][1].update(max_speed=1.0),
            r"pedestrians\[1\]\.max_speed is 1\.0; allowed: desired_speed alone",
        ),
        (
            lambda c: first(c)["pedestrians"][1].update(radius=0),
            r"pedestrians\[1\]\.radius is 0; allowed: a number > 0",
        ),
        (lambda c: first(c)["pedestrians"][1].update(speed=1), r"pedestrians\[1\]\.speed is unknown"),
        (
            lambda c: first(c)["pedestrians"][1].update(waypoints=[[1, 2, 3]]),
            r"waypoints\[0\] is \[1, 2, 3\]; allowed: \[x, y\]",
        ),
        (
            lambda c: first(c)["pedestrians"][1].update(behaviour={"a": None}),
            r"behaviour\.a is null; allowed: a finite number",
        ),
        (lambda c: first(c)["obstacles"][0].update(radius=-1), r"obstacles\[0\]\.radius is -1; allowed: a number > 0"),
        (lambda c: first(c)["obstacles"][0].pop("radius"), r"obstacles\[0\]\.radius is missing"),
        (
            lambda c: first(c)["obstacles"][1].update(vertices=[[0, 0], [1, 1]]),
            r"obstacles\[1\]\.vertices is .*; allowed: three or more",
        ),
        (
            lambda c: first(c)["obstacles"][1].update(vertices=[[0, 0], [1, 1], [1, 0], [0, 1]]),
            r"vertices: Self-intersection.*simple polygon",
        ),
        (
            lambda c: first(c)["obstacles"][1].update(vertices=[[0, 0], [1, 1], [2, 2]]),
            r"obstacles\[1\]\.vertices: .*simple polygon",
        ),
        (lambda c: c.update(format="other"), "has neither format: arena-scenario nor pedsim_agents"),
        (
            lambda c: first(c).update(name="a\ud800b"),
            r"scenarios\[0\]\.name is .*; allowed: a text of whole characters",
        ),
        (lambda c: c.update(title="\udfff"), r"title is .*; allowed: a text of whole characters"),
    ],
)
def test_wrong_value_says_file_key_and_what_is_allowed(
    tmp_path: Path, change: Callable[[dict[str, Any]], object], message: str
) -> None:
    with pytest.raises(InputFileError, match=rf"problem\.json: .*{message}") as caught:
        read_scenarios(write(tmp_path, broken(change)), DEFAULTS)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("", "is no JSON .line 1, column 1"),
        ('{"a": 1,}', "is no JSON .line 1"),
        ('{"a": 1, "a": 2}', "a key is there twice among a, a"),
        ('{"format": NaN}', "NaN is no number of JSON"),
        ("[1]", r"content is \[1\]; allowed: a mapping"),
        ("[" * 100_000, "is no JSON"),
    ],
)
def test_malformed_json_is_one_line(tmp_path: Path, content: str, message: str) -> None:
    with pytest.raises(InputFileError, match=rf"problem\.json: .*{message}") as caught:
        read_scenarios(write(tmp_path, content), DEFAULTS)
    assert "\n" not in str(caught.value)


def test_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputFileError, match=r"gone\.json: cannot be read \(No such file or directory\)"):
        read_scenarios(tmp_path / "gone.json", DEFAULTS)


ANYTHING = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False, allow_infinity=False) | st.text(max_size=4),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=4), inner, max_size=3),
    max_leaves=6,
)
PLACES = [("format",), ("version",), ("scenarios",), ("scenarios", 0)] + [
    ("scenarios", 0, *rest)
    for rest in (
        ("name",),
        ("start",),
        ("goal",),
        ("pedestrians",),
        ("pedestrians", 1),
        ("pedestrians", 1, "waypoints"),
        ("obstacles", 1),
    )
]


@EXACT
@given(st.sampled_from(PLACES), ANYTHING)
def test_any_value_is_taken_or_refused_in_one_line(
    tmp_path_factory: pytest.TempPathFactory, place: tuple[str | int, ...], value: object
) -> None:
    def change(content: Any) -> None:
        for key in place[:-1]:
            content = content[key]
        content[place[-1]] = value

    refusal = ""
    try:
        read_scenarios(write(tmp_path_factory.mktemp("any"), broken(change)), DEFAULTS)
    except InputFileError as error:
        refusal = str(error)
    assert "\n" not in refusal
    assert not refusal or "problem.json: " in refusal


@EXACT
@given(st.binary(max_size=40))
def test_any_bytes_are_refused_in_one_line(tmp_path_factory: pytest.TempPathFactory, content: bytes) -> None:
    path = tmp_path_factory.mktemp("bytes") / "problem.json"
    path.write_bytes(content)
    with pytest.raises(InputFileError) as caught:
        read_scenarios(path, DEFAULTS)
    assert "\n" not in str(caught.value)


ROBOTS: list[dict[str, Any]] = [
    {"start": [-2.0, 0.0, 0.0], "goal": [2.0, 0.0]},
    {"start": [2.0, 0.0, 3.0], "goal": [-2.0, 0.0], "planner": "teb", "robot": "jackal"},
    {"name": "last", "start": [0.0, 2.0, 0.0], "goal": [0.0, -2.0]},
]


def of_team(robots: list[dict[str, Any]], **more: Any) -> dict[str, Any]:
    return {"format": "arena-scenario", "version": 2, "scenarios": [{"name": "team", "robots": robots, **more}]}


def test_robots_of_a_team_are_read_and_written_back_unchanged(tmp_path: Path) -> None:
    (problem,) = read_scenarios(write(tmp_path, of_team(ROBOTS)), DEFAULTS)
    assert problem.start == Pose(-2.0, 0.0, 0.0)
    assert [(mate.name, mate.planner, mate.robot) for mate in problem.team] == [
        ("robot1", "teb", "jackal"),
        ("last", "", ""),
    ]
    assert problem.team[1].goal == Pose(0.0, -2.0)
    save_scenarios(tmp_path / "again.json", [problem])
    (again,) = read_scenarios(tmp_path / "again.json", DEFAULTS)
    assert (again.start, again.goal, again.team) == (problem.start, problem.goal, problem.team)


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (
            of_team([{**ROBOTS[0], "planner": "teb"}, ROBOTS[1]]),
            r"robots\[0\]\.planner is unknown; allowed: start, goal",
        ),
        (
            of_team([ROBOTS[0], {**ROBOTS[1], "colour": "red"}]),
            r"robots\[1\]\.colour is unknown; allowed: start, goal",
        ),
        (of_team([*ROBOTS, ROBOTS[2]]), "a name that no other robot has, last is one's"),
        (of_team(ROBOTS[:1]), "allowed: a list of 2 to 200 robots"),
        (of_team(ROBOTS, start=[0.0, 0.0]), "allowed: no robots beside start, goal or company"),
    ],
)
def test_what_is_no_team_is_one_line(tmp_path: Path, content: dict[str, Any], said: str) -> None:
    with pytest.raises(InputFileError, match=said) as refused:
        read_scenarios(write(tmp_path, content), DEFAULTS)
    assert "\n" not in str(refused.value)
