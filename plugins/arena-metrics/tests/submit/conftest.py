from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

import arena_submit.standing
from arena_core import run as run_benchmark
from arena_submit.packing import write_pack
from arena_submit.standing import Standing, read_standing

ROOM = ("planner=pure_pursuit", "robot=jackal", "world=empty", "world.width=6", "world.height=6", "task.pedestrians=1")
QUIET = ("executor=serial", "report=false")


@pytest.fixture(scope="session")
def finished(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the folder of a run of three short episodes."""
    folder = tmp_path_factory.mktemp("finished") / "run"
    run_benchmark([*ROOM, *QUIET, "episodes=3"], folder)
    return folder


@pytest.fixture
def copied(finished: Path, tmp_path: Path) -> Path:
    """Return a copy of the run, to be spoilt."""
    return Path(shutil.copytree(finished, tmp_path / "copied"))


@pytest.fixture
def packed(finished: Path, tmp_path: Path) -> Path:
    """Return the run's pack."""
    write_pack([finished], tmp_path / "pack.zip")
    return tmp_path / "pack.zip"


@pytest.fixture(scope="session")
def small_standing() -> Standing:
    """Return arena_v1 with one robot, one scenario and five episodes."""
    whole = read_standing("arena_v1")
    return Standing("arena_v1", 5, 0, ["jackal"], {"arena/warehouse_05": whole.scenarios["arena/warehouse_05"]})


@pytest.fixture(scope="session")
def faced(tmp_path_factory: pytest.TempPathFactory) -> Callable[..., Path]:
    """Return what packs the small benchmark, driven by pure pursuit so fast; each once."""
    known: dict[tuple[str, ...], Path] = {}

    def drive(*words: str) -> Path:
        if words not in known:
            folder = tmp_path_factory.mktemp("faced")
            asked = ["experiment=arena_v1", "planner=pure_pursuit", "robot=jackal", "scenario=arena/warehouse_05"]
            run_benchmark([*asked, *QUIET, *words], folder / "run")
            write_pack([folder / "run"], folder / "pack.zip")
            known[words] = folder / "pack.zip"
        return known[words]

    return drive


@pytest.fixture
def small(monkeypatch: pytest.MonkeyPatch, small_standing: Standing) -> Standing:
    """Have arena_v1 be the small one."""
    monkeypatch.setattr(arena_submit.standing, "read_standing", lambda name: small_standing)
    arena_submit.standing._fixed_values.cache_clear()
    return small_standing
