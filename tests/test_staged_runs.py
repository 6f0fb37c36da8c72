"""Staged runs: levels follow from finished episodes alone, however the episodes are run."""

import csv
import json
import shutil
from pathlib import Path

import pytest

from arena_core import run as run_benchmark
from arena_core.records import read_record

LEVELS = """
levels:
  0: {difficulty: null, obstacles: 0, pedestrians: 0, pedestrian_speed: 0.3, speed_share: 0.5}
  1: {difficulty: null, obstacles: 1, pedestrians: 0, pedestrian_speed: 0.3, speed_share: 1.0}
  2: {difficulty: null, obstacles: 0, pedestrians: 1, pedestrian_speed: 0.3, speed_share: 1.0}
"""
QUICK = (
    *(
        "task=staged",
        "task.path=my.yaml",
        "task.block=2",
        "robot=jackal",
        "world=empty",
        "world.width=8",
        "world.height=8",
    ),
    *("task.random.time_limit=20", "localizer=ground_truth", "report=false"),
)
GOOD, BAD = ("planner=pure_pursuit",), ("planner=still", "task.start=2", "task.random.time_limit=1")
STILL = """
    from arena_core import Planner, Robot, Twist, hookimpl

    class Still(Planner):
        def __init__(self, robot: Robot) -> None:
            pass

        def compute_velocity(self, observation):
            return Twist(0.0)

    @hookimpl
    def register_planners(register):
        register("still", Still)

    @hookimpl
    def config_package():
        return "still.conf"
"""


@pytest.fixture
def run(arena, third_party):
    """Run staged episodes into a folder and return the answer."""
    third_party.package("still", STILL, {"planner/still": "name: still\n"})
    Path("my.yaml").write_text(LEVELS)

    def run(folder, *words):
        answer = arena("run", *QUICK, "executor=serial", f"hydra.run.dir={folder}", *words)
        assert (answer.status, answer.errors) == (0, [])
        return answer

    return run


def rows(folder):
    """Return the rows of a run without what depends on the wall clock."""
    with Path(folder, "episodes.csv").open(newline="") as file:
        return [{k: v for k, v in row.items() if not k.startswith("planning_")} for row in csv.DictReader(file)]


def stages(folder):
    return [int(row["stage"]) for row in rows(folder)]


def records(folder):
    return {path.name: path.read_bytes() for path in sorted(Path(folder, "records").glob("*"))}


def test_a_good_planner_rises_and_says_so(run):
    answer = run("good", *GOOD, "episodes=5")
    assert stages("good") == [0, 0, 1, 1, 2]
    assert answer.out.splitlines()[:-1] == [
        "level 0, episodes 0 .. 1: 2 of 2 succeeded, on to level 1",
        "level 1, episodes 2 .. 3: 2 of 2 succeeded, on to level 2",
        "level 2, episodes 4 .. 4: 1 of 1 succeeded",
    ]


def test_a_planner_that_fails_falls_back_to_the_first_level(run):
    answer = run("bad", *BAD, "episodes=6")
    assert stages("bad") == [2, 2, 1, 1, 0, 0]
    assert answer.out.splitlines()[0] == "level 2, episodes 0 .. 1: 0 of 2 succeeded, back to level 1"
    assert answer.out.splitlines()[2] == "level 0, episodes 4 .. 5: 0 of 2 succeeded, stays"


@pytest.fixture(scope="module")
def good(tmp_path_factory):
    """Return the folder of a run of three episodes that all succeed."""
    folder = tmp_path_factory.mktemp("staged")
    (folder / "my.yaml").write_text(LEVELS)
    words = [word for word in QUICK if not word.startswith("task.path")]
    run_benchmark([*words, *GOOD, f"task.path={folder / 'my.yaml'}", "executor=serial", "episodes=3"], folder / "run")
    return folder / "run"


def test_a_record_knows_its_level(good):
    first, third = (read_record(good / f"records/000{i}.npz").meta for i in (0, 2))
    assert (first["columns"]["stage"], third["columns"]["stage"]) == (0, 1)
    assert (first["scenario"]["speed_share"], third["scenario"]["speed_share"]) == (0.5, 1.0)
    assert (len(first["scenario"]["obstacles"]), len(third["scenario"]["obstacles"])) == (0, 1)
    assert first["columns"]["scenario_hash"] == third["columns"]["scenario_hash"] != ""


def test_the_simulator_holds_the_robot_to_the_share_of_the_level(good):
    slow, fast = (read_record(good / f"records/000{i}.npz") for i in (0, 2))
    limit = slow.meta["robot"]["limits"]["vx_max"]
    assert abs(slow["twist"][:, 0]).max() == pytest.approx(0.5 * limit)
    assert abs(fast["twist"][:, 0]).max() > 0.5 * limit


def test_an_interrupted_run_continues_as_if_nothing_had_happened(run):
    run("whole", *GOOD, "episodes=5")
    for finished in (2, 3):  # at the end of a block, and within one
        shutil.copytree("whole", f"part{finished}")
        for record in list(Path(f"part{finished}/records").iterdir()):
            if int(record.stem) >= finished:
                record.unlink()
        run(f"part{finished}", *GOOD, "episodes=5", "resume=true")
        assert rows(f"part{finished}") == rows("whole")
        assert records(f"part{finished}") == records("whole")


def test_an_episode_that_fails_counts_as_no_success(arena, run):
    small = ("world.width=0.2", "world.height=0.2", "executor=serial")
    answer = arena("run", *QUICK, *GOOD, *small, "task.start=1", "episodes=3", "hydra.run.dir=failing")
    assert answer.status == 1
    assert stages("failing") == [1, 1, 0]


@pytest.mark.slow
def test_runs_side_by_side_are_the_same_alone_and_with_two_workers(arena, run):
    sweep = ("-m", "planner=pure_pursuit,still", "task.start=1", "task.random.time_limit=15", "episodes=5")
    usual = [word for word in QUICK if not word.startswith("task.random")]
    for folder, executor in (("w1", ["executor=serial"]), ("w2", ["executor=processes", "executor.workers=2"])):
        answer = arena("run", *sweep, *usual, *executor, f"hydra.sweep.dir={folder}")
        assert (answer.status, answer.errors) == (0, [])
        assert "1: level 1, episodes 0 .. 1: 0 of 2 succeeded, back to level 0" in answer.out.splitlines()
    for job, levels in (("0", [1, 1, 2, 2, 2]), ("1", [1, 1, 0, 0, 0])):
        assert stages(f"w1/{job}") == levels
        assert rows(f"w1/{job}") == rows(f"w2/{job}")
        assert records(f"w1/{job}") == records(f"w2/{job}")


def test_staged_and_other_runs_share_one_executor(arena, run):
    words = [word for word in QUICK if not word.startswith("task")]
    (Path("conf") / "task").mkdir(parents=True)
    Path("conf/task/short.yaml").write_text("defaults:\n  - staged\n  - _self_\npath: my.yaml\nblock: 1\n")
    answer = arena(
        "run",
        "-m",
        "task=random,short",
        "planner=pure_pursuit",
        *words,
        "executor=serial",
        "episodes=2",
        "hydra.sweep.dir=d",
    )
    assert (answer.status, answer.errors) == (0, [])
    assert [row["stage"] for row in rows("d/0")] == ["", ""]
    assert stages("d/1") == [0, 1]


@pytest.mark.parametrize(
    ("content", "words", "message"),
    [
        (
            "levels: {0: {}, 1: {}, 3: {}}",
            (),
            "arena: my.yaml: levels are numbered 0, 1, 3; allowed: 0, 1, 2 and so on without a gap",
        ),
        ("levels: {0: {difficulty: 0.5}}", (), "arena: my.yaml: levels.0.obstacles is missing"),
        ("levels: {}", (), "arena: my.yaml: levels is {}; allowed: at least one level"),
        (
            LEVELS.replace("null", "0.5"),
            (),
            "arena: my.yaml: levels.0.difficulty is 0.5, but this world has none; allowed: ",
        ),
        (LEVELS, ("task.promote=0.5",), "arena: task.promote is 0.5; allowed: above task.fall_back, 0.6"),
        (LEVELS, ("task.start=3",), "arena: task.start is 3; allowed: 0 .. 2"),
        (LEVELS, ("task.block=0",), "arena: task.block is 0; allowed: >= 1"),
        (
            LEVELS,
            ("task.path=other.yaml",),
            "arena: other.yaml: cannot be read (No such file or directory); allowed: ",
        ),
    ],
)
def test_wrong_input_is_one_line_before_anything_runs(arena, content, words, message):
    Path("my.yaml").write_text(content)
    answer = arena("run", *QUICK, "executor=serial", "hydra.run.dir=run", *words)
    assert answer.status == 2
    assert answer.line.startswith(message)
    assert not Path("run/records").exists()


def test_provenance_holds_the_rule(good):
    task = json.loads((good / "provenance.json").read_text())["config"]["task"]
    assert [task[key] for key in ("block", "promote", "fall_back", "start")] == [2, 0.85, 0.6, 0]
    assert task["random"]["name"] == "random"
