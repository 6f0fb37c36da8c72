"""Runs under way, as their folders tell them."""

import http.client
import json
import os
import threading
import time
from urllib.parse import urlsplit

import pytest

import arena_core as arena
from arena_core import ConfigurationError, InputFileError
from arena_viewer.command import ReplayCommand
from arena_viewer.document import read_document
from arena_viewer.live import STALE, LiveRuns
from arena_viewer.page import live_page
from arena_viewer.serving import PageServer

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
def folder(tmp_path_factory):
    where = tmp_path_factory.mktemp("live") / "sweep" / "0"
    arena.run([*WORDS, "executor=serial", "localizer=ground_truth", "report=false", "recording.live=true"], where)
    return where


def test_no_file_but_maps_of_the_run_is_read(folder):
    watched = LiveRuns(folder)
    watched.state({})
    for name in ("", "../0/worlds/00.npz", "worlds/../records/0000.npz", "records/0000.npz", "/etc/passwd"):
        with pytest.raises(InputFileError, match=r"allowed: worlds/HASH\.npz"):
            watched.map({"run": "0", "grid": name})


def state_of(watched):
    return json.loads(watched.state({})[1])


@pytest.fixture
def telling(folder):
    """Let an episode tell where it is."""
    (folder / "live").mkdir(exist_ok=True)
    path = folder / "live" / "0007.json"
    path.write_text(json.dumps({"episode": 7, "worker": 12, "pose": [0, 0, 0], "people": []}))
    yield path
    path.unlink()
    path.parent.rmdir()


def test_nothing_is_there_before_the_run_begins(tmp_path):
    assert state_of(LiveRuns(tmp_path / "later")) == {
        "runs": [],
        "total": 0,
        "done": 0,
        "succeeded": 0,
        "left": None,
        "workers": 0,
    }


def test_a_run_that_ended_leaves_no_live_files(folder):
    assert not (folder / "live").exists()


def test_finished_episodes_are_told(folder):
    state = state_of(LiveRuns(folder.parent))
    assert (state["total"], state["done"], state["left"]) == (2, 2, 0.0)
    (run,) = state["runs"]
    assert run["name"] == "0"
    assert [row["episode"] for row in run["rows"]] == ["0", "1"]


def test_time_left_follows_from_when_records_were_written_but_for_the_first(tmp_path):
    run = tmp_path / "run"
    (run / "records").mkdir(parents=True)
    facts = {"episodes": 20, "config": {"executor": {"name": "processes", "workers": 1}}}
    (run / "provenance.json").write_text(json.dumps(facts))
    (run / "episodes.csv").write_text("\n".join(["episode,success", *(f"{episode},1" for episode in range(8))]) + "\n")
    now = time.time()
    os.utime(run / "provenance.json", (now - 120.0, now - 120.0))
    for episode in range(8):  # the first took 92 s, with compiling, the others 4 s each
        path = run / "records" / f"{episode:04d}.npz"
        path.touch()
        os.utime(path, (now - 28.0 + 4.0 * episode,) * 2)
    state = state_of(LiveRuns(run))
    assert 44.0 <= state["left"] <= 48.0
    assert set(state["runs"][0]) == {"number", "name", "total", "done", "succeeded", "rows", "running"}
    for episode in range(4, 8):
        (run / "records" / f"{episode:04d}.npz").unlink()
    assert state_of(LiveRuns(run))["left"] is None


def test_running_episodes_are_told_while_they_tell(folder, telling):
    (run,) = state_of(LiveRuns(folder))["runs"]
    assert [said["episode"] for said in run["running"]] == [7]
    assert state_of(LiveRuns(folder))["workers"] == 1
    os.utime(telling, (0, telling.stat().st_mtime - 2 * STALE))
    assert state_of(LiveRuns(folder))["runs"][0]["running"] == []


def test_half_of_a_live_file_is_no_error(folder, telling):
    telling.write_text('{"episode": 7')
    assert state_of(LiveRuns(folder))["runs"][0]["running"] == []


def test_records_are_the_same_with_and_without(folder, tmp_path):
    arena.run([*WORDS, "executor=serial", "localizer=ground_truth", "report=false"], tmp_path)
    for name in ("0000.npz", "0001.npz"):
        assert (tmp_path / "records" / name).read_bytes() == (folder / "records" / name).read_bytes()


@pytest.fixture
def server(folder):
    watched = LiveRuns(folder)
    more = {"/document": watched.document, "/state": watched.state, "/map": watched.map}
    server = PageServer(live_page("live"), b"", more=more)
    thread = threading.Thread(target=server.serve)
    thread.start()
    yield server
    server.shutdown()
    thread.join()


def asked(server, path, **words):
    parts = urlsplit(server.address)
    connection = http.client.HTTPConnection(parts.hostname, parts.port, timeout=120)
    connection.request("GET", f"{path}?{parts.query}" + "".join(f"&{key}={value}" for key, value in words.items()))
    answer = connection.getresponse()
    content = answer.read()
    connection.close()
    return answer.status, content


def test_server_gives_states_maps_and_documents(server, folder):
    assert asked(server, "/")[0] == 200
    assert json.loads(asked(server, "/state")[1])["done"] == 2
    header, _ = read_document(asked(server, "/document", run=0, episode=1)[1])
    assert header["episodes"][0]["columns"]["episode"] == 1
    (name,) = (folder / "worlds").iterdir()
    grid = json.loads(asked(server, "/map", run=0, grid=f"worlds/{name.name}")[1])
    assert len(grid["cells"]) == grid["width"] * grid["height"]
    assert set(grid["cells"]) == {"0", "1"}


@pytest.mark.parametrize(
    ("path", "words"),
    [
        ("/document", {"run": 0, "episode": 9}),
        ("/document", {"run": 3, "episode": 0}),
        ("/document", {"run": "x", "episode": "-1"}),
        ("/document", {}),
        ("/map", {"run": 0}),
        ("/map", {"run": 0, "grid": "../../../etc/passwd"}),
        ("/map", {"run": 0, "grid": "worlds/none.npz"}),
    ],
)
def test_what_is_not_there_is_one_line(server, path, words):
    asked(server, "/state")
    status, content = asked(server, path, **words)
    assert status == 404
    assert content.count(b"\n") == 0


def test_live_goes_to_no_file():
    with pytest.raises(ConfigurationError, match="live shows one folder in a browser"):
        ReplayCommand().run(["here", "live=true", "--to", "a.html"])
