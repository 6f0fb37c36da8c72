"""A project folder with tables of runs, and the studio on it."""

from __future__ import annotations

import csv
from collections.abc import Callable, Iterator
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from fastapi.testclient import TestClient

from arena_core.records import EPISODE_COLUMNS
from arena_studio.app import make_app
from arena_studio.background.process import side_processes
from arena_studio.project import Project

TOKEN = "a-token-of-tests"
METRICS = ("success", "time_to_goal", "collisions")
ROW = {
    **{
        "config_hash": "0badcafe",
        "code": "c0de",
        "planner": "dwa",
        "preset": "dwa",
        "robot": "jackal",
        "simulator": "sim2d",
        "world": "empty",
    },
    **{
        "task": "random",
        "scenario": "random/0",
        "pedestrian_model": "none",
        "n_pedestrians": 0,
        "seed": 0,
        "outcome": "goal_reached",
    },
    **{"success": 1.0, "time_to_goal": 12.5, "collisions": 0.0},
}

WriteRun = Callable[..., Path]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    place = tmp_path / "project"
    place.mkdir()
    return place


@pytest.fixture
def write_run(folder: Path) -> WriteRun:
    """Write a table of a run: each given row over a usual one."""

    def write(name: str, *rows: dict[str, Any]) -> Path:
        place = folder / name
        place.mkdir(parents=True, exist_ok=True)
        with (place / "episodes.csv").open("w", newline="") as file:
            writer = csv.DictWriter(file, [*EPISODE_COLUMNS, *METRICS], restval="", lineterminator="\n")
            writer.writeheader()
            writer.writerows({**ROW, "episode": number, **row} for number, row in enumerate(rows))
        return place

    return write


@pytest.fixture(scope="session")
def curve_folders() -> ModuleType:
    """Return the module that writes folders of tunings, ladders and trainings."""
    spec = spec_from_file_location("curve_folders", Path(__file__).with_name("curve_folders.py"))
    assert spec is not None
    assert spec.loader is not None
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture
def stranger(folder: Path) -> Iterator[TestClient]:
    """Return who does not know the token."""
    yield TestClient(make_app(Project(folder), TOKEN), base_url="http://127.0.0.1:8000")
    for process in side_processes(folder.resolve()):
        process.close()


@pytest.fixture
def client(stranger: TestClient) -> TestClient:
    """Return a page that was opened with the token."""
    assert stranger.get("/", params={"token": TOKEN}).status_code == 200
    return stranger
