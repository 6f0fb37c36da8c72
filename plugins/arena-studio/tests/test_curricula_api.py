"""The API of the task editor: curricula are checked and saved, rules draw scenes,
files become packs that a run takes.
"""

import json
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import yaml
from fastapi.testclient import TestClient

from arena_core.cli.main import main
from arena_studio.app import make_app
from arena_studio.background.process import side_processes
from arena_studio.project import Project
from arena_tasks.random.curriculum import read_curriculum

DATA = Path(__file__).parents[3] / "tests" / "data"
HALL = "maps/hall/map.yaml"
LEVEL = {"difficulty": None, "obstacles": 1, "pedestrians": 4, "pedestrian_speed": 0.3, "speed_share": 1.0}
SCENE = {"name": "a", "start": [1.0, 4.0, 0.0], "goal": [11.0, 4.0]}
OURS = {
    "format": "arena-scenario",
    "version": 2,
    "title": "Straight through the hall",
    "map": "maps/hall/map.yaml",
    "scenarios": [SCENE],
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    root = tmp_path_factory.mktemp("project")
    for name in ("maps", "scenarios"):
        shutil.copytree(DATA / name, root / name)
    (root / "straight.json").write_text(json.dumps(OURS))
    yield root
    for process in side_processes(root.resolve()):
        process.close()


@pytest.fixture(scope="module")
def client(folder: Path) -> TestClient:
    return TestClient(
        make_app(Project(folder), "token"), base_url="http://127.0.0.1", cookies={"arena_studio": "token"}
    )


def save(client: TestClient, path: str, levels: Any, version: str = "none") -> Any:
    return client.put(f"/api/curricula/file?path={path}", json=levels, headers={"If-Match": version})


def test_a_built_in_curriculum_is_saved_as_a_file_that_says_the_same(client: TestClient, folder: Path) -> None:
    assert {row["path"] for row in client.get("/api/curricula").json()["built_in"]} == {"released", "growing"}
    levels = client.get("/api/curricula/file?path=growing").json()["levels"]
    assert save(client, "curricula/mine.yaml", levels).status_code == 200
    mine, theirs = read_curriculum(str(folder / "curricula" / "mine.yaml")), read_curriculum("growing")
    assert mine.content_hash == theirs.content_hash
    assert {"path": "curricula/mine.yaml", "levels": 12} in client.get("/api/curricula").json()["files"]
    assert client.get("/api/curricula/file?path=curricula/mine.yaml").json()["levels"] == levels


def test_every_wrong_level_is_told_with_its_key(client: TestClient) -> None:
    levels = [LEVEL, {**LEVEL, "speed_share": 2}, {**LEVEL, "min_distance": 9, "max_distance": 8}, {"difficulty": 0.5}]
    found = client.post("/api/curricula/check", json=levels).json()["findings"]
    assert [(row["level"], row["key"]) for row in found] == [(1, "speed_share"), (2, "min_distance"), (3, "obstacles")]
    assert found[0]["line"] == "levels.1.speed_share is 2; allowed: a number > 0 and <= 1"
    refused = save(client, "curricula/wrong.yaml", levels)
    assert refused.status_code == 400
    assert "levels.1.speed_share" in refused.json()["error"]


def test_a_curriculum_that_was_changed_elsewhere_is_not_overwritten(client: TestClient) -> None:
    version = save(client, "curricula/two.yaml", [LEVEL]).json()["version"]
    save(client, "curricula/two.yaml", [LEVEL, LEVEL], version)
    assert save(client, "curricula/two.yaml", [], version).status_code == 400
    assert save(client, "curricula/two.yaml", [LEVEL], version).status_code == 409


def test_rules_draw_the_same_scenes_again_on_a_map(client: TestClient) -> None:
    asked = {
        "rules": {"pedestrians": 3, "obstacles.count": 2, "trip.min_distance": 4.0},
        "map": "maps/hall/map.yaml",
        "count": 4,
        "seed": 7,
    }
    first, again = (client.post("/api/curricula/draws", json=asked).json() for _ in range(2))
    assert first == again
    assert len(first["maps"]) == 1
    assert [len(row["scene"]["pedestrians"]) for row in first["draws"]] == [3] * 4
    assert [len(row["scene"]["obstacles"]) for row in first["draws"]] == [2] * 4


def test_impossible_rules_are_one_line(client: TestClient) -> None:
    answer = client.post(
        "/api/curricula/draws",
        json={"rules": {"people.children": 0.7, "people.elders": 0.7}, "map": "maps/hall/map.yaml"},
    )
    assert answer.status_code == 400
    assert answer.json()["error"].startswith("task.people.elders is 0.7; allowed: up to 0.3")
    assert client.post("/api/curricula/draws", json={"rules": {"peopel": 1}, "map": HALL}).status_code == 400
    assert client.post("/api/curricula/draws", json={"rules": {"pedestrians": "1 world=x"}}).status_code == 400


def test_rules_are_kept_as_an_option_of_the_task(
    client: TestClient, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    answer = client.post(
        "/api/curricula/rules", json={"name": "busy", "rules": {"pedestrians": 12, "people.speed": 0.6}}
    )
    assert answer.json()["path"] == "conf/task/busy.yaml"
    said = yaml.safe_load((folder / "conf" / "task" / "busy.yaml").read_text())
    assert said == {"defaults": ["random", "_self_"], "pedestrians": 12, "people": {"speed": 0.6}}
    monkeypatch.chdir(folder)
    assert main(["run", "task=busy", "--cfg", "job"]) == 0
    taken = client.post("/api/curricula/rules", json={"name": "staged", "rules": {}})
    assert taken.json()["error"].startswith("name is staged; allowed: another one than")


def test_a_curriculum_with_its_rules_is_kept_as_an_option_of_the_task(
    client: TestClient, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    save(client, "curricula/three.yaml", [LEVEL, LEVEL, LEVEL])
    rules = {"path": "curricula/three.yaml", "block": 10, "random.goal_radius": 0.5, "random.trip.clearance": 3.0}
    answer = client.post("/api/curricula/rules", json={"name": "three", "task": "staged", "rules": rules})
    assert answer.status_code == 200, answer.text
    said = yaml.safe_load((folder / "conf" / "task" / "three.yaml").read_text())
    random = {"goal_radius": 0.5, "trip": {"clearance": 3.0}}
    assert said == {"defaults": ["staged", "_self_"], "path": "curricula/three.yaml", "block": 10, "random": random}
    monkeypatch.chdir(folder)
    assert main(["run", "task=three", "--cfg", "job"]) == 0
    wrong = client.post(
        "/api/curricula/rules", json={"name": "four", "task": "staged", "rules": {"random.trip.length": 3}}
    )
    assert wrong.status_code == 400
    assert (
        client.post("/api/curricula/rules", json={"name": "five", "task": "scenario", "rules": {}}).status_code == 400
    )


def test_files_become_a_pack_with_their_maps(client: TestClient, folder: Path) -> None:
    files = ["straight.json", "scenarios/hall_obs03.json"]
    made = client.post(
        "/api/curricula/packs", json={"folder": "packs/lab", "files": files, "id": "lab", "title": "Our lab"}
    )
    assert made.status_code == 200, made.text
    assert made.json()["options"] == ["scenario=lab/hall_obs03", "scenario=lab/straight"]
    (row,) = client.get("/api/curricula/packs").json()
    assert row["title"] == "Our lab"
    assert [one["name"] for one in row["scenarios"]] == ["scenarios/hall_obs03.json", "scenarios/straight.json"]
    assert main(["scenario", "check", str(folder / "packs" / "lab" / "scenarios" / "straight.json")]) == 0
    (folder / "packs" / "lab" / "scenarios" / "straight.json").write_text(json.dumps({**OURS, "title": "changed"}))
    assert "has changed" in client.get("/api/curricula/packs").json()[0]["error"]


def test_a_file_without_a_map_is_refused_for_a_pack(client: TestClient, folder: Path) -> None:
    (folder / "bare.json").write_text(json.dumps({key: value for key, value in OURS.items() if key != "map"}))
    answer = client.post("/api/curricula/packs", json={"folder": "packs/bare", "files": ["bare.json"]})
    assert answer.status_code == 400
    assert answer.json()["error"] == "bare.json: names no map of this project; allowed: a scenario file with a map"
    assert client.post("/api/curricula/packs", json={"folder": "../x", "files": []}).status_code == 400
