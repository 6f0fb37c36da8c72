"""No word of a browser, and no link or file in the folder, leads out of the project or shows
what the environment holds.
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path
from typing import Any

import pytest
from fastapi.testclient import TestClient

from arena_core import ArenaError, InputFileError
from arena_studio.allowed_overrides import check_overrides
from arena_studio.app import make_app
from arena_studio.background.process import side_processes
from arena_studio.experiments.experiments import PLACE, Experiment, Experiments
from arena_studio.experiments.processes import log_tail, start_process
from arena_studio.project import Project

SECRET = "what-the-environment-holds"
TOKEN = "a-token-of-tests"
MAP = "image: {}\nresolution: 0.1\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"
PGM = b"P5\n4 4\n255\n" + bytes([254] * 16)
SCENE = {"name": "one", "start": [0.1, 0.1, 0], "goal": [0.3, 0.3, 0], "pedestrians": [], "obstacles": []}
OTHERS = [
    *(
        "hydra.run.dir=/tmp/x",
        "++hydra.run.dir=x",
        "+hydra.searchpath=[file:///tmp]",
        "hydra/launcher=basic",
        "~hydra/launcher",
        "++hydra={run: {}}",
    ),
    *(
        "+planner@hydra.run=dwa",
        "planner@_global_.hydra.run=dwa",
        "seed=${oc.env:HOME}",
        "seed='${oc.env:HOME}'",
        "+x=[1,{a: '${seed}'}]",
    ),
    *(
        "+x={'${seed}': 1}",
        "seed=choice(1,'${seed}')",
        "planner=../../outside/secret",
        "planner=/etc/x",
        "world.path=link/map.yaml",
    ),
    *("world.path=~/map.yaml", "world.path='/etc/passwd'", "+x=[../y]", "+x=glob(../*)"),
]


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return a project beside which a map and a secret lie, both linked to."""
    monkeypatch.setenv("SECRET_OF_TESTS", SECRET)
    outside, place = tmp_path / "outside", tmp_path / "project"
    outside.mkdir()
    place.mkdir()
    (outside / "map.pgm").write_bytes(PGM)
    (outside / "map.yaml").write_text(MAP.format("map.pgm"))
    (outside / "secret.yaml").write_text(f"# {SECRET}\nlevels: [{SECRET}]\n")
    (place / "link").symlink_to(outside)
    (place / "mine.pgm").write_bytes(PGM)
    (place / "mine.yaml").write_text(MAP.format("mine.pgm"))
    return place


@pytest.fixture
def client(folder: Path) -> Iterator[TestClient]:
    with TestClient(make_app(Project(folder), TOKEN), base_url="http://127.0.0.1:8000") as page:
        page.get("/", params={"token": TOKEN})
        yield page
    for process in side_processes(folder.resolve()):
        process.close()


@pytest.mark.parametrize("word", OTHERS)
def test_word_that_a_browser_may_not_send_is_refused_in_one_line(folder: Path, word: str) -> None:
    with pytest.raises(ArenaError) as refused:
        check_overrides([word], folder)
    assert "\n" not in str(refused.value)
    assert "allowed: " in str(refused.value)


def test_words_of_an_experiment_are_allowed(folder: Path) -> None:
    words = [
        "planner=dwa,teb",
        "world.path=mine.yaml",
        f"world.path='{folder}/mine.yaml'",
        "~recording",
        "task.pedestrians=choice(1,2)",
        "+x='a: $(b)'",
    ]
    assert check_overrides(words, folder) == words


INTERPOLATED = "${oc.env:SECRET_OF_TESTS}"
WANTED: list[dict[str, Any]] = [
    {"folder": INTERPOLATED},
    {"folder": "runs/${hydra:runtime.cwd}"},
    {"folder": "link/x"},
    {"folder": "../outside/x"},
    {"values": {"task.pedestrians": INTERPOLATED}},
    {"values": {"+note": f"[{INTERPOLATED}]"}},
    {"values": {"hydra.run.dir": "elsewhere"}},
    {"values": {"++hydra.output_subdir": "null"}},
    {"values": {"planner": "../../../outside/secret"}},
    {"values": {"world": "ros_map", "world.path": "link/map.yaml"}},
    {"choices": {"hydra/launcher": ["basic"]}},
    {"choices": {"planner": ["../../../outside/secret"]}},
    {"more": "+hydra.searchpath=[file:///tmp]"},
    {"more": f'seed="{INTERPOLATED}"'},
    {"more": "seed=$'{'oc.env:SECRET_OF_TESTS}"},
]


def test_no_field_of_the_page_run_takes_an_interpolation_a_key_of_hydra_or_a_place_outside(
    client: TestClient, folder: Path
) -> None:
    for wanted in WANTED:
        for route in ("/api/run/compose", "/api/run/start"):
            answer = client.post(route, json=wanted)
            assert (answer.status_code, SECRET in answer.text) == (400, False), (wanted, answer.text)
    assert client.get("/api/run/experiments").json() == []
    assert not (folder / "outputs").exists()


def test_no_name_of_the_editors_leads_hydra_out_of_the_folder(client: TestClient) -> None:
    content = {"format": "arena-scenario", "version": 1, "title": "t", "scenarios": [SCENE]}
    outside = "../../../outside/secret"
    asked: list[tuple[str, dict[str, Any]]] = [
        ("/api/scenarios/check", {"path": "a.json", "content": content, "robot": outside}),
        ("/api/scenarios/check", {"path": "a.json", "content": content, "map": "link/map.yaml"}),
        ("/api/scenarios/preview", {"path": "a.json", "content": content, "scene": 0, "planner": outside}),
        (
            "/api/scenarios/preview",
            {"path": "a.json", "content": content, "scene": 0, "pedestrians": outside, "legs": True},
        ),
        ("/api/curricula/draws", {"rules": {}, "world": outside}),
        ("/api/curricula/draws", {"rules": {"hydra.x": 1}, "robot": outside}),
    ]
    for route, body in asked:
        answer = client.post(route, json=body)
        assert answer.status_code in (200, 400), (route, answer.text)
        assert "leads out of the project folder" in answer.text or "hydra" in answer.text.lower(), (
            route,
            body,
            answer.text,
        )


def test_image_of_a_map_that_lies_outside_is_neither_shown_nor_packed(client: TestClient, folder: Path) -> None:
    (folder / "linked.pgm").symlink_to(folder.parent / "outside" / "map.pgm")
    scene = {"format": "arena-scenario", "version": 1, "title": "t", "map": "map.yaml", "scenarios": [SCENE]}
    (folder / "scene.json").write_text(json.dumps(scene))
    for image in ("link/map.pgm", "../outside/map.pgm", f"{folder.parent}/outside/map.pgm", "linked.pgm"):
        (folder / "map.yaml").write_text(MAP.format(image))
        for route in ("/api/maps/file", "/api/maps/measures", "/api/scenarios/map"):
            assert client.get(route, params={"path": "map.yaml"}).status_code == 400
        checked = client.post("/api/scenarios/check", json={"path": "scene.json", "content": scene, "map": "map.yaml"})
        packed = client.post("/api/curricula/packs", json={"folder": "pack", "files": ["scene.json"]})
        assert (checked.status_code, packed.status_code) == (400, 400)
    assert list(folder.rglob("pack/**/*.pgm")) == []


def test_pack_is_not_written_through_a_link(client: TestClient, folder: Path) -> None:
    scene = {"format": "arena-scenario", "version": 1, "title": "t", "map": "mine.yaml", "scenarios": [SCENE]}
    (folder / "scene.json").write_text(json.dumps(scene))
    (folder / "pack").mkdir()
    (folder / "pack" / "maps").symlink_to(folder.parent / "outside")
    before = sorted(os.listdir(folder.parent / "outside"))
    assert client.post("/api/curricula/packs", json={"folder": "pack", "files": ["scene.json"]}).status_code == 400
    assert sorted(os.listdir(folder.parent / "outside")) == before


def test_linked_files_are_not_shown(client: TestClient, folder: Path) -> None:
    (folder / "secret").symlink_to(folder.parent / "outside" / "secret.yaml")
    (folder / "linked.yaml").symlink_to(folder.parent / "outside" / "secret.yaml")
    (folder / "conf" / "planner").mkdir(parents=True)
    (folder / "conf" / "planner" / "stolen.yaml").symlink_to(folder.parent / "outside" / "secret.yaml")
    asked = [
        ("/api/curricula/file", {"path": "secret"}),
        ("/api/curricula/file", {"path": "linked.yaml"}),
        ("/api/curricula", {}),
    ]
    for route, words in [*asked, ("/api/run/groups", {}), ("/api/run/form", {"group": "planner", "option": "stolen"})]:
        answer = client.get(route, params=words)
        assert answer.status_code in (200, 400)
        assert SECRET not in answer.text, route


def test_linked_table_is_not_counted_as_progress(folder: Path, client: TestClient) -> None:
    (folder.parent / "outside" / "episodes.csv").write_text(f"planner,outcome\n{SECRET},x\n")
    (folder / "runs").mkdir()
    (folder / "runs" / "episodes.csv").symlink_to(folder.parent / "outside" / "episodes.csv")
    write_note(folder, Experiment("0123abcd", ["run"], "runs", 1, 3, "2026", 1, "0.0", None, False))
    with TestClient(make_app(Project(folder), TOKEN), base_url="http://127.0.0.1:8000") as page:
        page.get("/", params={"token": TOKEN})
        shown = page.get("/api/run/experiments")
    assert [one["done"] for one in shown.json()] == [0]
    assert SECRET not in shown.text


def write_note(root: Path, one: Experiment, **change: Any) -> None:
    place = root / PLACE
    place.mkdir(parents=True, exist_ok=True)
    (place / f"{one.name}.json").write_text(json.dumps({**asdict(one), **change}))


GOOD = Experiment("0123abcd", ["run", "seed=1"], "runs/x", 1, 3, "2026", 1, "0.0", None, False)
PLANTED: list[dict[str, Any]] = [
    *(
        {"pid": -1},
        {"pid": 0},
        {"pid": 2**40},
        {"pid": "1"},
        {"created": "soon"},
        {"created": "nan"},
        {"created": "1e400"},
    ),
    *(
        {"episodes": 0},
        {"episodes": 10**12},
        {"folder": "${oc.env:HOME}"},
        {"folder": "link/x"},
        {"words": ["run", "hydra.run.dir=/tmp/x"]},
    ),
    *(
        {"words": ["run", "seed=${oc.env:HOME}"]},
        {"words": ["run", "--cfg=job"]},
        {"words": ["run", "+hydra.searchpath=[x]"]},
    ),
]


@pytest.mark.parametrize("change", PLANTED, ids=str)
def test_planted_note_of_an_experiment_is_no_experiment(folder: Path, change: dict[str, Any]) -> None:
    write_note(folder, GOOD)
    assert len(Experiments(Project(folder)).all()) == 1
    write_note(folder, GOOD, **change)
    assert Experiments(Project(folder)).all() == []


def test_log_that_is_a_link_is_neither_shown_nor_written(folder: Path) -> None:
    target = folder.parent / "outside" / "secret.yaml"
    log = folder / "x.log"
    log.symlink_to(target)
    assert log_tail(log) == []
    with pytest.raises(InputFileError, match="a file that the studio wrote"):
        start_process(["list"], folder, log)
    assert target.read_text() == f"# {SECRET}\nlevels: [{SECRET}]\n"


def test_log_that_is_a_pipe_is_not_waited_for(folder: Path) -> None:
    os.mkfifo(folder / "x.log")
    assert log_tail(folder / "x.log") == []
    with pytest.raises(InputFileError):
        start_process(["list"], folder, folder / "x.log")


def test_folder_of_notes_that_leads_out_is_refused(folder: Path) -> None:
    (folder / ".arena_studio").symlink_to(folder.parent / "outside")
    with pytest.raises(InputFileError, match="leads out of the project folder"):
        Experiments(Project(folder))
