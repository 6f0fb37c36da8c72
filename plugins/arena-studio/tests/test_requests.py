"""What the server may ask the processes beside it."""

from __future__ import annotations

import json
from importlib import import_module
from pathlib import Path
from typing import get_type_hints

import pytest

from arena_studio.background import requests
from arena_studio.background.worker import REQUESTS, answer_request


def ask(request: requests.WorkRequest) -> object:
    sent = {"request": type(request).__name__, "given": request.model_dump()}
    return answer_request(json.dumps(sent).encode())


@pytest.mark.parametrize("kind", REQUESTS.values(), ids=list(REQUESTS))
def test_the_work_of_a_request_takes_that_request(kind: type[requests.WorkRequest]) -> None:
    module, _, name = kind.work.partition(":")
    (taken,) = [
        hint
        for key, hint in get_type_hints(getattr(import_module(f"arena_studio.{module}"), name)).items()
        if key != "return"
    ]
    assert taken is kind


def test_messages_call_each_request_by_a_name_of_its_own() -> None:
    assert len({kind.what for kind in REQUESTS.values()}) == len(REQUESTS) == 23


def test_a_file_whose_name_is_no_text_can_be_asked_for(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert ask(requests.ListScenarios(names=["\udcff.json"])) == {"answer": []}


def test_an_error_is_one_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (error,) = ask(requests.OpenScenario(path="none.json")).values()  # type: ignore[attr-defined]
    assert "none.json" in error
    assert "\n" not in error
