"""What the map editor's page asks for, as it asks for it."""

from __future__ import annotations

import gzip
import json
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fastapi.testclient import TestClient

from arena_core.hosting import load_registry
from arena_studio.app import make_app
from arena_studio.background.process import side_processes
from arena_studio.mapping.transfer import pack_cells, unpack_cells
from arena_studio.project import Project
from arena_tasks.commands.packing import ANYBODY
from arena_tasks.scenario_files.scenario_file import read_scenarios
from arena_worlds.commands.generate import world_parameters
from arena_worlds.commands.measures import measures_of
from arena_worlds.formats.ros_map import load_map

HALL = Path(__file__).resolve().parents[3] / "tests" / "data" / "maps" / "hall"
MAP = "maps/hall/map.yaml"


@pytest.fixture
def folder(tmp_path: Path) -> Iterator[Path]:
    shutil.copytree(HALL, tmp_path / "maps" / "hall")
    yield tmp_path
    for process in side_processes(tmp_path.resolve()):
        process.close()


@pytest.fixture
def client(folder: Path) -> TestClient:
    return client_of(folder)


@pytest.fixture(scope="module")
def reader(tmp_path_factory: pytest.TempPathFactory) -> Iterator[TestClient]:
    """Return a page whose project no one changes; its process beside the server starts once."""
    root = tmp_path_factory.mktemp("read")
    shutil.copytree(HALL, root / "maps" / "hall")
    yield client_of(root)
    for process in side_processes(root.resolve()):
        process.close()


def client_of(folder: Path) -> TestClient:
    app = make_app(Project(folder), "token")
    return TestClient(
        app, base_url="http://127.0.0.1", cookies={"arena_studio": "token"}, raise_server_exceptions=False
    )


def opened(client: TestClient, path: str) -> tuple[dict[str, Any], np.ndarray]:
    answer = client.get("/api/maps/file", params={"path": path})
    assert answer.status_code == 200, answer.text
    header, cells = unpack_cells(answer.content)
    return header, np.frombuffer(cells, np.uint8).reshape(header["height"], header["width"])


def test_a_stroke_goes_to_the_file_and_the_next_save_knows_its_version(client: TestClient, folder: Path) -> None:
    header, _ = opened(client, MAP)
    for column in (20, 40):
        body = pack_cells({**header, "rectangles": [[column, 30, 2, 3]]}, bytes([header["drawn"]["occupied"]]) * 6)
        answer = client.put("/api/maps/file", params={"path": MAP}, content=gzip.compress(body))
        header["version"] = answer.json()["version"]
    after = np.array(load_map(HALL / "map.yaml").data)[::-1]
    after[30:33, 20:22] = after[30:33, 40:42] = 100
    assert (load_map(folder / MAP).data == after[::-1]).all()
    assert client.get("/api/maps/version", params={"path": MAP}).json() == {"version": header["version"]}


def test_a_map_of_another_size_is_written_with_its_origin_and_all_else_kept(client: TestClient, folder: Path) -> None:
    image, text = folder / "maps" / "hall" / "map.pgm", folder / "maps" / "hall" / "map.yaml"
    before = np.array(load_map(text).data)
    first = image.read_bytes()
    image.write_bytes(first.replace(b"P5\n", b"P5\n# drawn by hand\n", 1))
    header, cells = opened(client, MAP)
    rows, columns = cells.shape
    larger = np.full((rows + 1, columns - 2), header["drawn"]["unknown"], np.uint8)
    larger[:rows] = cells[:, 2:]
    said = {
        "width": columns - 2,
        "height": rows + 1,
        "rectangles": [[0, 0, columns - 2, rows + 1]],
        "origin": [0.5, -0.25, 0.0],
    }
    answer = client.put(
        "/api/maps/file", params={"path": MAP}, content=pack_cells({**header, **said}, larger.tobytes())
    )
    assert answer.status_code == 200, answer.text
    grid = load_map(text)
    assert (grid.data[1:] == before[:, 2:]).all()
    assert (grid.data[0] == -1).all()
    assert (grid.origin.x, grid.origin.y) == (0.5, -0.25)
    assert image.read_bytes().startswith(f"P5\n# drawn by hand\n{columns - 2} {rows + 1}\n".encode())
    again, _ = opened(client, MAP)
    assert again["version"] == answer.json()["version"]


@pytest.mark.parametrize(
    "said",
    [
        {"width": 10},
        {"width": 10, "rectangles": [[0, 0, 5, 5]]},
        {"width": 10, "rectangles": [[0, 0, 10, 0]]},
        {"width": 10**5, "height": 10**5, "rectangles": [[0, 0, 10**5, 10**5]]},
        {"width": -1, "height": 4, "rectangles": [[0, 0, -1, 4]]},
        {"width": "10", "height": 4, "rectangles": [[0, 0, 10, 4]]},
    ],
)
def test_a_size_that_is_wrong_is_refused_and_nothing_is_written(
    client: TestClient, folder: Path, said: dict[str, Any]
) -> None:
    header, _ = opened(client, MAP)
    kept = (folder / "maps" / "hall" / "map.pgm").read_bytes()
    answer = client.put(
        "/api/maps/file",
        params={"path": MAP},
        content=pack_cells({**header, "rectangles": [[0, 0, 1, 1]], **said}, bytes(40)),
    )
    assert answer.status_code == 400, answer.text
    assert (folder / "maps" / "hall" / "map.pgm").read_bytes() == kept


def test_a_second_window_is_told_of_the_conflict(client: TestClient, folder: Path) -> None:
    header, _ = opened(client, MAP)
    body = pack_cells({**header, "rectangles": [[20, 30, 1, 1]]}, bytes(1))
    assert client.put("/api/maps/file", params={"path": MAP}, content=body).status_code == 200
    kept = (folder / "maps" / "hall" / "map.pgm").read_bytes()
    answer = client.put(
        "/api/maps/file",
        params={"path": MAP},
        content=pack_cells({**header, "rectangles": [[0, 0, 1, 1]]}, bytes((254,))),
    )
    assert answer.status_code == 409
    assert "changed by someone else" in answer.json()["error"]
    assert (folder / "maps" / "hall" / "map.pgm").read_bytes() == kept


def test_every_kind_of_world_is_drawn_as_the_command_line_draws_it(reader: TestClient) -> None:
    kinds = {one["name"]: one["parameters"] for one in reader.get("/api/maps/kinds").json()["kinds"]}
    assert {"indoor", "outdoor", "rooms", "cellular", "warehouse", "empty", "lab", "furnished", "mixed"} <= set(kinds)
    assert not {"ros_map", "file", "barn", "dynabarn", "scenario_map"} & set(kinds)
    assert kinds["rooms"]["door_width"] is None
    words = {"kind": "rooms", "seed": 3, "parameters": json.dumps({"difficulty": 0.8, "width": 10, "door_width": None})}
    answer = reader.get("/api/maps/draw", params=words)
    header, cells = unpack_cells(answer.content)
    world = load_registry().build("world", world_parameters("rooms", {"difficulty": "0.8", "width": "10"})).world(3, 0)
    values = np.array(header["values"], np.int8)[np.frombuffer(cells, np.uint8)].reshape(
        header["height"], header["width"]
    )
    assert (values[::-1] == world.grid.data).all()
    assert header["version"] is None


def test_a_drawn_world_is_kept_as_a_map(client: TestClient, folder: Path) -> None:
    header, cells = unpack_cells(client.get("/api/maps/draw", params={"kind": "indoor", "seed": 1}).content)
    answer = client.post(
        "/api/maps/copy",
        params={"path": "maps/mine.yaml"},
        content=gzip.compress(pack_cells({**header, "like": None}, cells)),
    )
    assert answer.status_code == 200, answer.text
    grid = load_registry().build("world", world_parameters("indoor", {})).world(1, 0).grid
    kept = load_map(folder / "maps" / "mine.yaml")
    assert (kept.data == grid.data).all()
    assert (kept.resolution, kept.origin) == (grid.resolution, grid.origin)
    again, _ = opened(client, "maps/mine.yaml")
    assert again["version"] == answer.json()["version"]


def test_measures_are_those_of_the_command_line(reader: TestClient) -> None:
    answer = reader.get("/api/maps/measures", params={"path": MAP, "robot_radius": 0.3})
    found = {one["name"]: one["value"] for one in answer.json()["measures"]}
    assert found == {name: value for name, value, _, _ in measures_of(load_map(HALL / "map.yaml"), 0.3).rows()}


def test_furniture_stands_in_a_scenario_file_that_the_task_reads(client: TestClient, folder: Path) -> None:
    assert {"table", "chair", "shelf"} <= set(client.get("/api/maps/furniture").json()["kinds"])
    assert client.get("/api/maps/scenarios", params={"path": MAP}).json() == {"files": []}
    made = client.post("/api/maps/scenarios", json={"path": "maps/hall/furnished.json", "map": MAP})
    assert made.status_code == 200, made.text
    (file,) = client.get("/api/maps/scenarios", params={"path": MAP}).json()["files"]
    pieces = [{"kind": "table", "pose": [3.0, 4.0, 0.5]}]
    sent = {"path": file["path"], "version": file["version"], "problem": "furnished", "furniture": pieces}
    assert client.put("/api/maps/furniture", json=sent).status_code == 200
    (problem,) = read_scenarios(folder / "maps" / "hall" / "furnished.json", ANYBODY)
    assert [(piece.kind, piece.pose.array().tolist()) for piece in problem.furniture] == [("table", [3.0, 4.0, 0.5])]
    assert client.put("/api/maps/furniture", json=sent).status_code == 409


def test_all_else_of_a_scenario_file_stays(client: TestClient, folder: Path) -> None:
    text = {"format": "arena-scenario", "version": 2, "map": "hall/map.yaml"}
    first = {
        "name": "a",
        "start": [1.0, 1.0, 0.0],
        "goal": [5.0, 4.0],
        "pedestrians": [{"position": [2.0, 2.0], "behaviour": {"type": "adult"}}],
    }
    (folder / "maps" / "scenes.json").write_text(json.dumps({**text, "scenarios": [first, {**first, "name": "b"}]}))
    (file,) = client.get("/api/maps/scenarios", params={"path": MAP}).json()["files"]
    pieces = [{"kind": "chair", "pose": [3.0, 4.0, 0.0]}]
    sent = {"path": file["path"], "version": file["version"], "problem": "b", "furniture": pieces}
    assert client.put("/api/maps/furniture", json=sent).status_code == 200
    after = json.loads((folder / "maps" / "scenes.json").read_text())
    assert after == {**text, "scenarios": [first, {**first, "name": "b", "furniture": pieces}]}


@pytest.mark.parametrize(
    ("method", "path", "words"),
    [
        ("get", "/api/maps/file", {"params": {"path": "../../etc/passwd"}}),
        ("get", "/api/maps/file", {"params": {"path": "maps"}}),
        ("get", "/api/maps/file", {"params": {"path": "maps/hall/map.pgm\0"}}),
        ("get", "/api/maps/draw", {"params": {"kind": "ros_map"}}),
        ("get", "/api/maps/draw", {"params": {"kind": "no such"}}),
        ("get", "/api/maps/draw", {"params": {"kind": "indoor", "seed": -1}}),
        ("get", "/api/maps/draw", {"params": {"kind": "indoor", "parameters": "[1"}}),
        ("get", "/api/maps/draw", {"params": {"kind": "indoor", "parameters": '{"width": "1 world=lab"}'}}),
        ("get", "/api/maps/draw", {"params": {"kind": "indoor", "parameters": '{"width": NaN}'}}),
        ("get", "/api/maps/draw", {"params": {"kind": "indoor", "parameters": '{"width": 1e5, "height": 1e5}'}}),
        ("get", "/api/maps/draw", {"params": {"kind": "indoor", "parameters": '{"no_such": 1}'}}),
        ("get", "/api/maps/measures", {"params": {"path": MAP, "robot_radius": "nan"}}),
        ("get", "/api/maps/measures", {"params": {"path": MAP, "robot_radius": "99"}}),
        ("put", "/api/maps/file", {"params": {"path": MAP}, "content": b"nothing"}),
        ("post", "/api/maps/copy", {"params": {"path": "x.yaml"}, "content": pack_cells({}, b"")}),
        (
            "post",
            "/api/maps/copy",
            {"params": {"path": "x.yaml"}, "content": pack_cells({"width": 10**9, "height": 10**9}, b"")},
        ),
        (
            "post",
            "/api/maps/copy",
            {"params": {"path": "x.yaml"}, "content": pack_cells({"width": 1, "height": 1, "samples": "no"}, b"\0")},
        ),
        (
            "post",
            "/api/maps/copy",
            {"params": {"path": "x.yaml"}, "content": pack_cells({"width": 1, "height": 1, "samples": [["a"]]}, b"\0")},
        ),
        ("put", "/api/maps/furniture", {"json": {"path": MAP, "version": "", "problem": "", "furniture": []}}),
        (
            "post",
            "/api/maps/scenarios",
            {"json": {"path": "a.json", "map": MAP, "furniture": [{"kind": "sofa", "pose": [0, 0, 0]}]}},
        ),
        ("post", "/api/maps/scenarios", {"json": {"path": "a.json", "map": MAP, "furniture": [7]}}),
    ],
)
def test_what_is_wrong_is_told_in_one_line(method: str, path: str, words: dict[str, Any], reader: TestClient) -> None:
    answer = reader.request(method, path, **words)
    assert 400 <= answer.status_code < 500, answer.text
    assert "\n" not in answer.json()["error"]
