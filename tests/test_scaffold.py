import os
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from arena_core import ConfigurationError
from arena_core.plugins import load_plugins
from arena_core.scaffold import write_planner
from arena_core.testing import check, component, robot


@pytest.fixture
def installed(third_party):
    """Write a package with ``arena new`` and lay it out as an installation does."""
    folder = write_planner("bug_zero", third_party.folder / "source")
    project = tomllib.loads((folder / "pyproject.toml").read_text())
    (points,) = project["project"]["entry-points"]["arena"].items()
    assert points == ("bug_zero", "bug_zero")
    third_party.write("bug_zero-0.1.0.dist-info/METADATA", "Metadata-Version: 2.1\nName: bug-zero\nVersion: 0.1.0\n")
    third_party.write("bug_zero-0.1.0.dist-info/entry_points.txt", "[arena]\nbug_zero = bug_zero\n")
    (third_party.folder / "bug_zero").symlink_to(folder / "bug_zero")
    return folder


def test_a_new_planner_is_a_plugin_that_keeps_the_contract(installed):
    load_plugins()
    for kinematics in ("differential", "omnidirectional", "ackermann"):
        body = robot(kinematics)
        assert check("planner", component("planner", "bug_zero", robot=body), body)


def test_arena_check_says_so_too(installed, arena):
    answer = arena("check", "planner=bug_zero")
    assert (answer.status, answer.errors) == (0, [])
    assert answer.out.count("ok planner=bug_zero") == 3


def test_its_own_test_passes(installed, third_party):
    words = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "-p", "no:hypothesispytest", "tests"]
    answer = subprocess.run(words, cwd=installed, env=third_party.environment, capture_output=True, text=True, timeout=120)
    assert answer.returncode == 0, answer.stdout + answer.stderr
    assert "2 passed" in answer.stdout


def test_it_drives(installed, arena):
    words = ("planner=bug_zero", "robot=jackal", "world=empty", "world.width=8", "world.height=8", "task.pedestrians=0")
    answer = arena("run", *words, "localizer=ground_truth", "executor=serial", "report=false", "hydra.run.dir=run", "episodes=1")
    assert (answer.status, answer.errors) == (0, [])
    assert "bug_zero" in Path("run/episodes.csv").read_text()


@pytest.mark.slow
def test_it_can_be_built_and_installed(tmp_path):
    folder = write_planner("bug_zero", tmp_path)
    words = [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(tmp_path / "wheels")]
    subprocess.run(words, cwd=folder, check=True, capture_output=True, timeout=120)
    (wheel,) = (tmp_path / "wheels").glob("*.whl")
    assert wheel.name == "bug_zero-0.1.0-py3-none-any.whl"
    names = subprocess.run([sys.executable, "-m", "zipfile", "-l", str(wheel)], capture_output=True, text=True, check=True).stdout
    assert "bug_zero/conf/planner/bug_zero.yaml" in names


def test_it_is_clean_code(installed):
    ruff = Path(sys.executable).with_name("ruff")
    settings = Path(__file__).resolve().parents[1] / "pyproject.toml"
    for words in (["check"], ["format", "--check"]):
        answer = subprocess.run(
            [ruff, *words, "--config", settings, "--no-cache", installed / "bug_zero" / "__init__.py"], capture_output=True, text=True
        )
        assert answer.returncode == 0, answer.stdout


@pytest.mark.parametrize("name", ["MyPlanner", "my-planner", "1st", "class", "", "../up"])
def test_an_impossible_name_says_what_is_allowed(tmp_path, name):
    with pytest.raises(ConfigurationError, match=r"allowed: a lower-case Python name such as my_planner"):
        write_planner(name, tmp_path)
    assert os.listdir(tmp_path) == []


def test_nothing_is_ever_written_over(tmp_path):
    write_planner("mine", tmp_path)
    (tmp_path / "mine" / "README.md").write_text("mine")
    with pytest.raises(ConfigurationError, match="exists already"):
        write_planner("mine", tmp_path)
    assert (tmp_path / "mine" / "README.md").read_text() == "mine"


def test_the_command_says_what_to_do_next(arena):
    answer = arena("new", "planner", "mine", "--out", "there")
    assert answer.status == 0
    assert "pip install -e there/mine && arena check planner=mine" in answer.out
    assert Path("there/mine/mine/__init__.py").exists()
