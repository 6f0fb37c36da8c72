"""The packages in ``examples`` are installed as a stranger would, hold their
contracts, pass their own tests and run.
"""

import csv
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

EXAMPLES = Path(__file__).resolve().parents[1] / "examples"
PARTS = ("robot=scout", "planner=vfh_plus", "metrics=[si,hesitation]")


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    """Install the package beside the suite, from its folder."""
    folder = tmp_path_factory.mktemp("site")
    words = ("pip", "install", "--quiet", "--no-deps", "--no-build-isolation", "--no-compile", "--target", folder)
    subprocess.run([sys.executable, "-m", *words, EXAMPLES / "scout-lab"], check=True, timeout=1800)
    return folder


@pytest.fixture
def scout_lab(site, third_party):
    shutil.copytree(site, third_party.folder, dirs_exist_ok=True)
    return third_party


@pytest.mark.slow
def test_its_own_tests_pass(scout_lab, tmp_path):
    words = [
        sys.executable,
        "-m",
        "pytest",
        "-q",
        "-p",
        "no:cacheprovider",
        "--rootdir",
        tmp_path,
        EXAMPLES / "scout-lab" / "tests",
    ]
    answer = subprocess.run(words, cwd=tmp_path, env=scout_lab.environment, capture_output=True, text=True, timeout=600)
    assert answer.returncode == 0, answer.stdout + answer.stderr
    assert "10 passed" in answer.stdout


@pytest.mark.parametrize("words", [["robot=scout"], ["planner=vfh_plus", "robot=scout"], ["metrics=hesitation"]])
def test_each_component_keeps_its_contract(scout_lab, arena, words):
    answer = arena("check", *words)
    assert (answer.status, answer.errors) == (0, [])
    assert f"ok {words[0]}" in answer.out


@pytest.mark.slow
def test_its_planner_drives_its_robot_and_its_metrics_are_in_the_tables(scout_lab, arena):
    answer = arena(
        "run",
        *PARTS,
        "task.pedestrians=2",
        "episodes=2",
        "task.time_limit=60",
        "seed=3",
        "hydra.run.dir=run",
        "executor=serial",
    )
    assert answer.status == 0
    with Path("run/episodes.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert [(row["planner"], row["robot"], float(row["success"])) for row in rows] == [("vfh_plus", "scout", 1.0)] * 2
    assert all(
        float(row["hesitation.changes_of_side"]) < 3.0 and float(row["hesitation.standing_share"]) < 0.5 for row in rows
    )
    assert "changes of side" in Path("run/report/index.html").read_text()
