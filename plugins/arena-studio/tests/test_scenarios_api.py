"""The API of the scenario editor: any format opens as one model, what is wrong is told with its
place, and a scene moves.
"""

import base64
import gzip
import json
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from fastapi.testclient import TestClient

from arena_core import ArenaError
from arena_studio.app import make_app
from arena_studio.background.process import SideProcess, side_processes
from arena_studio.background.requests import ListScenarios
from arena_studio.project import Project
from arena_tasks.commands.packing import ANYBODY
from arena_tasks.scenario_files.scenario_file import content_of, read_scenario_file
from arena_viewer.document import read_document

DATA = Path(__file__).parents[3] / "tests" / "data"
SCENES = {"format": "arena-scenario", "version": 2, "map": "maps/hall/map.yaml"}
SCENE = {"name": "a", "start": [1.0, 4.0, 0.0], "goal": [11.0, 4.0]}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    root = tmp_path_factory.mktemp("project")
    for name in ("maps", "scenarios"):
        shutil.copytree(DATA / name, root / name)
    yield root
    for process in side_processes(root.resolve()):
        process.close()


@pytest.fixture(scope="module")
def client(folder: Path) -> TestClient:
    app = make_app(Project(folder), "token")
    return TestClient(app, base_url="http://127.0.0.1", cookies={"arena_studio": "token"})


def content(*scenes: dict[str, Any]) -> dict[str, Any]:
    return {**SCENES, "scenarios": list(scenes)}


def check(client: TestClient, *scenes: dict[str, Any]) -> list[dict[str, Any]]:
    asked = {"path": "scenes.json", "content": content(*scenes), "map": "maps/hall/map.yaml", "robot": "jackal"}
    answer = client.post("/api/scenarios/check", json=asked)
    assert answer.status_code == 200, answer.text
    found: list[dict[str, Any]] = answer.json()["findings"]
    return found


def save(client: TestClient, path: str, what: Any, version: str = "none") -> Any:
    return client.put(f"/api/scenarios/file?path={path}", json=what, headers={"If-Match": version})


def test_all_formats_are_listed_and_other_files_are_not(client: TestClient, folder: Path) -> None:
    (folder / "other.json").write_text("{}")
    (folder / "spoilt.json").write_text('{"format": "arena-scenario", "version": 9}')
    rows = {row["path"]: row for row in client.get("/api/scenarios").json()}
    assert rows["scenarios/hall_obs03.json"] | {"title": ""} == {
        "path": "scenarios/hall_obs03.json",
        "format": "arena-tools",
        "title": "",
        "scenes": 1,
        "map": "maps/hall/map.yaml",
    }
    assert rows["spoilt.json"]["error"] == "version is 9; allowed: 1 or 2"
    assert "other.json" not in rows


@pytest.mark.parametrize("path", sorted((DATA / "scenarios").glob("*.json")), ids=lambda path: path.stem)
def test_every_file_opens_is_saved_in_our_format_and_reads_back_equal(
    client: TestClient, folder: Path, path: Path
) -> None:
    opened = client.get(f"/api/scenarios/file?path=scenarios/{path.name}").json()
    assert opened["map"] == "maps/hall/map.yaml"
    target = f"scenarios/{path.stem}.ours.json"
    assert save(client, target, opened["content"]).status_code == 200
    before, after = read_scenario_file(path, ANYBODY).problems, read_scenario_file(folder / target, ANYBODY).problems
    assert content_of(before) == content_of(after)
    again = client.get(f"/api/scenarios/file?path={target}").json()
    assert again["content"] == opened["content"]
    assert again["format"] == "arena-scenario"


def test_what_a_file_of_ours_leaves_open_stays_open(client: TestClient, folder: Path) -> None:
    person = {"position": [3.0, 6.0], "max_speed": 0.5}
    (folder / "old.json").write_text(
        json.dumps({"format": "arena-scenario", "version": 1, "scenarios": [{**SCENE, "pedestrians": [person]}]})
    )
    opened = client.get("/api/scenarios/file?path=old.json").json()["content"]
    assert opened["version"] == 2
    assert opened["scenarios"][0]["pedestrians"] == [{"position": [3.0, 6.0], "desired_speed": 0.5}]
    assert "time_limit" not in opened["scenarios"][0]


def test_a_conflict_is_told_and_nothing_is_overwritten(client: TestClient, folder: Path) -> None:
    version = save(client, "mine.json", content(SCENE)).json()["version"]
    newer = save(client, "mine.json", content({**SCENE, "name": "b"}), version).json()["version"]
    answer = save(client, "mine.json", content({**SCENE, "name": "c"}), version)
    assert answer.status_code == 409
    assert json.loads((folder / "mine.json").read_text())["scenarios"][0]["name"] == "b"
    assert client.get("/api/scenarios/file?path=mine.json").json()["version"] == newer


@pytest.mark.parametrize(
    ("path", "what", "said"),
    [
        ("a.yaml", content(SCENE), "path is a.yaml; allowed: a name that ends in .json"),
        ("../a.json", content(SCENE), "allowed: a path inside the project folder"),
        ("a.json", content(), "scenarios is []; allowed: at least one scenario"),
        ("a.json", content({**SCENE, "start": [0, "x"]}), 'scenarios[0].start[1] is "x"'),
        ("a.json", [], "wrong"),
    ],
)
def test_what_could_not_be_read_again_is_not_saved(client: TestClient, path: str, what: Any, said: str) -> None:
    answer = save(client, path, what)
    assert answer.status_code == 400
    assert said in answer.json()["error"]


def test_nothing_is_found_in_a_scene_that_can_be_run(client: TestClient) -> None:
    assert (
        check(
            client,
            {
                **SCENE,
                "pedestrians": [{"position": [2.0, 2.0], "waypoints": [[10.0, 2.0]], "behaviour": {"type": "child"}}],
            },
        )
        == []
    )


def test_every_fault_is_told_with_scene_key_and_place(client: TestClient) -> None:
    people = [
        {"position": [0.0, 0.0], "waypoints": [[2.0, 2.0], [99.0, 2.0]]},
        {"position": [2.0, 2.0], "behaviour": {"typ": "child"}},
    ]
    found = check(client, SCENE, {**SCENE, "name": "b", "start": [0.0, 0.0], "pedestrians": people})
    assert [(row["scene"], row["key"], row["place"]) for row in found] == [
        (1, "scenarios[1].start", [0.0, 0.0]),
        (1, "scenarios[1].pedestrians[0]", [0.0, 0.0]),
        (1, "scenarios[1].pedestrians[0]", [99.0, 2.0]),
        (1, "scenarios[1].pedestrians[0]", [0.0, 0.0]),
        (1, "scenarios[1].pedestrians[1]", None),
    ]
    assert "its waypoint 1 lies outside the map" in found[2]["line"]
    assert "behaviour has no typ" in found[4]["line"]


def test_what_cannot_be_read_is_a_finding_with_its_key(client: TestClient) -> None:
    (found,) = check(client, {**SCENE, "obstacles": [{"center": [3, 3], "radius": -1}]})
    assert (found["scene"], found["key"]) == (0, "scenarios[0].obstacles[0].radius")
    assert "is -1; allowed: a number > 0" in found["line"]


def test_a_map_comes_as_cells(client: TestClient) -> None:
    answer = client.get("/api/scenarios/map?path=maps/hall/map.yaml").json()
    height, width = answer["shape"]
    cells = gzip.decompress(base64.b64decode(answer["cells"]))
    assert len(cells) == height * width
    assert set(cells) == {0, 1, 2}


def test_a_preview_is_a_replay_document_of_the_scene(client: TestClient) -> None:
    asked = {"path": "s.json", "map": "maps/hall/map.yaml", "scene": 1, "seconds": 3.0}
    scenes = content(
        SCENE, {**SCENE, "name": "b", "pedestrians": [{"position": [2.0, 2.0], "waypoints": [[10.0, 2.0]]}]}
    )
    answer = client.post("/api/scenarios/preview", json={**asked, "content": scenes})
    assert answer.status_code == 200, answer.text
    raw = gzip.decompress(base64.b64decode(answer.json()["document"]))
    assert raw[:4] == b"ARPL"
    header = json.loads(raw[8 : 8 + int.from_bytes(raw[4:8], "little")])
    (episode,) = header["episodes"]
    assert episode["columns"]["n_pedestrians"] == 1
    assert episode["columns"]["planner"] == "pure_pursuit"
    assert episode["gait"] is None
    refused = client.post(
        "/api/scenarios/preview", json={**asked, "content": content(SCENE, {**SCENE, "name": "b", "start": [0.0, 0.0]})}
    )
    assert refused.status_code == 400
    assert "lies inside a wall" in refused.json()["error"]


@pytest.mark.parametrize(("pedestrians", "walk"), [("social_force", True), ("none", False)])
def test_people_of_a_preview_walk_on_legs_where_their_model_can(
    client: TestClient, pedestrians: str, walk: bool
) -> None:
    scenes = content({**SCENE, "pedestrians": [{"position": [2.0, 2.0], "waypoints": [[10.0, 2.0]]}]})
    asked = {
        "path": "s.json",
        "map": "maps/hall/map.yaml",
        "scene": 0,
        "seconds": 1.0,
        "legs": True,
        "pedestrians": pedestrians,
    }
    answer = client.post("/api/scenarios/preview", json={**asked, "content": scenes})
    assert answer.status_code == 200, answer.text
    (episode,) = read_document(base64.b64decode(answer.json()["document"]))[0]["episodes"]
    assert (episode["gait"] is not None) == walk


@pytest.mark.parametrize("written", ["arena-tools", "arena-rosnav"])
def test_a_scene_is_exported_with_its_obstacles_as_models(client: TestClient, folder: Path, written: str) -> None:
    scene = {**SCENE, "time_limit": 30.0, "obstacles": [{"center": [3.0, 3.0], "radius": 0.4}]}
    asked = {"path": "s.json", "map": "maps/hall/map.yaml", "scene": 0, "content": content(scene), "format": written}
    answer = client.post("/api/scenarios/export", json={**asked, "target": f"out/{written}.json"})
    assert answer.status_code == 200, answer.text
    assert answer.json()["written"] == [f"out/{written}.json", f"out/{written}.obstacle_0.model.yaml"]
    assert "time_limit" in answer.json()["left_out"]
    if written == "arena-tools":
        (problem,) = read_scenario_file(folder / "out" / f"{written}.json", ANYBODY).problems
        assert problem.obstacles[0].radius == pytest.approx(0.4)
    again = client.post("/api/scenarios/export", json={**asked, "target": f"out/{written}.json"})
    assert again.status_code == 409


def test_kinds_name_what_a_scene_can_be_made_of(client: TestClient) -> None:
    kinds = client.get("/api/scenarios/kinds").json()
    assert {"jackal", "turtlebot3"} <= set(kinds["robot"])
    assert "dwa" in kinds["planner"]
    assert kinds["furniture"]["table"][0]["vertices_xy"]
    assert kinds["behaviour"]["wait_time"]["unit"] == "s"


def test_what_takes_too_long_is_ended_and_the_next_request_is_answered(folder: Path) -> None:
    process = SideProcess(folder)
    with pytest.raises(ArenaError, match=r"took longer than 0\.01 s"):
        process.ask(ListScenarios(names=[]), 0.01)
    assert process.ask(ListScenarios(names=[]), 20.0) == []
    process.close()
