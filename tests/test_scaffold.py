import csv
import os
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from arena_core import ConfigurationError
from arena_core.cli.scaffold import KINDS, write_package
from arena_core.config.plugins import load_plugins
from arena_core.testing import check, component, robot

NAMES = {
    "planner": "bug_zero",
    "robot": "scout",
    "metric": "nearness",
    "world": "pillars",
    "scenario": "lobby",
    "task": "errands",
    "localizer": "wheels",
    "predictor": "slowing",
    "communication": "walkie_talkie",
    "encoder": "sectors",
}
GROUPS = {kind: KINDS[kind].group for kind in NAMES if kind != "scenario"}


@pytest.fixture
def installed(third_party):
    """Write a package of each kind with ``arena new`` and lay it out as an installation does."""
    folders = {}
    for kind, name in NAMES.items():
        folder = folders[kind] = write_package(kind, name, third_party.folder / "source")
        project = tomllib.loads((folder / "pyproject.toml").read_text())["project"]
        assert project["entry-points"]["arena"] == {name: name}
        third_party.write(
            f"{name}-0.1.0.dist-info/METADATA", f"Metadata-Version: 2.1\nName: {project['name']}\nVersion: 0.1.0\n"
        )
        third_party.write(f"{name}-0.1.0.dist-info/entry_points.txt", f"[arena]\n{name} = {name}\n")
        (third_party.folder / name).symlink_to(folder / name)
    return folders


def test_there_is_a_name_for_every_kind():
    assert list(NAMES) == list(KINDS)


def test_a_new_planner_keeps_the_contract_with_every_drive(installed):
    load_plugins()
    for kinematics in ("differential", "omnidirectional", "ackermann"):
        body = robot(kinematics)
        assert check("planner", component("planner", "bug_zero", robot=body), body)


@pytest.mark.parametrize("kind", GROUPS)
def test_arena_check_holds_each_to_its_contract(installed, arena, kind):
    answer = arena("check", f"{GROUPS[kind]}={NAMES[kind]}")
    assert (answer.status, answer.errors) == (0, [])
    assert f"ok {GROUPS[kind]}={NAMES[kind]}" in answer.out


@pytest.mark.slow
def test_their_own_tests_pass(installed, third_party):
    folders = [folder / "tests" for folder in installed.values()]
    words = [
        sys.executable,
        "-m",
        "pytest",
        "-q",
        "-p",
        "no:cacheprovider",
        "-p",
        "no:hypothesispytest",
        "--import-mode=importlib",
        *folders,
    ]
    answer = subprocess.run(
        words, cwd=third_party.folder, env=third_party.environment, capture_output=True, text=True, timeout=600
    )
    assert answer.returncode == 0, answer.stdout + answer.stderr
    assert "30 passed" in answer.stdout


def test_they_drive_together(installed, arena):
    chosen = (
        "planner=bug_zero",
        "robot=scout",
        "world=pillars",
        "task=errands",
        "localizer=wheels",
        "metrics=[si,nearness]",
    )
    answer = arena("run", *chosen, "task.time_limit=20", "executor=serial", "hydra.run.dir=run", "episodes=2")
    assert (answer.status, answer.errors) == (0, [])
    with Path("run/episodes.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert {(row["planner"], row["robot"], row["world"], row["task"], row["localizer"]) for row in rows} == {
        ("bug_zero", "scout", "pillars", "errands", "wheels")
    }
    assert {row["nearness.passing_side"] for row in rows} <= {"left", "right"}
    assert all(row["outcome"] != "error" and 0.0 <= float(row["nearness.crowded_share"]) <= 1.0 for row in rows)
    assert "passing side" in Path("run/report/index.html").read_text()


def test_a_new_scenario_is_run_and_listed(installed, arena):
    words = (
        "scenario=lobby/crossing",
        "planner=pure_pursuit",
        "localizer=ground_truth",
        "executor=serial",
        "report=false",
    )
    answer = arena("run", *words, "episodes=2", "task.time_limit=20", "hydra.run.dir=run")
    assert (answer.status, answer.errors) == (0, [])
    with Path("run/episodes.csv").open(newline="") as file:
        assert [row["scenario"].partition("/")[0] for row in csv.DictReader(file)] == ["crossing_near", "crossing_far"]
    assert "lobby/crossing" in arena("list", "scenarios").out


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["planner", "scenario"])
def test_it_can_be_built_and_installed(tmp_path, kind):
    name = NAMES[kind]
    folder = write_package(kind, name, tmp_path)
    words = [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(tmp_path / "wheels")]
    subprocess.run(words, cwd=folder, check=True, capture_output=True, timeout=600)
    (wheel,) = (tmp_path / "wheels").glob("*.whl")
    assert wheel.name == f"{name}-0.1.0-py3-none-any.whl"
    names = subprocess.run(
        [sys.executable, "-m", "zipfile", "-l", str(wheel)], capture_output=True, text=True, check=True
    ).stdout
    assert all(f"{name}/{path.relative_to(folder / name)}" in names for path in (folder / name).rglob("*.*"))


def test_they_are_clean_code(installed):
    ruff = Path(sys.executable).with_name("ruff")
    settings = Path(__file__).resolve().parents[1] / "pyproject.toml"
    modules = [installed[kind] / name / "__init__.py" for kind, name in NAMES.items()]
    tests = [folder / "tests" for folder in installed.values()]
    for words in (
        ["check", *modules],
        ["check", "--ignore", "D,S,I001", *tests],
        ["format", "--check", *modules, *tests],
    ):
        answer = subprocess.run([ruff, *words, "--config", settings, "--no-cache"], capture_output=True, text=True)
        assert answer.returncode == 0, answer.stdout


@pytest.mark.parametrize("kind", KINDS)
def test_the_readme_says_what_to_type(tmp_path, kind):
    readme = (write_package(kind, "mine", tmp_path) / "README.md").read_text()
    assert f"Mine, {KINDS[kind].noun} for the arena suite." in readme
    assert all(f"\n{command}\n" in readme for command in ("pip install -e .", *KINDS[kind].commands("mine"), "pytest"))
    option = tmp_path / "mine" / readme.split("Its numbers are in `")[1].split("`")[0]
    assert option.exists()


@pytest.mark.parametrize("name", ["MyPlanner", "my-planner", "1st", "class", "", "../up"])
def test_an_impossible_name_says_what_is_allowed(tmp_path, name):
    with pytest.raises(
        ConfigurationError, match=r"planner name is .*; allowed: a lower-case Python name such as my_planner"
    ):
        write_package("planner", name, tmp_path)
    assert os.listdir(tmp_path) == []


def test_nothing_is_ever_written_over(tmp_path):
    write_package("planner", "mine", tmp_path)
    (tmp_path / "mine" / "README.md").write_text("mine")
    with pytest.raises(ConfigurationError, match="exists already"):
        write_package("robot", "mine", tmp_path)
    assert (tmp_path / "mine" / "README.md").read_text() == "mine"


def test_the_command_says_what_to_do_next(arena):
    answer = arena("new", "planner", "mine", "--out", "there")
    assert answer.status == 0
    assert "pip install -e there/mine && arena check planner=mine" in answer.out
    assert Path("there/mine/mine/__init__.py").exists()
    assert (
        "next: pip install -e ours && arena run scenario=ours/crossing episodes=10"
        in arena("new", "scenario", "ours").out
    )
