"""Whatever is wrong with a request: one clear line, the right exit status, finished episodes
kept, no half-written file.
"""

import csv
import errno
import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from arena_core.loop import record_files

QUICK = (
    *("planner=pure_pursuit", "robot=jackal", "world=empty", "world.width=8", "world.height=8"),
    *(
        "task.pedestrians=0",
        "localizer=ground_truth",
        "executor=serial",
        "report=false",
        "hydra.run.dir=run",
        "episodes=1",
    ),
)
FREE, WALL = bytes((254,)), bytes((0,))
SITE = {
    "image": "site.pgm",
    "resolution": 0.1,
    "origin": [0.0, 0.0, 0.0],
    "negate": 0,
    "occupied_thresh": 0.65,
    "free_thresh": 0.196,
}
PROBLEM = {"name": "across", "start": [1.0, 1.0, 0.0], "goal": [5.0, 5.0]}
ON_SITE = (
    *(
        "planner=pure_pursuit",
        "robot=jackal",
        "world=ros_map",
        "world.path=site.yaml",
        "task=scenario",
        "task.path=scenario.json",
    ),
    *("localizer=ground_truth", "executor=serial", "report=false", "hydra.run.dir=run", "episodes=1"),
)


def rows(folder="run"):
    with Path(folder, "episodes.csv").open(newline="") as file:
        return list(csv.DictReader(file))


def records(folder="run"):
    return {path.name: path.read_bytes() for path in sorted(Path(folder, "records").glob("*"))}


def half_written(folder="."):
    return [path for path in Path(folder).rglob(".*") if path.is_file()]


def write_site(site=SITE, divided=False):
    """Write a map of 6 m by 6 m with a wall around it and, if ``divided``, one across it."""
    side = 60
    cells = [
        [WALL if r in (0, side - 1) or c in (0, side - 1) or (divided and c == 30) else FREE for c in range(side)]
        for r in range(side)
    ]
    Path("site.pgm").write_bytes(f"P5\n{side} {side}\n255\n".encode() + b"".join(b"".join(row) for row in cells))
    Path("site.yaml").write_text(site if isinstance(site, str) else json.dumps(site))


def write_scenario(content=PROBLEM):
    whole = {"format": "arena-scenario", "version": 1, "scenarios": [content]}
    Path("scenario.json").write_text(content if isinstance(content, str) else json.dumps(whole))


@pytest.mark.parametrize(
    ("override", "message"),
    [
        ("planner=pure_persuit", "unknown planner 'pure_persuit'; did you mean pure_pursuit? (possible: "),
        ("robot=segway", "unknown robot 'segway' (possible: "),
        (
            "metrics=[si,other]",
            "unknown metrics 'other' "
            "(possible: barn, company, human, paper_legacy, paper_published, si, social, survey, team)",
        ),
        ("experiment=smoek", "unknown experiment 'smoek'; did you mean smoke? (possible: "),
        ("planner.gian=2", "planner has no key gian; did you mean gain? (possible: gain, "),
        ("+planner.colour=red", "planner has no parameter colour (allowed: speed, turn_in_place_from, gain)"),
        ("epsiodes=3", "the configuration has no key epsiodes; did you mean episodes? (possible: "),
        ("~planner.gain", "planner lacks gain"),
        ("~planner", "the configuration lacks planner; `arena list` shows what can be chosen"),
        ("episodes=-1", "episodes is -1; allowed: >= 1"),
        ("episodes=0", "episodes is 0; allowed: >= 1"),
        ("episodes=1.5", "episodes is 1.5; allowed: a whole number"),
        ("seed=-1", "seed is -1; allowed: >= 0"),
        ("planner.gain=0", "planner.gain is 0; allowed: > 0"),
        ("planner.gain=nan", "planner.gain is nan; allowed: a number"),
        ("planner.gain=fast", "planner.gain is 'fast'; allowed: a number"),
        (
            "+planner.control_period=0.033",
            "planner.control_period is 0.033; allowed: multiples of the inner step 0.01 s",
        ),
        ("timing.mode=idael", "timing.mode is 'idael'; allowed: one of ideal, latency, measured"),
        ("timing.latency=-1", "timing.latency is -1; allowed: >= 0"),
        ("replan.period=0", "replan.period is 0; allowed: > 0"),
        ("world=ros_map", "world has no key width (possible: "),
        ("episodes=[", "episodes=[ cannot be read: "),
    ],
)
def test_a_wrong_request_is_one_line_that_says_what_is_allowed(arena, override, message):
    answer = arena("run", *QUICK, override)
    assert answer.status == 2
    assert answer.line.startswith(f"arena: {message}")
    assert not Path("run", "records").exists()
    assert not half_written()


def test_a_localizer_that_needs_a_map_is_refused_where_the_robot_has_none(arena):
    words = [word.replace("ground_truth", "amcl") for word in QUICK]
    answer = arena("run", *words, "world.known=false")
    assert answer.status == 2
    assert answer.line.startswith(
        "arena: world.known is false and localizer amcl needs a map; allowed: world.known=true, or another"
    )


def test_a_robot_without_extent_is_refused(arena):
    answer = arena("run", *QUICK, "robot=turtlebot3", "robot.footprint.radius=0")
    assert (answer.status, answer.line) == (2, "arena: robot.footprint.radius is 0; allowed: > 0")


def test_an_unknown_command_lists_the_commands(arena):
    answer = arena("rum")
    assert answer.status == 2
    assert answer.line.startswith("arena: unknown command 'rum'; did you mean run? (possible: break, check, ")
    assert ", evaluate, " in answer.line


@pytest.mark.parametrize(
    ("site", "message"),
    [
        ({**SITE, "image": "lost.pgm"}, "lost.pgm"),
        ("image: [site.pgm\nresolution: 0.1\n", "site.yaml"),
        ({**SITE, "resolution": -0.1}, "resolution"),
        ({k: v for k, v in SITE.items() if k != "image"}, "image"),
        ({**SITE, "image": "site.yaml"}, "site.yaml"),
    ],
)
def test_a_map_that_cannot_be_read_is_named_with_its_key(arena, site, message):
    write_site(site)
    write_scenario()
    answer = arena("run", *ON_SITE)
    assert answer.status == 2
    assert message in answer.line
    assert "site.yaml" in answer.line or "lost.pgm" in answer.line


def test_a_map_that_is_not_there_is_named(arena):
    write_scenario()
    answer = arena("run", *ON_SITE, "world.path=nowhere.yaml")
    assert answer.status == 2
    assert "nowhere.yaml" in answer.line


@pytest.mark.parametrize(
    ("problem", "message"),
    [
        ("{", "scenario.json"),
        ("[]", "scenario.json"),
        ({"name": "across", "goal": [5.0, 5.0]}, "start"),
        ({**PROBLEM, "start": [1.0, "left"]}, "scenarios[0].start[1]"),
        ({**PROBLEM, "gaol": [5.0, 5.0]}, "gaol"),
        ({**PROBLEM, "start": [0.0, 1.0]}, "scenarios[0].start"),
        ({**PROBLEM, "start": [99.0, 1.0]}, "scenarios[0].start"),
        ({**PROBLEM, "goal": [5.95, 5.0]}, "scenarios[0].goal"),
    ],
)
def test_a_scenario_that_cannot_be_run_is_named_with_its_key(arena, problem, message):
    write_site()
    write_scenario(problem)
    answer = arena("run", *ON_SITE)
    assert answer.status == 2
    assert message in answer.line
    assert "scenario.json" in answer.line


def test_an_unreachable_goal_is_said_before_anything_runs(arena):
    write_site(divided=True)
    write_scenario()
    answer = arena("run", *ON_SITE)
    assert answer.status == 2
    assert "scenario.json" in answer.line
    assert "cannot be reached" in answer.line


def test_a_good_scenario_on_that_map_runs(arena):
    write_site()
    write_scenario()
    answer = arena("run", *ON_SITE)
    assert (answer.status, answer.errors) == (0, [])
    assert rows()[0]["outcome"] == "goal_reached"


ROGUE = """
    import math

    from arena_core import Planner, Robot, Twist, hookimpl

    class Rogue(Planner):
        episodes = 0

        def __init__(self, robot: Robot, answer: str, episode: int) -> None:
            self.answer, self.episode = answer, episode

        def reset(self, episode):
            self.steps, self.number = 0, Rogue.episodes
            Rogue.episodes += 1

        def compute_velocity(self, observation):
            self.steps += 1
            target = observation.pose.relative(observation.waypoint)
            if self.number != self.episode or self.steps < 4:
                bearing = math.atan2(target.y, target.x)
                return Twist(1.0 if abs(bearing) < 0.3 else 0.0, 0.0, 3.0 * bearing)
            return eval(self.answer)

    @hookimpl
    def register_planners(register):
        register("rogue", Rogue)

    @hookimpl
    def config_package():
        return "rogue.conf"
"""


@pytest.fixture
def rogue(third_party):
    third_party.package("rogue", ROGUE, {"planner/rogue": "name: rogue\nanswer: '1 / 0'\nepisode: 0\n"})


@pytest.mark.parametrize(
    ("answer", "message"),
    [
        ("1 / 0", "ZeroDivisionError: division by zero"),
        (
            "Twist(math.nan)",
            "InvalidCommand: Rogue.compute_velocity returned Twist(vx=nan, vy=0.0, wz=0.0); allowed: finite numbers",
        ),
        (
            "Twist(None)",
            "InvalidCommand: Rogue.compute_velocity returned Twist(vx=None, vy=0.0, wz=0.0); allowed: finite numbers",
        ),
        ("(1, 0, 0)", "InvalidCommand: Rogue.compute_velocity returned tuple; allowed: a Twist"),
        ("None", "InvalidCommand: Rogue.compute_velocity returned NoneType; allowed: a Twist"),
    ],
)
def test_a_planner_that_misbehaves_fails_its_episode_with_one_line(rogue, arena, answer, message):
    said = arena("run", *QUICK, "planner=rogue", f"planner.answer='{answer}'")
    assert said.status == 1
    assert said.line == f"episode 0 failed: {message}"
    (row,) = rows()
    assert (row["outcome"], row["error"]) == ("error", message)
    assert len(record_files.read_record(Path("run/records/0000.npz"))["stamp"]) == 4


def test_the_episodes_around_a_failed_one_are_run_and_kept(rogue, arena):
    said = arena("run", *QUICK, "planner=rogue", "planner.episode=1", "episodes=3")
    assert (said.status, said.line) == (1, "episode 1 failed: ZeroDivisionError: division by zero")
    assert [row["outcome"] for row in rows()] == ["goal_reached", "error", "goal_reached"]
    assert list(records()) == ["0000.npz", "0001.npz", "0002.npz"]


def test_a_folder_that_cannot_be_made_is_named(arena):
    Path("file").write_text("")
    answer = arena("run", *QUICK, "hydra.run.dir=file/run")
    assert answer.status == 2
    assert answer.line == "arena: cannot use the run's folder file/run: Not a directory"


def test_records_that_cannot_be_written_stop_the_run(arena):
    Path("run").mkdir()
    Path("run/records").write_text("in the way")
    answer = arena("run", *QUICK)
    assert answer.status == 1
    assert "run/records/0000.npz" in answer.line
    assert "resume=true" in answer.line
    assert Path("run/records").read_text() == "in the way"


def fill_disk_at(name, monkeypatch):
    """Let the disk be full from the first file called ``name`` on."""
    original, full = record_files.write_whole, []

    def half(file):
        file.write(b"half")
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    def write_whole(path, write):
        full.extend([True] * (path.name == name))
        original(path, half if full else write)

    monkeypatch.setattr(record_files, "write_whole", write_whole)


def test_a_full_disk_stops_the_run_and_what_is_finished_is_kept_and_continued(arena, monkeypatch):
    with monkeypatch.context() as patch:
        fill_disk_at("0002.npz", patch)
        answer = arena("run", *QUICK, "episodes=4")
    assert answer.status == 1
    assert answer.line.startswith("arena: cannot write ")
    assert "0002.npz: No space left on device; finished episodes are kept, resume=true" in answer.line
    assert list(records()) == ["0000.npz", "0001.npz"]
    assert not half_written()

    assert arena("run", *QUICK, "episodes=4", "resume=true").status == 0
    assert arena("run", *QUICK, "episodes=4", "hydra.run.dir=whole").status == 0
    assert records() == records("whole")
    assert [r["outcome"] for r in rows()] == [r["outcome"] for r in rows("whole")]


def test_a_run_is_never_written_over(arena):
    assert arena("run", *QUICK).status == 0
    before = records()
    answer = arena("run", *QUICK, "seed=1")
    assert answer.status == 2
    assert "holds a run already; resume=true continues it" in answer.line
    assert records() == before


@pytest.mark.parametrize("change", ["seed=1", "planner.gain=3"])
def test_only_the_same_run_is_continued(arena, change):
    assert arena("run", *QUICK).status == 0
    before = records()
    answer = arena("run", *QUICK, "resume=true", "episodes=2", change)
    assert answer.status == 2
    assert "holds a run of another configuration or seed" in answer.line
    assert records() == before


def test_a_damaged_record_is_named_when_a_run_is_continued(arena):
    assert arena("run", *QUICK).status == 0
    Path("run/records/0000.npz").write_bytes(b"half")
    answer = arena("run", *QUICK, "resume=true")
    assert answer.status == 2
    assert "run/records/0000.npz: damaged" in answer.line


@pytest.mark.parametrize("executor", ["serial", pytest.param("processes", marks=pytest.mark.slow)])
def test_ctrl_c_keeps_what_is_finished_and_the_run_can_be_continued(arena, executor):
    words = [
        *QUICK,
        "episodes=500",
        f"executor={executor}",
        *(["executor.workers=2"] if executor == "processes" else []),
    ]
    process = subprocess.Popen(
        [sys.executable, "-m", "arena_core.cli.main", "run", *words],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),  # as in a terminal, whatever started the tests
    )
    while not Path("run/records/0000.npz").exists():
        assert process.poll() is None, process.communicate()
        time.sleep(0.01)
    os.killpg(process.pid, signal.SIGINT)  # a terminal sends it to workers too
    _, said = process.communicate(timeout=600)
    assert process.returncode == 130
    assert said == "arena: interrupted; finished episodes are kept, resume=true out=DIR continues\n"
    finished = records()
    assert 0 < len(finished) < 500
    assert not half_written()
    assert {f"{int(row['episode']):04d}.npz" for row in rows()} <= set(finished)

    count = max(int(Path(name).stem) for name in finished) + 2
    assert arena("run", *QUICK, "resume=true", f"episodes={count}").status == 0
    assert finished.items() <= records().items()
    assert [int(row["episode"]) for row in rows()] == list(range(count))
    assert arena("run", *QUICK, "hydra.run.dir=whole", f"episodes={count}").status == 0
    assert records() == records("whole")
