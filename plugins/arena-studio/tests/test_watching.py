"""Experiments under way are watched by their names: the page, how they stand, their maps and
replays, and no other file.
"""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path

import pytest
from fastapi.testclient import TestClient

import arena_core as arena
from arena_studio.app import make_app
from arena_studio.experiments.experiments import PLACE, Experiment
from arena_studio.project import Project
from arena_viewer.document import read_document

NAME, FOLDER = "0badcafe", "outputs/watched"
WORDS = [
    "planner=pure_pursuit",
    "robot=jackal",
    "world=empty",
    "world.width=8",
    "world.height=8",
    "task.pedestrians=2",
    "episodes=2",
]


@pytest.fixture(scope="module")
def project(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with an experiment whose second episode has not ended yet."""
    root = tmp_path_factory.mktemp("watched")
    run = root / FOLDER
    arena.run([*WORDS, "executor=serial", "localizer=ground_truth", "report=false"], run)
    lines = (run / "episodes.csv").read_text().splitlines(keepends=True)
    (run / "episodes.csv").write_text("".join(lines[:-1]))
    (run / "live").mkdir()
    (run / "live" / "0001.json").write_text(
        json.dumps({"episode": 1, "worker": 7, "pose": [1.0, 2.0, 0.0], "people": []})
    )
    note = Experiment(NAME, ["run", *WORDS], FOLDER, 1, 2, "2026-01-31T12:00:00+00:00", 2**22, "1.0", None, False)
    (root / PLACE).mkdir(parents=True)
    (root / PLACE / f"{NAME}.json").write_text(json.dumps(asdict(note)))
    return root


@pytest.fixture
def watcher(project: Path) -> TestClient:
    client = TestClient(
        make_app(Project(project), "token"), base_url="http://127.0.0.1", cookies={"arena_studio": "token"}
    )
    assert client.get(f"/watch/{NAME}/state").status_code == 200
    return client


def test_page_shows_the_experiment_and_has_the_viewers_policy(watcher: TestClient) -> None:
    answer = watcher.get(f"/watch/{NAME}/")
    assert f"<title>{FOLDER}</title>" in answer.text
    assert "Runs under way" in answer.text
    assert "default-src 'none'" in answer.headers["content-security-policy"]
    assert 'id="picture"' in watcher.get(f"/watch/{NAME}/replay?run=0&episode=0").text


def test_state_tells_what_has_ended_and_what_runs(project: Path, watcher: TestClient) -> None:
    (project / FOLDER / "live" / "0001.json").touch()  # it has just told where it is
    answer = watcher.get(f"/watch/{NAME}/state")
    state = answer.json()
    (run,) = state["runs"]
    assert (state["total"], state["done"]) == (2, 1)
    assert [row["episode"] for row in run["rows"]] == ["0"]
    assert [said["pose"] for said in run["running"]] == [[1.0, 2.0, 0.0]]
    assert answer.headers["cache-control"] == "no-store"


def test_maps_and_episodes_of_the_run_are_given(project: Path, watcher: TestClient) -> None:
    (grid,) = (project / FOLDER / "worlds").glob("*.npz")
    told = watcher.get(f"/watch/{NAME}/map", params={"run": 0, "grid": f"worlds/{grid.name}"}).json()
    assert len(told["cells"]) == told["width"] * told["height"]
    header, _ = read_document(watcher.get(f"/watch/{NAME}/document", params={"run": 0, "episode": 0}).content)
    assert [one["columns"]["planner"] for one in header["episodes"]] == ["pure_pursuit"]


@pytest.mark.parametrize(
    ("path", "status"),
    [
        ("map?run=0&grid=../../.arena_studio/runs/0badcafe.json", 400),
        ("map?run=0&grid=records/0000.npz", 400),
        ("map?run=9&grid=worlds/00.npz", 400),
        ("document?run=0&episode=9", 400),
        ("document?run=0&episode=-1", 400),
        ("document", 400),
        ("secret", 404),
    ],
)
def test_nothing_else_is(watcher: TestClient, path: str, status: int) -> None:
    answer = watcher.get(f"/watch/{NAME}/{path}")
    assert answer.status_code == status, answer.text
    assert "\n" not in answer.json()["error"]


@pytest.mark.parametrize("what", ["", "state", "map", "document"])
def test_experiment_that_nobody_knows_is_told(watcher: TestClient, what: str) -> None:
    assert watcher.get(f"/watch/01234567/{what}").status_code == 404
