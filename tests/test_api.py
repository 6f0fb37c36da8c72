"""The way in from Python: what ``arena.run`` leaves is what the command line leaves, wherever it is called from."""

import inspect
import pkgutil
import subprocess
import sys
from importlib import import_module
from textwrap import dedent

import numpy as np
import pytest

import arena_core
from arena_core import ArenaError, ConfigurationError, Runs, run
from arena_core.hosting import run_jobs

SMALL = [
    "robot=jackal",
    "world=empty",
    "world.width=8",
    "world.height=8",
    "localizer=ground_truth",
    "task.pedestrians=1",
    "episodes=5",
]
SCRIPT = f"""
import arena_core as arena
runs = arena.run(["planner=pure_pursuit", "executor.workers=1", *{SMALL!r}], "run")
print(len(runs), runs.episodes["outcome"].tolist())
"""


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    return run(["planner=dwa,pure_pursuit", *SMALL, "executor.workers=1"], tmp_path_factory.mktemp("api") / "runs")


def test_every_combination_is_a_run_with_its_table_and_records(runs):
    assert [one.config["planner"]["name"] for one in runs] == ["dwa", "pure_pursuit"]
    assert [one.folder.name for one in runs] == ["0", "1"]
    assert runs.episodes.groupby("preset")["episode"].apply(list).to_dict() == {
        "dwa": [0, 1, 2, 3, 4],
        "pure_pursuit": [0, 1, 2, 3, 4],
    }
    record = runs[0].record(3)
    assert record.meta["columns"]["episode"] == 3
    assert np.isfinite(record["pose"]).all()
    assert repr(runs[:1]) == f"<Run of dwa on jackal: {runs[0].folder}>"
    assert len(Runs.below(runs[0].folder.parent)) == 2


def test_each_folder_may_have_words_of_its_own(tmp_path):
    small = ["planner=pure_pursuit", *SMALL, "executor=serial", "task.time_limit=2", "episodes=1"]
    jobs = {tmp_path / "a": [*small, "seed=3"], tmp_path / "b": [*small, "seed=4", "task.pedestrians=2"]}
    found = run_jobs(jobs)
    assert [one.folder for one in found] == list(jobs)
    assert found.episodes["seed"].tolist() == [3, 4]
    with pytest.raises(ConfigurationError, match="resume=true continues it"):
        run_jobs(jobs)


def test_planners_are_compared_on_the_same_scenarios(runs):
    table = runs.compare("dwa")
    assert set(table["planner"]) == {"pure_pursuit"}
    assert set(table["baseline"]) == {"dwa"}
    success = table[table["metric"] == "success"].iloc[0]
    assert success["pairs"] == 5
    episodes = runs.episodes.pivot(index="episode", columns="preset", values="success")
    assert success["difference"] == pytest.approx((episodes["pure_pursuit"] - episodes["dwa"]).mean())
    assert success["low"] <= success["difference"] <= success["high"]
    with pytest.raises(ArenaError, match=r"baseline is teb; allowed: dwa, pure_pursuit"):
        runs.compare("teb")


def test_a_report_is_written_where_it_is_wanted(runs, tmp_path, capsys):
    assert (runs.report(tmp_path / "out") / "index.html").exists()
    assert "dwa" in capsys.readouterr().out


def test_a_run_from_python_is_the_run_of_the_command_line(arena, runs):
    assert arena("run", "planner=dwa", *SMALL, "executor.workers=1", "report=false", "hydra.run.dir=same").status == 0
    there = Runs.below("same")[0]
    assert there.provenance["config_hash"] == runs[0].provenance["config_hash"]
    assert [path.read_bytes() for path in sorted(there.folder.glob("records/*"))] == [
        path.read_bytes() for path in sorted(runs[0].folder.glob("records/*"))
    ]


@pytest.mark.slow
def test_a_plain_script_without_a_main_guard_runs_in_worker_processes(tmp_path):
    (tmp_path / "script.py").write_text(SCRIPT)
    done = subprocess.run([sys.executable, "script.py"], cwd=tmp_path, capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-1].startswith("1 [")
    assert done.stdout.count("1 [") == 1


@pytest.mark.slow
def test_it_works_inside_a_hydra_application_which_goes_on_afterwards(tmp_path):
    (tmp_path / "app.py").write_text(
        dedent(
            """
            import hydra
            from hydra.core.hydra_config import HydraConfig

            @hydra.main(config_path=None, version_base="1.3")
            def main(config):
            {body}
                print(HydraConfig.get().job.name)

            main()
            """
        ).format(body="\n".join(f"    {line}" for line in SCRIPT.splitlines()))
    )
    done = subprocess.run([sys.executable, "app.py"], cwd=tmp_path, capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-1] == "app"
    assert "1 [" in done.stdout.splitlines()[-2]


def test_a_wrong_request_is_one_line_before_anything_runs(tmp_path):
    with pytest.raises(ConfigurationError, match="planer"):
        run(["planer=dwa"], tmp_path / "run")
    assert not (tmp_path / "run").exists()
    (tmp_path / "file").touch()
    with pytest.raises(ConfigurationError, match="file, a file; allowed: a folder"):
        run(SMALL, tmp_path / "file")


def test_no_module_shares_the_name_of_what_the_core_offers():
    functions = {name for name in arena_core.__all__ if not inspect.ismodule(getattr(arena_core, name))}
    assert not functions & {module.name for module in pkgutil.iter_modules(arena_core.__path__)}
    for module in pkgutil.iter_modules(arena_core.__path__):
        import_module(f"arena_core.{module.name}")
    assert all(not inspect.ismodule(getattr(arena_core, name)) for name in functions)
