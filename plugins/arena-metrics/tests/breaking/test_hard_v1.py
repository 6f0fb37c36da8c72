"""The pack ``hard_v1``: as it was packed, within common sense, with a certificate for each problem, and solvable."""

import csv
import math
from importlib.resources import files
from pathlib import Path

import pytest
import yaml

from arena_break.bounds import read_bounds
from arena_core import Runs
from arena_core import run as run_benchmark
from arena_core.hosting import compose, load_registry, to_plain
from arena_tasks.commands.packing import ANYBODY
from arena_tasks.scenario_files.pack import verified_pack
from arena_tasks.scenario_files.scenario_file import read_scenario_file

PACK = Path(str(files("arena_break"))) / "packs" / "hard_v1"
FILE = PACK / "scenarios/jackal_warehouse.json"


@pytest.fixture(scope="module")
def problems():
    return read_scenario_file(FILE, ANYBODY).problems


@pytest.fixture(scope="module")
def config():
    return to_plain(compose(["experiment=hard_v1", "planner=pure_pursuit"]))


def test_it_is_as_it_was_packed_and_its_experiment_drives_each_problem_once(problems, config):
    assert verified_pack(PACK).id == "hard_v1"
    assert config["episodes"] == len(problems)
    assert (config["robot"]["name"], config["localizer"]["name"], config["tracker"]["name"]) == (
        "jackal",
        "amcl",
        "kalman",
    )
    assert config["pedestrians"]["reaction"] == "ignore"


def test_every_problem_can_be_run(problems, config):
    registry = load_registry()
    robot = registry.build("robot", config["robot"])
    task = registry.build("task", config["task"], robot=robot, world=registry.build("world", config["world"]))
    drawn = [task.scenario(0, index) for index in range(len(problems))]
    assert [one.name.partition("/")[0] for one in drawn] == [one.name for one in problems]


def test_people_are_few_walk_and_begin_away_from_the_robot(problems):
    limits = read_bounds(None).people
    for one in problems:
        assert 1 <= len(one.pedestrians) <= limits.most
        for person in one.pedestrians:
            assert limits.slowest - 1e-3 <= person.desired_speed <= limits.fastest + 1e-3
            x, y = person.position_xy
            assert math.hypot(x - one.start.x, y - one.start.y) >= limits.spawn_distance - 2e-3


def test_every_problem_has_a_certificate_and_a_search_that_says_how_to_go_on(problems):
    with (PACK / "certificates.csv").open() as file:
        rows = {row["name"]: row for row in csv.DictReader(file)}
    assert sorted(rows) == sorted(one.name for one in problems)
    margin = read_bounds(None).margin.people
    for one in problems:
        row = rows[one.name]
        assert float(row["clearance"]) >= margin
        assert float(row["time_certified"]) <= one.time_limit
        assert int(row["people"]) == len(one.pedestrians)
    searches = yaml.safe_load((PACK / "searches.yaml").read_text())
    assert sum(one["here"] for one in searches) == len(problems)
    assert all(one["command"].startswith("arena break planner=") for one in searches)


def test_it_is_small():
    assert sum(path.stat().st_size for path in PACK.rglob("*") if path.is_file()) < 400_000


@pytest.mark.slow
def test_the_clairvoyant_solves_the_first_of_them_and_pure_pursuit_does_not(tmp_path):
    common = ["experiment=hard_v1", "episodes=2", "executor=serial", "report=false"]
    known = ["planner=clairvoyant", "localizer=ground_truth", "timing.mode=ideal"]
    run_benchmark([*common, *known, f"hydra.run.dir={tmp_path / 'known'}"])
    run_benchmark([*common, "planner=pure_pursuit", f"hydra.run.dir={tmp_path / 'blind'}"])
    strict = {
        name: [float(value) for run in Runs.below(tmp_path / name) for value in run.episodes["strict_success"]]
        for name in ("known", "blind")
    }
    assert strict == {"known": [1.0, 1.0], "blind": [0.0, 0.0]}
