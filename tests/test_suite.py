"""The list of who brings what is current, and messages go by it."""

import runpy
from pathlib import Path

import pytest

TOP = Path(__file__).resolve().parents[1]


def test_the_list_is_what_the_packages_bring():
    contents = runpy.run_path(str(TOP / "scripts" / "name_components"))["contents"]
    assert (TOP / "arena_core" / "suite.json").read_text() == contents(), "run scripts/name_components"


@pytest.mark.parametrize(
    ("words", "line"),
    [
        (("run", "planner=dwa"), "arena: planner dwa comes with arena-dwa, which is not installed"),
        (
            ("run", "planner=dwa_as_released"),
            "arena: planner dwa_as_released comes with arena-dwa, which is not installed",
        ),
        (("run", "-m", "planner=pure_pursuit,dwa"), "arena: planner dwa comes with arena-dwa, which is not installed"),
        (("check", "planner=dwa"), "arena: planner dwa comes with arena-dwa, which is not installed"),
        (("train", "planner=gring"), "arena: command train comes with arena-gym, which is not installed"),
    ],
)
def test_what_is_not_installed_is_named_with_its_distribution(words, line, arena, monkeypatch):
    monkeypatch.setenv("ARENA_DISABLED_PLUGINS", "dwa,gym,scenarios")
    monkeypatch.setattr("arena_core.base.suite._install_state", lambda distribution: "not installed")
    answer = arena(*words)
    assert (answer.status, answer.line) == (2, line)


def test_what_is_switched_off_is_named_so(arena, monkeypatch):
    monkeypatch.setenv("ARENA_DISABLED_PLUGINS", "dwa")
    assert (
        arena("run", "planner=dwa").line
        == "arena: planner dwa comes with arena-dwa, which is switched off by ARENA_DISABLED_PLUGINS"
    )
