"""``arena studio``: what it accepts, and a server as a user has it: its address, its end, a port that is taken."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from urllib.error import HTTPError
from urllib.request import HTTPCookieProcessor, OpenerDirector, ProxyHandler, Request, build_opener

import pytest

from arena_core import ArenaError
from arena_studio.command import StudioCommand, read_request

ARENA = (sys.executable, "-m", "arena_core.cli.main", "studio")


@contextmanager
def studio(folder: Path, *words: str) -> Iterator[tuple[subprocess.Popen[str], str]]:
    """Start a studio; yield its process and its address, and end it as Ctrl-C does."""
    process = subprocess.Popen([*ARENA, str(folder), "open=false", *words], stderr=subprocess.PIPE, text=True)
    assert process.stderr is not None
    try:
        line = process.stderr.readline()
        found = re.search(r"http\S+", line)
        assert found, line + process.stderr.read()
        yield process, found[0]
    finally:
        process.send_signal(signal.SIGINT)
        process.wait(60)
        process.stderr.close()


def opener() -> OpenerDirector:
    return build_opener(ProxyHandler({}), HTTPCookieProcessor())


@pytest.mark.slow
def test_server_answers_ends_and_keeps_its_port_to_itself(folder: Path) -> None:
    with studio(folder) as (process, address):
        browser, base = opener(), address.partition("/?")[0]
        assert base.startswith("http://127.0.0.1:")
        with pytest.raises(HTTPError, match="403"):
            browser.open(base)
        assert b"arena studio" in browser.open(address).read()
        assert json.load(browser.open(f"{base}/api/project"))["folder"] == str(folder)
        port = base.rpartition(":")[2]
        second = subprocess.run(
            [*ARENA, str(folder), "open=false", f"port={port}"], capture_output=True, text=True, check=False
        )
        assert second.returncode == 2
        assert (
            second.stderr == f"arena: 127.0.0.1:{port}: Address already in use; allowed: a free port of this machine, "
            "or port=0 for any\n"
        )
        process.send_signal(signal.SIGINT)
        assert process.wait(60) == 0
        assert process.stderr is not None
        assert process.stderr.read() == ""


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["a", "b"], "arguments are a b"),
        (["prot=1"], "did you mean port"),
        (["port=x"], "port is 'x'"),
        (["host=0.0.0.0"], "expose=true: whoever knows the token can then start programs"),
        (["host=::"], "expose=true"),
        (["host=192.168.1.4", "expose=false"], "expose=true"),
        (["host=robot"], "allowed: an address in digits, or localhost"),
    ],
)
def test_wrong_words_are_refused(words: list[str], said: str) -> None:
    with pytest.raises(ArenaError, match=re.escape(said)):
        read_request(words)


def test_words_are_read() -> None:
    request = read_request(["data", "port=8080", "open=false", "host=0.0.0.0", "expose=true"])
    assert (request.folder, request.port, request.opens, request.exposed) == (Path("data"), 8080, False, True)
    assert not read_request(["host=127.0.0.2", "expose=true"]).exposed


def test_folder_and_port_that_cannot_be_are_refused(folder: Path) -> None:
    before = os.getcwd()
    for words in ([str(folder / "nothing")], [str(folder), "port=99999999"]):
        with pytest.raises(ArenaError):
            StudioCommand().run([*words, "open=false"])
    assert os.getcwd() == before


NOTE = {
    "words": ["run", "seed=1"],
    "folder": "runs/x",
    "jobs": 1,
    "episodes": 3,
    "began": "2026",
    "pid": 1,
    "created": "0.0",
}
STOLEN = "what-the-environment-holds"
FORBIDDEN: list[dict[str, object]] = [
    {"folder": "${oc.env:STOLEN}"},
    {"more": "seed=${oc.env:STOLEN}"},
    {"values": {"++hydra.run.dir": "elsewhere"}},
    {"choices": {"hydra/launcher": ["basic"]}},
]


@pytest.mark.slow
def test_server_as_a_user_has_it_stays_in_its_folder(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("STOLEN", STOLEN)
    outside, notes = folder.parent / "outside.txt", folder / ".arena_studio" / "runs"
    outside.write_text(STOLEN)
    notes.mkdir(parents=True)
    for name, change in (("01234567", {}), ("89abcdef", {"pid": -1})):
        note = {**NOTE, "name": name, "status": None, "interrupted": False, **change}
        (notes / f"{name}.json").write_text(json.dumps(note))
        (notes / f"{name}.log").symlink_to(outside)
    with studio(folder) as (_, address):
        browser, base = opener(), address.partition("/?")[0]
        browser.open(address)
        (known,) = json.load(browser.open(f"{base}/api/run/experiments"))
        assert (known["name"], known["said"]) == ("01234567", [])
        asked = [("start", json.dumps(one).encode()) for one in FORBIDDEN] + [("experiments/01234567/resume", b"")]
        for place, content in asked:
            request = Request(f"{base}/api/run/{place}", content, {"Content-Type": "application/json"})
            with pytest.raises(HTTPError, match="400") as refused:
                browser.open(request)
            assert STOLEN not in refused.value.read().decode()
    assert [path.name for path in folder.iterdir()] == [".arena_studio"]
    assert outside.read_text() == STOLEN
