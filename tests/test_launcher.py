import csv
import json
import subprocess
import sys
from pathlib import Path

import pytest
import yaml

SWEEP = (
    *(
        "-m",
        "planner=pure_pursuit",
        "robot=jackal",
        "world=empty",
        "world.width=8",
        "world.height=8",
        "task.pedestrians=0",
    ),
    *("localizer=ground_truth", "executor=serial", "report=false", "hydra.sweep.dir=sweep", "episodes=1"),
)


def provenance(job):
    return json.loads(Path(f"sweep/{job}/provenance.json").read_text())


def test_every_job_of_a_multirun_has_a_folder_of_its_own(arena):
    answer = arena("run", *SWEEP, "planner.gain=1,2", "robot=jackal,robotino")
    assert (answer.status, answer.errors) == (0, [])
    jobs = [(provenance(k)["config"]["planner"]["gain"], provenance(k)["config"]["robot"]["name"]) for k in range(4)]
    assert sorted(jobs) == [(1, "jackal"), (1, "robotino"), (2, "jackal"), (2, "robotino")]
    assert len({provenance(k)["config_hash"] for k in range(4)}) == 4
    assert sorted(provenance(k)["config"]["choices"]["robot"] for k in range(4)) == [
        "jackal",
        "jackal",
        "robotino",
        "robotino",
    ]
    for job in range(4):
        assert Path(f"sweep/{job}/records/0000.npz").exists()
        assert Path(f"sweep/{job}/.hydra/config.yaml").exists()


def test_a_sweep_says_which_job_it_composes_and_composes_each_once(tmp_path):
    words = [sys.executable, "-m", "arena_core.cli.main", "run", *SWEEP, "planner.gain=1,2,3"]
    said = subprocess.run(
        words, cwd=tmp_path, capture_output=True, text=True, check=True, timeout=1800
    ).stderr.splitlines()
    assert said[0] == "arena: composing job 1 of 3"
    assert len([line for line in said if line.startswith("arena: composing job 1 of")]) == 1


def test_what_only_a_swept_component_has_can_be_set(arena):
    answer = arena("run", *SWEEP, "world=empty,indoor", "world.draws=7,8", "--cfg", "job")
    assert answer.errors == ["arena: world has no key draws (possible: height, known, name, resolution, width)"]
    words = [word for word in SWEEP if not word.startswith(("world", "hydra"))]
    answer = arena(
        "run",
        *words,
        "world=indoor,outdoor",
        "world.difficulty=0.4",
        "+task.extra='a, b'",
        "hydra.job.chdir=false",
        "--cfg",
        "job",
    )
    assert (answer.status, answer.errors) == (0, [])
    shown = [yaml.safe_load(document) for document in answer.out.split("---")[1:]]
    assert [(job["world"]["difficulty"], job["task"]["extra"]) for job in shown] == [(0.4, "a, b")] * 2


@pytest.mark.parametrize(
    ("words", "line"),
    [
        (
            ("world=indoor,outdoor", "world.dificulty=0.4"),
            "arena: world has no key dificulty; did you mean difficulty?",
        ),
        (("world.difficulty=0.4", "planner.gain=1,2"), "arena: world has no key difficulty (possible: "),
        (("seed=1,2", "episodes.x=3"), "arena: episodes has no key x (possible: none)"),
        (("seed=1,2", "+seed=3"), "arena: Could not append to config. An item is already at 'seed'"),
        (
            ("planner.gain=interval(1,2)",),
            "arena: planner.gain=interval(1,2) has no end of values; allowed: planner.gain=A,B,C, or",
        ),
        (
            ("planner.gain=1,2", "hydra.sweeper.max_batch_size=0"),
            "arena: hydra.sweeper.max_batch_size is 0; allowed: >= 1",
        ),
    ],
)
def test_what_no_job_can_take_is_refused_in_one_line(arena, words, line):
    answer = arena("run", *SWEEP, *words)
    assert answer.status == 2
    assert answer.line.startswith(line)
    assert not Path("sweep").exists()


def test_jobs_may_be_launched_in_batches(third_party, arena):
    third_party.package("counting", COUNTING, {"executor/counting": "name: counting\n"})
    answer = arena("run", *SWEEP, "executor=counting", "planner.gain=1,2,3", "hydra.sweeper.max_batch_size=2")
    assert answer.status == 0
    assert [line for line in answer.out.splitlines() if line.startswith("jobs: ")] == ["jobs: 0/0 1/0", "jobs: 2/0"]


def test_an_experiment_can_be_a_sweep_whose_axes_the_command_line_replaces(arena):
    words = [word for word in SWEEP if word not in ("-m", "robot=jackal", "task.pedestrians=0")]
    answer = arena("run", "experiment=classic", *words, "task.pedestrians=0,1")
    assert (answer.status, answer.errors) == (0, [])
    cells = [provenance(k)["config"] for k in range(6)]
    assert [(c["robot"]["name"], c["task"]["pedestrians"]) for c in cells] == [
        (robot, people) for robot in ("turtlebot3", "jackal", "robotino") for people in (0, 1)
    ]
    assert not Path("sweep/6").exists()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("subdir", "swept"),
    [
        ("${planner.name}/${robot.name}", ("planner=pure_pursuit,orca",)),
        pytest.param("a/${robot.name}/b", ("robot=jackal,robotino",), marks=pytest.mark.long),
    ],
)
def test_the_report_of_a_multirun_covers_every_run_however_their_folders_are_called(arena, subdir, swept):
    words = [word for word in SWEEP if word not in ("report=false", "planner=pure_pursuit", "robot=jackal")]
    other = ("robot=jackal",) if "planner=pure_pursuit,orca" in swept else ("planner=pure_pursuit",)
    answer = arena("run", *words, *other, *swept, f"hydra.sweep.subdir='{subdir}'", "task.time_limit=1")
    assert (answer.status, answer.errors) == (0, [])
    assert len(list(Path("sweep").rglob("episodes.csv"))) == 2
    assert [str(path) for path in Path().rglob("report/index.html")] == ["sweep/report/index.html"]
    with Path("sweep/report/summary.csv").open() as table:
        assert len({(row["planner"], row["robot"]) for row in csv.DictReader(table)}) == 2


def test_all_episodes_of_a_multirun_go_through_one_executor(third_party, arena):
    third_party.package("counting", COUNTING, {"executor/counting": "name: counting\n"})
    answer = arena("run", *SWEEP, "executor=counting", "planner.gain=1,2,3", "episodes=2")
    assert answer.status == 0
    assert answer.out.splitlines()[0] == "jobs: 0/0 0/1 1/0 1/1 2/0 2/1"


COUNTING = """
    from pathlib import Path

    from arena_core import hookimpl
    from arena_core.hosting import Executor

    class Counting(Executor):
        def map(self, work, jobs):
            print("jobs:", *(f"{Path(job.folder).name}/{job.episode}" for job in jobs))
            return map(work, jobs)

    @hookimpl
    def register_executors(register):
        register("counting", Counting)

    @hookimpl
    def config_package():
        return "counting.conf"
"""


@pytest.mark.parametrize(
    ("sweep", "message"),
    [
        ("planner.gain=1,-1", "arena: planner.gain is -1; allowed: > 0"),
        ("planner=pure_pursuit,dwaa", "arena: unknown planner 'dwaa'"),
    ],
)
def test_one_wrong_job_stops_the_sweep_before_anything_runs(arena, sweep, message):
    answer = arena("run", *SWEEP, sweep)
    assert answer.status == 2
    assert answer.line.startswith(message)
    assert not list(Path().rglob("records"))


def test_one_failed_episode_is_the_status_of_the_sweep(third_party, arena):
    third_party.package("moody", MOODY, {"planner/moody": "name: moody\nbad: 0.0\n"})
    answer = arena("run", *SWEEP, "planner=moody", "planner.bad=0.0,1.0")
    assert (answer.status, answer.errors) == (1, ["episode 0 failed: ValueError: in a bad mood"])
    assert all(Path(f"sweep/{job}/episodes.csv").exists() for job in range(2))


MOODY = """
    from arena_core import Planner, Robot, Twist, hookimpl

    class Moody(Planner):
        def __init__(self, robot: Robot, bad: float) -> None:
            self.bad = bad

        def compute_velocity(self, observation):
            if self.bad:
                raise ValueError("in a bad mood")
            target = observation.pose.relative(observation.waypoint)
            return Twist(0.5, 0.0, 2.0 * target.y)

    @hookimpl
    def register_planners(register):
        register("moody", Moody)

    @hookimpl
    def config_package():
        return "moody.conf"
"""


def test_a_swept_folder_that_cannot_be_made_is_named(arena):
    Path("file").write_text("")
    answer = arena("run", *SWEEP, "hydra.sweep.dir=file/sweep")
    assert answer.status == 2
    assert answer.line.startswith("arena: cannot use the run's folder file/sweep")
