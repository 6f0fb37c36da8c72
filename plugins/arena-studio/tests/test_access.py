"""Who may ask the studio: pages that were opened with the token, on this machine, and no other page."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from fastapi.testclient import TestClient
from starlette.websockets import WebSocketDisconnect

from arena_studio.access import BODY
from arena_studio.app import make_app
from arena_studio.project import Project

TOKEN = "a-token-of-tests"
PATHS = ("/", "/api/project", "/web/shell/main.js", "/viewer/camera.js", "/api/results/page", "/replay/", "/nothing")


@pytest.mark.parametrize("path", PATHS)
def test_nothing_is_answered_without_the_token(stranger: TestClient, path: str) -> None:
    for given in ({}, {"token": "another"}, {"token": ""}):
        answer = stranger.get(path, params=given)
        assert answer.status_code == 403
        assert answer.json()["error"].startswith("the token is missing or wrong")
        assert "set-cookie" not in answer.headers


def test_token_of_the_address_becomes_a_cookie_that_scripts_and_other_sites_cannot_use(stranger: TestClient) -> None:
    answer = stranger.get("/", params={"token": TOKEN})
    assert answer.status_code == 200
    assert answer.headers["set-cookie"] == f"arena_studio_8000={TOKEN}; HttpOnly; SameSite=Strict; Path=/"
    assert stranger.get("/api/project").status_code == 200


def test_token_in_the_address_counts_for_the_page_alone(stranger: TestClient) -> None:
    assert stranger.get("/api/project", params={"token": TOKEN}).status_code == 403


@pytest.mark.parametrize(
    "host", ["evil.example", "evil.example:8000", "127.0.0.1.evil.example", "", "[::2]:8000", "0.0.0.0:8000"]
)
def test_other_names_of_this_machine_are_not_answered(client: TestClient, host: str) -> None:
    answer = client.get("/api/project", headers={"Host": host})
    assert answer.status_code == 403


@pytest.mark.parametrize("host", ["localhost:8000", "[::1]:8000", "127.0.0.1:8000"])
def test_names_of_the_loopback_are(client: TestClient, host: str) -> None:
    cookie = {"Cookie": f"arena_studio_8000={TOKEN}"}
    assert client.get("/api/project", headers={"Host": host, **cookie}).status_code == 200


@pytest.mark.parametrize(
    "origin", ["http://evil.example", "null", "http://127.0.0.1:8001", "http://localhost", "file://"]
)
def test_other_pages_may_not_ask(client: TestClient, origin: str) -> None:
    assert client.post("/api/run/start", json={}, headers={"Origin": origin}).status_code == 403
    assert client.get("/api/project", headers={"Origin": origin}).status_code == 403


def test_own_page_may_ask(client: TestClient) -> None:
    assert client.get("/api/project", headers={"Origin": "http://127.0.0.1:8000"}).status_code == 200


def test_websocket_wants_token_and_origin(stranger: TestClient) -> None:
    own = {"Origin": "http://127.0.0.1:8000", "Host": "127.0.0.1:8000"}
    cookie = {"Cookie": f"arena_studio_8000={TOKEN}"}
    for headers in (
        {},
        own,
        cookie,
        {**own, "Origin": "http://evil.example", **cookie},
        {**own, "Host": "evil.example", **cookie},
    ):
        with pytest.raises(WebSocketDisconnect), stranger.websocket_connect("/api/live", headers=headers):
            pass
    with stranger.websocket_connect("/api/live", headers={**own, **cookie}) as socket:
        assert socket.receive_json() == {"experiments": []}


def test_large_bodies_are_refused_with_and_without_a_length(client: TestClient) -> None:
    def parts() -> Iterator[bytes]:
        yield from (b" " * 500_000 for _ in range(BODY // 500_000 + 1))

    assert client.post("/api/results/page", content=b" " * (BODY + 1)).status_code == 413
    assert client.post("/api/results/page", content=parts()).status_code in (400, 413)


def test_answers_say_what_a_page_may_do(client: TestClient) -> None:
    headers = client.get("/").headers
    policy = headers["content-security-policy"]
    assert policy.startswith("default-src 'none'; script-src 'self' 'sha256-")
    assert "unsafe" not in policy
    assert headers["x-content-type-options"] == "nosniff"
    assert headers["referrer-policy"] == "no-referrer"
    assert client.get("/api/nothing").headers["content-security-policy"] == policy


def test_studio_that_is_exposed_knows_any_host_and_still_wants_the_token(folder: Path) -> None:
    client = TestClient(make_app(Project(folder), TOKEN, None), base_url="http://robot.lab:8000")
    assert client.get("/api/project").status_code == 403
    assert client.get("/", params={"token": TOKEN}).status_code == 200
    assert client.get("/api/project").status_code == 200
    assert client.get("/api/project", headers={"Origin": "http://evil.example"}).status_code == 403
