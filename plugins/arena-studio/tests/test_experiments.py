"""Experiments run as processes of their own: progress is seen, they stop, go on, and are found again."""

from __future__ import annotations

import json
import signal
from collections.abc import Callable, Iterator
from dataclasses import asdict
from pathlib import Path
from time import monotonic, sleep
from typing import Any

import pytest
from fastapi.testclient import TestClient

from arena_core.files import read_table
from arena_studio.errors import Conflict, Missing
from arena_studio.experiments.composing import compose_experiment
from arena_studio.experiments.experiments import PLACE, Experiment, Experiments
from arena_studio.project import Project

PATIENCE = 300.0  # s: kernels may have to be compiled
QUICK = {
    "planner": ["pure_pursuit"],
    "world": ["empty"],
    "pedestrians": ["none"],
    "executor": ["serial"],
    "robot": ["jackal"],
}
VALUES = {"episodes": "2", "report": "false", "task.time_limit": "8"}


@pytest.fixture(autouse=True)
def interruptible() -> Iterator[None]:
    """Hear Ctrl-C, as the studio's server does: what a shell starts in its background ignores
    it, and so do its children.
    """
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.fixture
def experiments(folder: Path) -> Experiments:
    return Experiments(Project(folder))


def until(look: Callable[[], dict[str, Any]], done: Callable[[dict[str, Any]], bool]) -> dict[str, Any]:
    """Look again and again until something holds."""
    ends = monotonic() + PATIENCE
    while not done(found := look()):
        assert monotonic() < ends, found
        sleep(0.2)
    return found


def ended(found: dict[str, Any]) -> bool:
    return found["state"] not in ("running", "stopping")


@pytest.mark.slow
def test_experiment_runs_to_its_end_and_is_found_again(experiments: Experiments, folder: Path) -> None:
    begun = experiments.start(compose_experiment(QUICK, VALUES, ""), "outputs/first")
    assert begun["state"] == "running"
    assert begun["command"].startswith("arena run planner=pure_pursuit world=empty")
    found = until(lambda: experiments.experiment_state(begun["name"]), ended)
    assert (found["state"], found["status"], found["done"]) == ("finished", 0, 2), found["said"]
    assert [row["episode"] for row in found["last"]] == ["0", "1"]
    assert found["folders"] == ["outputs/first"]
    again = Experiments(Project(folder)).all()
    assert [(one["name"], one["state"], one["done"]) for one in again] == [(begun["name"], "finished", 2)]


@pytest.mark.slow
def test_stopped_experiment_goes_on_where_it_was(experiments: Experiments, folder: Path) -> None:
    begun = experiments.start(compose_experiment(QUICK, {**VALUES, "episodes": "4000"}, ""), "outputs/long")
    until(lambda: experiments.experiment_state(begun["name"]), lambda found: found["done"] > 0)
    with pytest.raises(Conflict, match="runs already"):
        experiments.resume(begun["name"])
    with pytest.raises(Conflict, match="runs"):
        experiments.forget(begun["name"])
    assert experiments.stop(begun["name"])["state"] in ("stopping", "cut off")
    stopped = until(lambda: experiments.experiment_state(begun["name"]), ended)
    assert stopped["state"] == "cut off"
    assert 0 < stopped["done"] < 4000
    kept = {row["episode"]: row for row in read_table(folder / "outputs/long/episodes.csv", "a table")[1]}
    experiments.resume(begun["name"])
    until(lambda: experiments.experiment_state(begun["name"]), lambda found: found["done"] > stopped["done"])
    experiments.stop(begun["name"])
    until(lambda: experiments.experiment_state(begun["name"]), ended)
    now = {row["episode"]: row for row in read_table(folder / "outputs/long/episodes.csv", "a table")[1]}
    assert {episode: now[episode] for episode in kept} == kept
    experiments.forget(begun["name"])
    assert experiments.all() == []
    assert (folder / "outputs/long/episodes.csv").exists()


@pytest.mark.slow
def test_experiment_that_cannot_be_built_says_why(experiments: Experiments) -> None:
    begun = experiments.start(
        compose_experiment({**QUICK, "world": ["warehouse"]}, {**VALUES, "world.known": "false"}, "localizer=amcl"), ""
    )
    found = until(lambda: experiments.experiment_state(begun["name"]), ended)
    assert (found["state"], found["status"]) == ("refused", 2)
    assert "world.known is false and localizer amcl needs a map" in found["said"][-1]


def test_folder_that_is_taken_or_elsewhere_is_refused(
    client: TestClient, folder: Path, write_run: Callable[..., Path]
) -> None:
    write_run("taken", {})
    for name, status in (("taken", 409), ("../x", 400), ("/tmp/x", 400), (".hidden", 400), ("a\nb", 400)):
        answer = client.post("/api/run/start", json={"choices": {"planner": ["pure_pursuit"]}, "folder": name})
        assert answer.status_code == status, answer.text
    assert not (folder / PLACE).exists()
    assert sorted(path.name for path in folder.parent.iterdir()) == ["project"]


def test_foreign_notes_of_experiments_are_left_alone(folder: Path) -> None:
    place = folder / PLACE
    place.mkdir(parents=True)
    good = asdict(Experiment("0123abcd", ["run"], "outputs/x", 1, 3, "2026", 1, "0.0", None, False))
    changes: dict[str, dict[str, Any]] = {
        "1": {"folder": "../../etc"},
        "2": {"words": ["train"]},
        "3": {"jobs": 10**9},
        "4": {"name": "../x"},
    }
    notes = {f"0000000{name}": {**good, "name": f"0000000{name}", **change} for name, change in changes.items()}
    notes |= {"0123abcd": good, "00000005": {"name": "00000005"}}
    for name, note in notes.items():
        (place / f"{name}.json").write_text(json.dumps(note))
    (place / "bad.json").write_text("{")
    found = Experiments(Project(folder))
    assert [(one["name"], one["state"]) for one in found.all()] == [("0123abcd", "cut off")]
    with pytest.raises(Missing):
        found.stop("00000001")
    with pytest.raises(Conflict):
        found.stop("0123abcd")


def test_forms_are_made_from_what_is_installed(client: TestClient) -> None:
    groups = {group["name"]: group for group in client.get("/api/run/groups").json()}
    assert next(iter(groups)) == "planner"
    assert groups["planner"]["chosen"] == "dwa"
    assert {"name": "pure_pursuit"}.items() <= next(
        o for o in groups["planner"]["options"] if o["name"] == "pure_pursuit"
    ).items()
    assert "arena/crossing_low" in [option["name"] for option in groups["scenario"]["options"]]
    form = client.get("/api/run/form", params={"group": "planner", "option": "pure_pursuit"}).json()
    assert all(field["key"].startswith("planner.") for field in form["fields"])
    settings = {field["key"]: field for field in client.get("/api/run/settings").json()["fields"]}
    assert settings["episodes"]["allowed"].startswith(">= 1")
    assert settings["timing.mode"]["choices"] == ["ideal", "latency", "measured"]
    assert client.get("/api/run/form", params={"group": "planner", "option": "dvva"}).status_code == 400
    assert client.get("/api/run/form", params={"group": "../x", "option": "dwa"}).status_code == 400


def test_composing_tells_command_and_values_or_what_is_wrong(client: TestClient) -> None:
    answer = client.post(
        "/api/run/compose", json={"choices": {"planner": ["pure_pursuit"]}, "values": {"episodes": "4"}}
    )
    assert answer.json()["command"] == "arena run planner=pure_pursuit episodes=4 recording.live=true"
    assert answer.json()["values"]["robot.name"] == "turtlebot3"
    wrong = client.post("/api/run/compose", json={"values": {"episodse": "4"}})
    assert wrong.status_code == 400
    assert "did you mean episodes?" in wrong.json()["error"]
