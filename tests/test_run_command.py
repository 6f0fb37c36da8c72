"""What `arena run` does beside running: its help, and the configurations that it would run."""

from pathlib import Path

import pytest
import yaml


@pytest.mark.parametrize("words", [("--help",), ("planner=dwa", "-h")])
def test_help_explains_multiruns_resuming_sweeps_and_configurations(arena, words):
    answer = arena("run", *words)
    assert (answer.status, answer.errors) == (0, [])
    assert all(
        f" {word}" in answer.out
        for word in ("-m", "resume=true", "hydra/sweeper=optuna", "hydra/launcher=joblib", "--cfg job")
    )
    assert max(map(len, answer.out.splitlines())) < 140


def test_the_configurations_of_a_multirun_are_shown_and_nothing_is_left(arena):
    answer = arena("run", "-m", "planner=pure_pursuit", "planner.gain=1,2", "robot=jackal", "--cfg", "job")
    assert (answer.status, answer.errors) == (0, [])
    jobs = list(yaml.safe_load_all(answer.out))
    assert [(job["planner"]["gain"], job["robot"]["name"]) for job in jobs] == [(1, "jackal"), (2, "jackal")]
    assert "# 1: planner=pure_pursuit planner.gain=2 robot=jackal\n" in answer.out
    assert list(Path().iterdir()) == []


@pytest.mark.parametrize(
    "words",
    [("world=indoor_as_paper,outdoor_as_paper",), ("experiment=paper_worlds", "planner=dwa", "task.pedestrians=5")],
)
def test_a_key_that_only_the_components_of_a_sweep_have(arena, words):
    answer = arena("run", "-m", *words, "robot=jackal", "world.regenerate=3", "--cfg", "job")
    assert (answer.status, answer.errors) == (0, [])
    found = [job["world"] for job in yaml.safe_load_all(answer.out)]
    assert [(world["name"], world["regenerate"]) for world in found] == [("indoor", 3), ("outdoor", 3)]


def test_a_key_that_a_component_of_a_sweep_lacks_is_refused(arena):
    answer = arena("run", "-m", "robot=jackal", "world=indoor,warehouse", "world.regenerate=1", "hydra.sweep.dir=sweep")
    assert answer.status == 2
    assert answer.line.startswith("arena: world has no key regenerate (possible: aisle_width")
    assert list(Path().iterdir()) == []


def test_hydras_own_part_is_shown_resolved(arena):
    answer = arena("run", "--cfg", "hydra", "--resolve", "-m", "planner=pure_pursuit,dwa", "hydra.sweep.dir=sweep")
    assert [job["hydra"]["sweep"] for job in yaml.safe_load_all(answer.out)] == [
        {"dir": "sweep", "subdir": str(k)} for k in range(2)
    ]


def test_a_wrong_job_is_refused_when_it_is_shown(arena):
    answer = arena("run", "-m", "planner=pure_pursuit,dwaa", "--cfg", "job")
    assert answer.status == 2
    assert answer.line.startswith("arena: unknown planner 'dwaa'")


QUICK = (
    *("robot=jackal", "world=empty", "world.width=8", "world.height=8", "localizer=ground_truth", "executor=serial"),
    *("task.time_limit=2", "report=false", "episodes=1"),
)


def test_a_single_run_leaves_what_hydra_itself_leaves_of_one(arena):
    left = []
    for folder, way in (("own", ()), ("its", ("hydra.mode=RUN",))):
        assert arena("run", "planner=pure_pursuit", *QUICK, f"hydra.run.dir={folder}", *way).status == 0
        hydra = {path.name: path.read_text() for path in Path(folder, ".hydra").iterdir()}
        hydra["hydra.yaml"] = hydra["hydra.yaml"].replace(str(Path(folder).absolute()), "").replace(folder, "")
        left.append((hydra, Path(folder, "records/0000.npz").read_bytes()))
    assert left[0] == left[1]


def test_an_experiment_that_is_a_sweep_is_one_without_a_flag_too(arena):
    words = ("experiment=classic", "planner=pure_pursuit", *QUICK)
    assert arena("run", *words, "task.pedestrians=0,1", "out=sweep").status == 0
    assert sorted(path.name for path in Path("sweep").iterdir() if path.is_dir()) == ["0", "1"]
    assert arena("run", *words, "task.pedestrians=0", "out=one").status == 0
    assert Path("one/0/records/0000.npz").exists()


def test_a_sweep_without_a_flag_that_no_experiment_asks_for_is_refused(arena):
    answer = arena("run", "planner=pure_pursuit", *QUICK, "seed=1,2")
    assert answer.status == 2
    assert "add --multirun" in answer.line
