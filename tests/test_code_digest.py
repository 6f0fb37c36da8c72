"""A cell knows its code: digests follow the files of what takes part, and rows of other code
are never taken for the run's own.
"""

import csv
import json
import shutil
from pathlib import Path

import pytest

from arena_core import __version__
from arena_core.config.configuration import compose, to_plain
from arena_core.hosting import load_registry
from arena_core.records import read_record
from arena_core.runs.jobs.code_digest import _digest_code, digest_code

QUICK = (
    *("robot=jackal", "world=empty", "world.width=8", "world.height=8", "task.pedestrians=0", "localizer=ground_truth"),
    *("executor=serial", "report=false", "hydra.run.dir=run", "episodes=2"),
)
CREEPER = """
from arena_core import Planner, Twist, hookimpl


class Creeper(Planner):
    def compute_velocity(self, observation):
        return Twist(SPEED, 0.0, 0.0)


@hookimpl
def register_planners(register):
    register("creeper", Creeper)


@hookimpl
def config_package():
    return "creeper.conf"
"""
OPTION = "# @package planner\nname: creeper\n"
SLOW = ("planner=creeper", "task.time_limit=2", *QUICK)


def digest(*overrides):
    _digest_code.cache_clear()
    return digest_code(to_plain(compose([*overrides])), load_registry())


@pytest.fixture
def creeper(third_party):
    third_party.package("creeper", CREEPER.replace("SPEED", "0.1"), {"planner/creeper": OPTION})
    return third_party


def rows(folder="run"):
    with Path(folder, "episodes.csv").open(newline="") as file:
        return list(csv.DictReader(file))


def test_only_what_takes_part_counts():
    parts = digest("planner=pure_pursuit").parts
    assert {"arena-core", "arena-pure-pursuit", "arena-sim2d", "arena-kernels", "arena-tasks"} <= set(parts)
    assert not {"arena-dwa", "arena-metrics", "arena-gym"} & set(parts)
    assert parts["arena-core"].split()[0] == __version__


def test_members_of_a_switch_take_part():
    assert {"arena-aio", "arena-teb", "arena-rosnav", "arena-policies"} <= set(
        digest("planner=aio", "robot=jackal").parts
    )


def test_the_code_of_a_file_counts_but_not_how_its_lines_end_nor_what_was_compiled(creeper):
    module = creeper.folder / "creeper" / "__init__.py"
    first = digest("planner=creeper")
    module.write_bytes(module.read_bytes().replace(b"\n", b"\r\n"))
    creeper.write("creeper/__pycache__/x.pyc", "compiled")
    creeper.write("creeper/conf/planner/other.yaml", OPTION)
    assert digest("planner=creeper") == first
    module.write_text(CREEPER.replace("SPEED", "0.2"))
    other = digest("planner=creeper")
    assert other.digest != first.digest
    assert other.changed(first.parts) == ["creeper"]
    creeper.write("creeper/weights.bin", "1")
    assert digest("planner=creeper").digest != other.digest


def test_settings_of_a_run_do_not_count():
    assert digest("episodes=3", "seed=4", "executor=serial", "metrics=[paper_legacy]") == digest()


def test_rows_records_and_provenance_name_the_code(creeper, arena):
    assert arena("run", *SLOW).status == 0
    said = json.loads(Path("run/provenance.json").read_text())
    assert said["code"]["parts"]["creeper"].startswith("1.2.3 ")
    assert {row["code"] for row in rows()} == {said["code"]["digest"]}
    assert read_record(Path("run/records/0000.npz")).meta["columns"]["code"] == said["code"]["digest"]
    assert "code" not in said["config"]


def test_an_episode_that_failed_names_the_code_too(arena):
    arena("run", "planner=pure_pursuit", *QUICK, "world.width=0.2", "world.height=0.2")
    assert rows()[0]["outcome"] == "error"
    assert rows()[0]["code"] == json.loads(Path("run/provenance.json").read_text())["code"]["digest"]


def test_other_code_is_refused_and_forced_runs_only_what_changed(creeper, arena):
    assert arena("run", *SLOW).status == 0
    first = {path.name: path.read_bytes() for path in Path("run/records").iterdir()}
    creeper.write("creeper/__init__.py", CREEPER.replace("SPEED", "0.2"))
    answer = arena("run", *SLOW, "resume=true", "episodes=3")
    assert answer.status == 2
    assert "holds 2 episodes of other code: creeper; resume=force runs these again" in answer.line
    assert {path.name: path.read_bytes() for path in Path("run/records").iterdir()} == first

    assert arena("run", *SLOW, "resume=force", "episodes=3").status == 0
    assert len({row["code"] for row in rows()}) == 1
    shutil.copy("run/records/0000.npz", "kept.npz")
    stamp = Path("run/records/0000.npz").stat().st_mtime_ns
    assert arena("run", *SLOW, "resume=force", "episodes=4").status == 0
    assert Path("run/records/0000.npz").stat().st_mtime_ns == stamp


def test_only_the_episodes_of_other_code_are_run_anew(creeper, arena):
    assert arena("run", *SLOW, "hydra.run.dir=old").status == 0
    creeper.write("creeper/__init__.py", CREEPER.replace("SPEED", "0.2"))
    assert arena("run", *SLOW).status == 0
    shutil.copy("old/records/0001.npz", "run/records/0001.npz")
    stamp = Path("run/records/0000.npz").stat().st_mtime_ns
    answer = arena("run", *SLOW, "resume=true")
    assert "holds 1 episode of other code: changed while it ran" in answer.line
    assert arena("run", *SLOW, "resume=force").status == 0
    assert Path("run/records/0000.npz").stat().st_mtime_ns == stamp
    assert len({row["code"] for row in rows()}) == 1


@pytest.mark.slow
def test_a_worker_that_dies_does_not_pass_off_an_old_record_as_its_own(creeper, arena):
    assert arena("run", *SLOW).status == 0
    dying = CREEPER.replace("return Twist(SPEED, 0.0, 0.0)", "__import__('os')._exit(3)")
    creeper.write("creeper/__init__.py", dying)
    words = [word for word in SLOW if word != "executor=serial"]
    assert arena("run", *words, "executor=processes", "executor.workers=1", "resume=force").status == 1
    assert [(row["outcome"], row["error"]) for row in rows()] == [("error", "worker died: exit status 3")] * 2
    assert len({row["code"] for row in rows()}) == 1


def test_resume_allows_true_false_and_force(arena):
    answer = arena("run", "planner=pure_pursuit", *QUICK, "resume=maybe")
    assert answer.status == 2
    assert "resume is 'maybe'; allowed: one of True, False, force" in answer.line
