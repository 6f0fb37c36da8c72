"""Tunings and trainings of a project: found, read while they run and after, and told of in one line where damaged."""

from __future__ import annotations

import json
import os
import shutil
from pathlib import Path
from typing import Any

import pytest
from fastapi.testclient import TestClient

from arena_core import InputFileError
from arena_studio.curves.event_file import join_scalars, read_scalars
from arena_studio.curves.folders import RUNNING
from arena_studio.curves.trainings import MOST_POINTS, make_panels, read_curve, thin

# a record of an event file whose message is no protobuf
NO_EVENTS = b"\x02" + bytes(11) + b"\xff\xff" + bytes(4)


def listed(client: TestClient) -> dict[str, tuple[str, str]]:
    folders = client.get("/api/curves").json()["folders"]
    return {one["path"]: (one["kind"], one["state"]) for one in folders}


def opened(client: TestClient, path: str) -> Any:
    return client.get("/api/curves/folder", params={"path": path}).json()


def grow_old(folder: Path) -> None:
    for path in folder.rglob("*"):
        status = path.stat()
        os.utime(path, (status.st_atime - 2.0 * RUNNING, status.st_mtime - 2.0 * RUNNING))


def test_tunings_and_trainings_are_found_with_how_they_stand(
    curve_folders: Any, client: TestClient, folder: Path
) -> None:
    assert listed(client) == {}
    curve_folders.write_tuning(folder / "tunings" / "teb")
    curve_folders.write_training(folder / "trainings" / "rosnav")
    curve_folders.write_training(folder / "trainings" / "old")
    grow_old(folder / "trainings" / "old")
    (folder / ".hidden").mkdir()
    curve_folders.write_training(folder / ".hidden" / "rosnav")
    assert listed(client) == {
        "tunings/teb": ("tuning", "running"),
        "trainings/rosnav": ("training", "running"),
        "trainings/old": ("training", "stopped"),
    }
    curve_folders.write_card(folder / "tunings" / "teb")
    (folder / "trainings" / "rosnav" / "last").mkdir()
    (folder / "trainings" / "rosnav" / "last" / "policy.json").write_text("{}")
    assert listed(client)["tunings/teb"] == ("tuning", "finished")
    assert listed(client)["trainings/rosnav"] == ("training", "finished")


def test_a_tuning_is_shown_as_its_folder_says_while_it_runs_and_after(
    curve_folders: Any, client: TestClient, folder: Path
) -> None:
    curve_folders.write_tuning(folder / "teb")
    found = opened(client, "teb")
    assert (found["kind"], found["state"]) == ("tuning", "running")
    assert (found["found"]["races"], found["found"]["verdict"]) == (3, None)
    assert found["found"]["episodes"]["tune"] == 20
    curve_folders.write_card(folder / "teb")
    found = opened(client, "teb")["found"]
    assert found["curve"] == [[2, 0.0], [8, 1.5]]
    assert found["best"]["values"] == {"samples": 4, "weight": 3.5}


def test_a_tuning_for_two_objectives_has_a_pareto_set(curve_folders: Any, client: TestClient, folder: Path) -> None:
    curve_folders.write_pareto(folder / "teb")
    found = opened(client, "teb")["found"]
    assert found["objectives"] == ["success", "-collisions"]
    whole = [one["advantages"] for one in found["sets"] if one["ended"] == "whole"]
    assert {len(one) for one in whole} == {2}
    assert all(one["advantage"] == one["advantages"][0] for one in found["sets"] if one["advantages"])
    assert [one["chosen"] for one in found["pareto"]] == [False, True, False]


def test_a_training_has_reward_success_and_entropy_by_steps(
    curve_folders: Any, client: TestClient, folder: Path
) -> None:
    curve_folders.write_training(folder / "rosnav")
    found = opened(client, "rosnav")["found"]
    panels = {panel["title"]: panel for panel in found["panels"]}
    success = {line["name"]: line["points"] for line in panels["Success"]["lines"]}
    assert success["validation: success"] == [[2000, 0.2], [4000, 0.4], [6000, pytest.approx(0.6)]]
    (reward,) = panels["Reward"]["lines"]
    assert reward["points"] == [[step, 0.5 * step / 1000.0] for step in range(1000, 6000, 1000)]
    (entropy,) = panels["Entropy"]["lines"]
    assert entropy["points"][0] == [1000, 1.5]
    assert panels["train/loss"]["more"]
    assert (found["planner"], found["robot"], found["seed"], found["last"]) == ("rosnav", "turtlebot3", 4.0, 6000)
    assert (found["choice"], found["test"]) == (None, None)


def test_a_training_that_has_ended_says_which_weights_and_how_they_did(
    curve_folders: Any, client: TestClient, folder: Path
) -> None:
    curve_folders.write_training(folder / "rosnav")
    (folder / "rosnav" / "policy.json").write_text(json.dumps({"training": {"choice": {"steps": 4000}}}))
    (folder / "rosnav" / "test.json").write_text(json.dumps({"score": {"success": 0.8}}))
    found = opened(client, "rosnav")["found"]
    assert (found["choice"], found["test"]) == (4000, {"success": 0.8})


def test_curves_of_epochs_are_drawn_a_panel_each(tmp_path: Path) -> None:
    path = tmp_path / "curve.json"
    path.write_text(
        json.dumps([{"epoch": 0, "loss": 2.0, "note": "a"}, {"epoch": 1, "loss": 1.5}, {"epoch": [], "loss": 1}])
    )
    axis, columns = read_curve(path)
    assert (axis, columns) == ("epoch", {"loss": [(0, 2.0), (1, 1.5)]})
    (panel,) = make_panels(columns)
    assert (panel["title"], panel["more"]) == ("loss", False)


@pytest.mark.parametrize(
    ("name", "content", "told"),
    [
        ("curve.json", b'[{"steps": 20', "rosnav/curve.json: is no JSON"),
        ("curve.json", b'{"steps": 20}', "rosnav/curve.json: holds no list of rows"),
        ("curve.json", b'[{"steps": 20}, 3]', "rosnav/curve.json: holds no list of rows"),
        ("config.json", b"[]", "rosnav/config.json: holds no mapping"),
        ("policy.json", b"[]", "rosnav/policy.json: holds no mapping"),
        (
            "tensorboard/ppo_0/events.out.tfevents.2.vm",
            NO_EVENTS,
            "cannot be read (no events of TensorBoard)",
        ),
    ],
)
def test_what_is_damaged_is_told_in_one_line(
    curve_folders: Any, client: TestClient, folder: Path, name: str, content: bytes, told: str
) -> None:
    curve_folders.write_training(folder / "rosnav")
    (folder / "rosnav" / name).write_bytes(content)
    answer = client.get("/api/curves/folder", params={"path": "rosnav"})
    assert answer.status_code == 400
    assert told in answer.json()["error"]
    assert "\n" not in answer.json()["error"]


def test_a_folder_of_another_kind_or_one_that_is_gone_is_told_in_one_line(
    curve_folders: Any, client: TestClient, folder: Path
) -> None:
    (folder / "maps").mkdir()
    curve_folders.write_tuning(folder / "teb")
    shutil.rmtree(folder / "teb")
    for path in ("maps", "teb"):
        answer = client.get("/api/curves/folder", params={"path": path})
        assert answer.status_code == 404
        assert answer.json()["error"].startswith(f"{path}: is no tuning")
    assert client.get("/api/curves/folder", params={"path": "../elsewhere"}).status_code == 400


def test_links_lead_nowhere_outside(curve_folders: Any, client: TestClient, folder: Path, tmp_path: Path) -> None:
    curve_folders.write_tuning(tmp_path / "elsewhere")
    (folder / "teb").mkdir()
    for path in (tmp_path / "elsewhere").iterdir():
        (folder / "teb" / path.name).symlink_to(path)
    answer = client.get("/api/curves/folder", params={"path": "teb"})
    assert answer.status_code == 400
    assert "lies outside the folder that is served" in answer.json()["error"]


def test_events_that_are_being_written_are_read_up_to_the_last_whole_one(curve_folders: Any, tmp_path: Path) -> None:
    path = tmp_path / "events"
    whole = curve_folders.events([(300, "train/loss", 0.5), (70_000, "train/loss", 0.25)])
    for cut in range(len(whole)):
        path.write_bytes(whole[:cut])
        assert len(read_scalars(path).get("train/loss", [])) <= 1
    path.write_bytes(whole)
    assert read_scalars(path) == {"train/loss": [(300, 0.5), (70_000, 0.25)]}
    path.write_bytes(curve_folders.record(b"\x0a\x05ab"))
    with pytest.raises(InputFileError, match="no events of TensorBoard"):
        read_scalars(path)


def test_a_training_that_went_on_counts_from_where_it_went_on() -> None:
    first, later = {"a": [(1, 1.0), (2, 2.0), (3, 3.0)], "b": [(1, 0.0)]}, {"a": [(2, 20.0), (4, 40.0)]}
    assert join_scalars([first, later]) == {"a": [(1, 1.0), (2, 20.0), (4, 40.0)], "b": [(1, 0.0)]}


def test_long_lines_are_thinned_and_keep_their_last_point() -> None:
    points = [(step, float(step)) for step in range(5001)] + [(6000, float("nan"))]
    thinned = thin(points)
    assert len(thinned) <= MOST_POINTS
    assert thinned[-1] == (5000, 5000.0)
    assert thin(points[:3]) == points[:3]


def test_a_ladder_is_shown_block_by_block_while_it_runs_and_with_curves_after(
    curve_folders: Any, client: TestClient, folder: Path
) -> None:
    curve_folders.write_ladder(folder / "ladders" / "dwa", "dwa")
    found = opened(client, "ladders/dwa")
    assert (found["kind"], found["state"]) == ("ladder", "running")
    assert found["found"]["document"]["ladders"] == []
    blocks = found["found"]["blocks"]["hall_slow"]
    assert [(one["density"], one["successes"], one["episodes"]) for one in blocks] == [(0, 8, 8), (4, 6, 8), (12, 1, 8)]
    curve_folders.end_ladder(folder / "ladders" / "dwa", curve_folders.ladder_facts("dwa", limit=True))
    found = opened(client, "ladders/dwa")
    assert found["state"] == "finished"
    (ladder,) = found["found"]["document"]["ladders"]
    assert set(ladder["cells"]["hall_slow"]) == {"success", "strict_success", "clairvoyant"}
    assert ladder["cells"]["hall_slow"]["success"]["rho90"]["text"] == "4.0 (2.0 – 6.0)"


def test_a_page_over_several_ladders_has_their_sentences(curve_folders: Any, client: TestClient, folder: Path) -> None:
    curve_folders.end_ladder(folder / "report", *map(curve_folders.ladder_facts, ("dwa", "teb")))
    found = opened(client, "report")["found"]
    assert len(found["document"]["ladders"]) == 2
    assert found["document"]["pairs"] == ["dwa bears 2.00 times (1.50 – 3.00) as many people as teb."]
    assert (found["blocks"], found["cells"]) == ({}, ["hall_slow"])


@pytest.mark.parametrize(
    ("name", "content", "told"),
    [
        ("ladder.json", '{"ladders": [', "ladder.json: is no JSON"),
        ("ladder.json", '{"ladders": []}', "ladder.json: lacks 'pairs'"),
        ("ladder.json", "[]", "ladder.json: holds no ladder"),
        ("ladder_request.json", "{}", "ladder_request.json: holds no ladder"),
        ("hall_slow/000_0/episodes.csv", "epi", "dwa: a block of it cannot be read"),
    ],
)
def test_what_is_damaged_of_a_ladder_is_told_in_one_line(
    curve_folders: Any, client: TestClient, folder: Path, name: str, content: str, told: str
) -> None:
    curve_folders.write_ladder(folder / "dwa", "dwa")
    (folder / "dwa" / name).write_text(content)
    answer = client.get("/api/curves/folder", params={"path": "dwa"})
    assert answer.status_code == 400
    assert told in answer.json()["error"]
    assert "\n" not in answer.json()["error"]
