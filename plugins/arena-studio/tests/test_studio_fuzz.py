"""Thousands of spoilt requests and messages: nothing fails inside, nothing outside the folder is read or written."""

from __future__ import annotations

import json
import os
import random
from pathlib import Path
from typing import Any
from urllib.parse import quote

import pytest
from fastapi.testclient import TestClient
from starlette.websockets import WebSocketDisconnect

from arena_studio.app import make_app
from arena_studio.project import Project

TOKEN = "a-token-of-tests"
BASE = "http://127.0.0.1:8000"  # before each path: one that begins with // would be a host
OWN = {"Origin": "http://127.0.0.1:8000", "Host": "127.0.0.1:8000", "Cookie": f"arena_studio_8000={TOKEN}"}
COUNT = int(os.environ.get("FUZZ_REQUESTS", "1000"))  # make fuzz sends 10,000
SECRET = "this-is-outside"
IN_ENVIRONMENT = "this-is-in-the-environment"
INTERPOLATIONS = (
    "${oc.env:ARENA_FUZZ}",
    "'${oc.env:ARENA_FUZZ}'",
    "[${oc.env:ARENA_FUZZ}]",
    "{a: ${oc.env:ARENA_FUZZ}}",
    "${hydra:runtime.cwd}",
)
HYDRAS = (
    "hydra.run.dir",
    "++hydra.run.dir",
    "+hydra.searchpath",
    "hydra/launcher",
    "+planner@hydra.x",
    "hydra.run.dir=link/x",
    "~hydra/launcher",
)
PLACES = (
    "link/map.yaml",
    "linked.yaml",
    "mapped.yaml",
    "scene.json",
    "../../../outside/secret",
    "noted",
    "link",
    "pipe.yaml",
)
METHODS = ("GET", "POST", "PUT", "DELETE", "HEAD", "OPTIONS", "PATCH")
PIECES = (
    *(
        "..",
        ".",
        "%2e%2e",
        "..%2f",
        "%2f",
        "\\",
        "~",
        "%7f",
        "%00",
        "ü",
        "a",
        "secret.yaml",
        "inside.yaml",
        "link",
        "link/secret.yaml",
    ),
    *(
        "/etc/passwd",
        "../outside/secret.yaml",
        "-1",
        "1e99",
        "9" * 30,
        "nan",
        "null",
        "true",
        "[]",
        "{}",
        "'",
        '"',
        ";",
        "$(id)",
    ),
    *("x" * 300, "0", "1", "runs", *INTERPOLATIONS, *HYDRAS, *PLACES),
)
KEYS = (
    *(
        "path",
        "run",
        "episode",
        "group",
        "option",
        "choices",
        "values",
        "more",
        "folder",
        "allowed",
        "text",
        "order",
        "page",
        "size",
    ),
    *(
        "content",
        "map",
        "robot",
        "version",
        "name",
        "problem",
        "furniture",
        "kind",
        "seed",
        "baseline",
        "scene",
        "parameters",
    ),
    *("rectangles", "planner", "pedestrians", "world", "rules", "files", "target", "seed", *HYDRAS[:5]),
)
MAP = "image: map.pgm\nresolution: 0.1\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"
SCENE = {"name": "a", "start": [0.1, 0.1, 0], "goal": [0.3, 0.3, 0], "pedestrians": [], "obstacles": []}
NOTE: dict[str, Any] = {
    "words": ["run"],
    "folder": "runs",
    "jobs": 1,
    "episodes": 1,
    "began": "2026",
    "pid": 1,
    "created": "0.0",
    "status": None,
}
NOTE |= {"interrupted": False}
# for an address
ENCODED = [quote(piece, safe="/~") if piece in (*INTERPOLATIONS, *HYDRAS) else piece for piece in PIECES]
NOTES: tuple[dict[str, Any], ...] = (
    *(
        {},
        {"pid": -1},
        {"pid": 2**70},
        {"created": "soon"},
        {"folder": "link"},
        {"words": ["run", "hydra.run.dir=link/x"]},
    ),
    *({"words": ["run", INTERPOLATIONS[0]]}, {"folder": INTERPOLATIONS[0]}, {"episodes": -1}),
)
# What is asked for as it should be, then spoilt. Paths that start processes are left out: test_confined.py has
# /api/run/start.
STARTS = ("/api/run/start", "/api/run/compose")  # Hydra takes its time: every hundredth request may compose


def spoilt(draw: random.Random, depth: int = 0) -> Any:
    """Return any JSON: numbers, texts, lists, mappings with keys that routes know."""
    kind = draw.randrange(9 if depth < 3 else 6)
    if kind < 3:
        return draw.choice(PIECES)
    if kind < 6:
        return draw.choice([None, True, 0, -1, 1.5, 10**18, 2**70, draw.random(), ""])
    if kind == 6:
        return [spoilt(draw, depth + 1) for _ in range(draw.randrange(4))]
    return {draw.choice((*KEYS, *PIECES)): spoilt(draw, depth + 1) for _ in range(draw.randrange(5))}


def paths(app: Any) -> list[str]:
    """Return the paths of all routes, of those that are included too."""
    return sorted({path for path in _paths(app.routes) if path not in STARTS})


def _paths(routes: Any) -> Any:
    for route in routes:
        inner = getattr(route, "original_router", None)
        if inner is not None:
            yield from _paths(inner.routes)
        elif (path := getattr(route, "path", None)) is not None:
            yield path


def address(draw: random.Random, known: list[str]) -> str:
    path = draw.choice(known)
    while "{" in path:
        path = path[: path.index("{")] + draw.choice(ENCODED) + path[path.index("}") + 1 :]
    if draw.random() < 0.25:
        path += "/" + "/".join(draw.choices(ENCODED, k=draw.randrange(1, 4)))
    return path


def body(draw: random.Random) -> bytes:
    kind = draw.randrange(10)
    if kind == 0:
        return draw.randbytes(draw.randrange(200))
    text = json.dumps({draw.choice(KEYS): spoilt(draw) for _ in range(draw.randrange(6))})
    return text.encode()[: draw.randrange(len(text) + 1)] if kind == 1 else text.encode()


@pytest.fixture
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return a project folder beside which something lies that no one may see, with links to it,
    a pipe and planted notes.
    """
    monkeypatch.setenv("ARENA_FUZZ", IN_ENVIRONMENT)
    outside, folder = tmp_path / "outside", tmp_path / "project"
    outside.mkdir()
    (outside / "secret.yaml").write_text(SECRET)
    folder.mkdir()
    (folder / "inside.yaml").write_text("a: 1\n")
    (folder / "link").symlink_to(outside)
    (folder / "linked.yaml").symlink_to(outside / "secret.yaml")
    (outside / "map.pgm").write_bytes(b"P5\n4 4\n255\n" + bytes(16))
    (outside / "map.yaml").write_text(MAP)
    (folder / "mapped.yaml").write_text(MAP.replace("map.pgm", "../outside/map.pgm"))
    (folder / "scene.json").write_text(
        json.dumps({"format": "arena-scenario", "version": 1, "map": "mapped.yaml", "scenarios": [SCENE]})
    )
    os.mkfifo(folder / "pipe.yaml")
    notes = folder / ".arena_studio" / "runs"
    notes.mkdir(parents=True)
    for number, change in enumerate(NOTES):
        (notes / f"0000000{number}.json").write_text(json.dumps({**NOTE, "name": f"0000000{number}", **change}))
        (notes / f"0000000{number}.log").symlink_to(outside / "secret.yaml")
    return folder


def outside(place: Path) -> dict[str, bytes]:
    """Return all that lies beside the project folder."""
    return {
        str(path): path.read_bytes()
        for path in place.parent.rglob("*")
        if path.is_file() and not path.is_relative_to(place)
    }


@pytest.mark.slow
def test_no_request_fails_inside_or_leaves_the_folder(place: Path) -> None:
    draw, before = random.Random(25), outside(place)
    app = make_app(Project(place), TOKEN)
    known = paths(app)
    assert {"/api/run/experiments/{name}/stop", "/api/results/page", "/api/maps", "/replay/document"} <= set(known)
    client = TestClient(app, base_url=BASE, raise_server_exceptions=False)
    client.get("/", params={"token": TOKEN})
    failed: list[str] = []
    for number in range(COUNT):
        method, path = draw.choice(METHODS), address(draw, [*known, "/api/run/compose"] if number % 100 == 0 else known)
        words = {draw.choice(KEYS): draw.choice(PIECES) for _ in range(draw.randrange(4))}
        headers = {"If-Match": draw.choice(PIECES).encode("ascii", "ignore").decode()} if draw.random() < 0.3 else {}
        answer = client.request(method, f"{BASE}{path}", params=words, content=body(draw), headers=headers)
        if answer.status_code >= 500 or SECRET.encode() in answer.content or IN_ENVIRONMENT.encode() in answer.content:
            failed.append(f"{answer.status_code} {method} {path} {words}")
    assert failed == []
    assert outside(place) == before


def test_websocket_does_not_mind_what_it_is_sent(client: TestClient) -> None:
    draw = random.Random(7)
    for _ in range(5):
        with client.websocket_connect("/api/live", headers=OWN) as socket:
            assert socket.receive_json() == {"experiments": []}
            for _ in range(40):
                if draw.random() < 0.5:
                    socket.send_bytes(draw.randbytes(draw.randrange(500)))
                else:
                    socket.send_text(json.dumps(spoilt(draw)))
    with pytest.raises(WebSocketDisconnect), client.websocket_connect("/api/live?token=x", headers={"Origin": "null"}):
        pass
