"""The pack is what its code draws, every robot can run it, no one starts in a wall, and its situations happen."""

import csv
import json
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy import ndimage

from arena_core import Robot, Scenario
from arena_core.cli.main import main
from arena_core.files import option_files
from arena_core.hosting import compose, load_registry
from arena_scenarios.__main__ import DENSITIES, SITUATIONS, VARIATIONS, write_packs
from arena_scenarios.situations import APART, KEEP_OFF

PACKAGE = Path(str(files("arena_scenarios")))
REGISTRY = load_registry()
NAMES = sorted(name for name in option_files("scenario", REGISTRY.manager) if name.startswith("arena/"))
NEAR = "metrics.si.encounter_distance=1.5"
ROBOTS = ("turtlebot3", "jackal", "robotino")


@cache
def composed(*overrides: str) -> Any:
    from omegaconf import OmegaConf

    return OmegaConf.to_container(compose(overrides), resolve=True)


@cache
def robot_called(name: str) -> Robot:
    return REGISTRY.build("robot", composed(f"robot={name}")["robot"])  # type: ignore[no-any-return]


@cache
def scenarios(name: str, robot: str = "jackal") -> tuple[Scenario, ...]:
    """Return the problems of a scenario file; building them checks that the robot can reach every goal and
    that no one is in a wall.
    """
    config = composed(f"scenario={name}")
    task = REGISTRY.build(
        "task", config["task"], robot=robot_called(robot), world=REGISTRY.build("world", config["world"])
    )
    return tuple(task.scenario(0, index) for index in range(VARIATIONS))


def test_making_it_anew_gives_the_same_files_bit_for_bit(tmp_path: Path) -> None:
    write_packs(tmp_path)
    made = {
        path.relative_to(tmp_path): path
        for folder in ("packs", "conf")
        for path in (tmp_path / folder).rglob("*")
        if path.is_file()
    }
    kept = [
        path
        for folder in ("packs", "conf/scenario", "conf/experiment")
        for path in (PACKAGE / folder).rglob("*")
        if path.is_file()
    ]
    assert sorted(made) == sorted(path.relative_to(PACKAGE) for path in kept)
    assert [str(name) for name, path in made.items() if path.read_bytes() != (PACKAGE / name).read_bytes()] == []


def test_every_situation_is_there_in_three_densities() -> None:
    assert {f"arena/{situation}_{density}" for situation in SITUATIONS for density in DENSITIES} <= set(NAMES)


@pytest.mark.parametrize(
    "situation", [pytest.param(name, marks=[pytest.mark.long] * (place > 1)) for place, name in enumerate(SITUATIONS)]
)
def test_denser_scenarios_have_more_people(situation: str) -> None:
    low, medium, high = (
        min(len(s.pedestrians) for s in scenarios(f"arena/{situation}_{density}")) for density in DENSITIES
    )
    assert low < medium < high


@pytest.mark.parametrize("name", NAMES)
def test_every_robot_can_run_it_and_meets_the_same_problems(name: str) -> None:
    problems = {robot: [(s.name, s.start, s.goal, s.content_hash) for s in scenarios(name, robot)] for robot in ROBOTS}
    assert problems["turtlebot3"] == problems["jackal"] == problems["robotino"]
    assert len({name for name, *_ in problems["jackal"]}) == VARIATIONS


@pytest.mark.parametrize("name", NAMES)
def test_people_have_room_on_their_rounds_and_the_largest_robot_at_its_ends(name: str) -> None:
    for scenario in scenarios(name):
        grid = scenario.world.grid
        away = ndimage.distance_transform_edt(~grid.occupied) * grid.resolution
        ends = np.array([(end.x, end.y) for end in (scenario.start, scenario.goal)])
        assert away[tuple(grid.cells(ends).T)].min() > 0.4
        for person in scenario.pedestrians:
            places = np.vstack((person.position_xy, person.waypoints_xy))
            assert away[tuple(grid.cells(places).T)].min() > person.radius, (scenario.name, person.id)


@pytest.mark.parametrize("name", NAMES)
def test_people_start_apart_and_walk_at_a_human_speed(name: str) -> None:
    for scenario in scenarios(name):
        places = np.array([person.position_xy for person in scenario.pedestrians])
        gaps = np.hypot(*(places[:, None] - places[None]).transpose(2, 0, 1)) + np.diag(np.full(len(places), np.inf))
        assert gaps.min() > APART - 0.02
        assert np.hypot(*(places - (scenario.start.x, scenario.start.y)).T).min() > KEEP_OFF - 0.02
        assert all(0.3 <= person.desired_speed <= 1.3 for person in scenario.pedestrians)


@pytest.mark.parametrize("name", NAMES)
def test_its_problems_differ(name: str) -> None:
    assert len({np.array([p.position_xy for p in s.pedestrians]).tobytes() for s in scenarios(name)}) == VARIATIONS


@pytest.mark.parametrize("name", NAMES)
def test_composed_configuration_is_the_same_on_every_machine(name: str) -> None:
    config = composed(f"scenario={name}")
    assert config["world"]["path"].startswith("pkg://arena_scenarios/packs/arena/maps/")
    assert config["task"]["path"] == f"pkg://arena_scenarios/packs/{name.replace('/', '/scenarios/')}.json"
    assert str(PACKAGE) not in json.dumps(config)


def test_robot_meets_people_and_the_table_names_the_content(tmp_path: Path) -> None:
    words = (
        "-m",
        "planner=dwa",
        "robot=jackal",
        "scenario=arena/crossing_medium,arena/head_on_low",
        "localizer=ground_truth",
        "episodes=2",
    )
    assert main(["run", *words, "executor=serial", "report=false", f"hydra.sweep.dir={tmp_path}"]) == 0
    for number, name in enumerate(("crossing_medium", "head_on_low")):
        with (tmp_path / str(number) / "episodes.csv").open() as table:
            rows = list(csv.DictReader(table))
        assert [row["scenario"] for row in rows] == [f"{name}_a/0000", f"{name}_b/0000"]
        assert all(float(row["encounters"]) >= 1.0 for row in rows)
        (expected,) = {scenario.content_hash for scenario in scenarios(f"arena/{name}")}
        assert {row["scenario_hash"] for row in rows} == {expected}
        assert expected.startswith("arena@1.0.0:")
