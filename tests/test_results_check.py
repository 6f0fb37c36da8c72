"""A fixed sample of an experiment is driven again, and what differs from the kept digests is named."""

import importlib.util
import json
import shutil
from pathlib import Path

import pytest

from arena_core import run as run_benchmark

TOP = Path(__file__).resolve().parents[1]
TINY = """
# @package _global_
defaults:
  - override /planner: pure_pursuit
  - override /robot: jackal
  - override /world: empty
  - override /task: random
  - override /metrics: [si]
episodes: 2
world: {width: 6, height: 6}
task: {pedestrians: 1}
hydra:
  mode: MULTIRUN
  sweeper:
    params:
      planner: pure_pursuit
      localizer: amcl,ground_truth
"""


@pytest.fixture(scope="module")
def script():
    spec = importlib.util.spec_from_file_location("results_check", TOP / "scripts" / "results_check.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def once(tmp_path_factory):
    """Where the finished experiment of the first test that asks for one is kept for the others."""
    return tmp_path_factory.mktemp("once") / "work"


@pytest.fixture
def kept(arena, script, once):
    """Return the digests of a finished experiment of two cells."""
    if once.exists():
        shutil.copytree(once, ".", dirs_exist_ok=True)
        return Path("check.json")
    Path("conf/experiment").mkdir(parents=True)
    Path("conf/experiment/tiny.yaml").write_text(TINY.lstrip())
    words = ["experiment=tiny", "planner=pure_pursuit", "executor=serial", "report=false"]
    run_benchmark([*words, "localizer=amcl,ground_truth"], "runs")
    assert script.main(["--write", "runs", "--experiment", "tiny", "--file", "check.json"]) == 0
    shutil.copytree(".", once)
    return Path("check.json")


def test_the_sample_of_the_paper_is_40_different_cells_with_every_planner(script):
    sample = script.sample_of("paper")
    assert len({tuple(one["overrides"]) for one in sample}) == 40
    assert len({one["overrides"][0] for one in sample}) == 7
    assert sample == script.sample_of("paper")


def test_what_has_not_changed_is_the_same(kept, script, capfd):
    assert script.main(["--file", str(kept), "executor=serial"]) == 0
    assert capfd.readouterr().out.splitlines()[-1] == "2 of 2 episodes are the same bit for bit, 2 end alike"


def test_what_differs_is_named(kept, script, capfd):
    content = json.loads(kept.read_text())
    content["sample"][1]["digest"] = "0" * 32
    kept.write_text(json.dumps(content))
    assert script.main(["--file", str(kept), "executor=serial"]) == 1
    lines = capfd.readouterr().out.splitlines()
    assert any(line.startswith("planner=pure_pursuit localizer=ground_truth episode ") for line in lines)
    assert lines[-1] == "1 of 2 episodes are the same bit for bit, 2 end alike"
    assert script.main(["--file", str(kept), "--first", "1", "executor=serial"]) == 0


def test_on_another_processor_outcomes_count(kept, script, capfd):
    content = json.loads(kept.read_text())
    content["cpu"] = "another"
    content["sample"] = [{**one, "digest": ""} for one in content["sample"]]
    kept.write_text(json.dumps(content))
    assert script.main(["--file", str(kept), "executor=serial"]) == 0
    assert any(line.startswith("here is processor ") for line in capfd.readouterr().out.splitlines())


def test_an_experiment_that_is_not_finished_is_refused(kept, script, capfd):
    assert script.main(["--write", "runs/0", "--experiment", "tiny", "--file", "other.json"]) == 2
    assert (
        "runs/0: lacks planner=pure_pursuit localizer=ground_truth; allowed: all of experiment=tiny"
        in capfd.readouterr().err
    )
