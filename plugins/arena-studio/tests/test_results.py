"""Results: the episodes of all runs below a folder, filtered, sorted, paged, exported; damage and loss are told."""

from __future__ import annotations

import csv
import io
import shutil
from collections.abc import Callable
from pathlib import Path
from time import process_time
from typing import Any

import pytest
from fastapi.testclient import TestClient

from arena_core import ArenaError
from arena_core.base.cells import BREAKS
from arena_core.files import csv_text, read_table
from arena_studio.episode_table import EpisodeTable, Query
from arena_studio.routers import results

WriteRun = Callable[..., Path]


@pytest.fixture(autouse=True)
def _always_fresh(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(results, "FRESH", -1.0)


@pytest.fixture
def two_runs(write_run: WriteRun) -> None:
    write_run(
        "multirun/0",
        {"time_to_goal": 9.0},
        {"outcome": "timeout", "success": 0.0, "time_to_goal": ""},
        {"scenario": "hall/2"},
    )
    write_run(
        "multirun/1",
        {"preset": "teb", "planner": "teb", "time_to_goal": 30.0},
        {"preset": "teb", "robot": "robotino", "stage": 2},
    )


def ask(client: TestClient, **asked: Any) -> dict[str, Any]:
    answer = client.post("/api/results/page", json=asked)
    assert answer.status_code == 200, answer.text
    found: dict[str, Any] = answer.json()
    return found


@pytest.mark.usefixtures("two_runs")
def test_runs_below_the_folder_are_one_table(client: TestClient) -> None:
    found = ask(client)
    assert found["total"] == 5
    assert [(row["run"][-1], row["episode"]) for row in found["rows"]] == [
        ("0", 0),
        ("0", 1),
        ("0", 2),
        ("1", 0),
        ("1", 1),
    ]
    assert found["rows"][1]["time_to_goal"] is None
    assert found["rows"][4]["stage"] == 2
    assert "scenario_hash" not in found["columns"]
    assert found["summary"][0] == {"preset": "dwa", "robot": "jackal", "episodes": 3, "succeeded": 2}


@pytest.mark.usefixtures("two_runs")
@pytest.mark.parametrize(
    ("asked", "episodes"),
    [
        ({"allowed": {"preset": ["teb"]}}, ["1/0", "1/1"]),
        ({"allowed": {"preset": ["teb"], "robot": ["jackal", "turtlebot3"]}}, ["1/0"]),
        ({"allowed": {"outcome": ["timeout"]}}, ["0/1"]),
        ({"allowed": {"outcome": []}, "text": "hall"}, ["0/2"]),
        ({"text": "TEB robotino"}, ["1/1"]),
        ({"text": "nothing of the kind"}, []),
        ({"order": "time_to_goal"}, ["0/0", "0/2", "1/1", "1/0", "0/1"]),
        ({"order": "time_to_goal", "falling": True}, ["1/0", "0/2", "1/1", "0/0", "0/1"]),
        ({"order": "preset", "falling": True}, ["1/0", "1/1", "0/0", "0/1", "0/2"]),
        ({"page": 1, "size": 2}, ["0/2", "1/0"]),
        ({"page": 9, "size": 2}, []),
        ({"text": "[x(*"}, []),
    ],
)
def test_episodes_are_filtered_sorted_and_paged(client: TestClient, asked: dict[str, Any], episodes: list[str]) -> None:
    found = ask(client, **asked)
    assert [f"{row['run'].removeprefix('multirun/')}/{row['episode']}" for row in found["rows"]] == episodes


@pytest.mark.usefixtures("two_runs")
def test_filters_tell_how_many_episodes_each_value_would_leave(client: TestClient) -> None:
    counts = ask(client, allowed={"preset": ["teb"]})["counts"]
    assert counts["preset"] == {"dwa": 3, "teb": 2}
    assert counts["robot"] == {"jackal": 1, "robotino": 1}
    assert ask(client, allowed={"preset": ["teb"]}, text="timeout")["counts"]["preset"] == {"dwa": 1, "teb": 0}


@pytest.mark.usefixtures("two_runs")
def test_wrong_questions_are_refused_in_one_line(client: TestClient) -> None:
    for asked in (
        {"order": "no"},
        {"allowed": {"no": ["x"]}},
        {"size": 0},
        {"page": -1},
        {"text": "x" * 5000},
        {"allowed": 3},
    ):
        answer = client.post("/api/results/page", json=asked)
        assert answer.status_code == 400
        assert "\n" not in answer.json()["error"]
    assert client.post("/api/results/page", content=b"\xff{").status_code == 400


@pytest.mark.usefixtures("two_runs")
def test_run_that_vanishes_and_one_that_grows_are_told(client: TestClient, folder: Path, write_run: WriteRun) -> None:
    ask(client)
    shutil.rmtree(folder / "multirun/1")
    write_run("multirun/0", {}, {}, {}, {})
    found = ask(client)
    assert found["total"] == 4
    assert found["gone"] == {"multirun/1": 2}
    write_run("multirun/1", {})
    assert ask(client)["gone"] == {}


@pytest.mark.usefixtures("two_runs")
@pytest.mark.parametrize(
    "content", [b"", b"a,b\n1,2\n", b"\xff\xfe\x00", b'"', b"PK\x03\x04" + bytes(500), b"episode\n1\n"]
)
def test_damaged_table_is_told_and_the_others_are_shown(client: TestClient, folder: Path, content: bytes) -> None:
    (folder / "bad").mkdir()
    (folder / "bad" / "episodes.csv").write_bytes(content)
    found = ask(client)
    assert found["total"] == 5
    assert len(found["troubles"]) == 1
    assert "bad/episodes.csv" in found["troubles"][0]


@pytest.mark.usefixtures("two_runs")
def test_table_that_is_a_link_out_of_the_folder_is_left_alone(client: TestClient, folder: Path) -> None:
    (folder / "linked").mkdir()
    (folder / "linked" / "episodes.csv").symlink_to("/etc/hostname")
    (folder / "elsewhere").symlink_to("/etc")
    found = ask(client)
    assert (found["total"], found["troubles"]) == (5, [])


@pytest.mark.usefixtures("two_runs")
def test_export_has_the_filtered_rows_with_all_columns(client: TestClient, write_run: WriteRun) -> None:
    write_run("odd", {"error": "=1+1", "preset": "teb", "time_to_goal": 0.1 + 0.2})
    answer = client.post("/api/results/export", json={"allowed": {"preset": ["teb"]}})
    rows = list(csv.DictReader(io.StringIO(answer.text)))
    assert answer.headers["content-type"].startswith("text/csv")
    assert [row["run"] for row in rows] == ["multirun/1", "multirun/1", "odd"]
    assert float(rows[2]["time_to_goal"]) == 0.1 + 0.2
    assert rows[2]["error"].startswith("'=")
    assert rows[0]["config_hash"] == "0badcafe"


def test_export_is_written_as_all_tables_are(client: TestClient, write_run: WriteRun, folder: Path) -> None:
    write_run("odd", {"error": "a\x1b[31m\u2028\0b", "success": "", "time_to_goal": 0.1})
    write_run("none", {"error": "\t=1", "success": 0.0, "time_to_goal": ""})
    text = client.post("/api/results/export", json={}).text
    columns, rows = read_table(written(folder.parent / "export.csv", text), "a table")
    assert text.count("\n") == 3
    assert not BREAKS.search(text.replace("\n", ""))
    assert text == csv_text([columns, *(list(row.values()) for row in rows)])
    assert [(row["run"], row["error"], row["success"], row["time_to_goal"]) for row in rows] == [
        ("none", "'\\t=1", "0.0", ""),
        ("odd", "a\\x1b[31m\\u2028\\x00b", "", "0.1"),
    ]


def written(path: Path, text: str) -> Path:
    path.write_text(text, newline="")
    return path


@pytest.mark.usefixtures("two_runs")
def test_planners_are_compared_by_the_cores_statistics(client: TestClient, write_run: WriteRun) -> None:
    for run, preset, seconds in (("a", "dwa", 10.0), ("b", "teb", 12.0)):
        facts = {"preset": preset, "planner": preset, "config_hash": preset}
        write_run(
            run, *({**facts, "scenario_hash": f"{number}", "time_to_goal": seconds + number} for number in range(6))
        )
    asked = {"allowed": {"run": ["a", "b"]}, "baseline": "dwa"}
    answer = client.post("/api/results/compare", json=asked)
    assert answer.status_code == 200, answer.text
    found = [row for row in answer.json() if row["metric"] == "time_to_goal"]
    assert [(row["planner"], row["baseline"], row["difference"], row["pairs"]) for row in found] == [
        ("teb", "dwa", 2, 6)
    ]


def test_nothing_to_compare_is_told(client: TestClient) -> None:
    assert ask(client)["total"] == 0
    assert client.post("/api/results/compare", json={}).status_code == 404
    assert client.post("/api/results/report", json={}).status_code == 404


def test_replay_of_what_is_not_there_is_told(client: TestClient, write_run: WriteRun) -> None:
    write_run("run", {})
    wrong = {
        "run=gone&episode=0": 404,
        "run=run&episode=7": 400,
        "run=run&episode=0": 400,
        "run=../x&episode=0": 400,
        "episode=0": 400,
    }
    for query, status in wrong.items():
        answer = client.get(f"/replay/document?{query}")
        assert answer.status_code == status, answer.text


@pytest.mark.slow
def test_hundred_thousand_episodes_are_filtered_in_memory(folder: Path, write_run: WriteRun) -> None:
    """A timing decides nothing here; it is printed."""
    for run in range(20):
        preset = ("dwa", "teb", "mpc", "orca")[run % 4]
        write_run(
            f"run{run}",
            *(
                {"preset": preset, "scenario": f"random/{number}", "time_to_goal": number % 97}
                for number in range(5000)
            ),
        )
    table = EpisodeTable(folder)
    table.refresh()
    for query in (Query({"preset": ["teb"]}), Query(text="mpc random/12"), Query(order="time_to_goal", falling=True)):
        began = process_time()
        chosen = table.select(query)
        table.counts(query)
        print(f"{query}: {len(chosen)} episodes in {process_time() - began:.3f} s")
        assert 0 < len(chosen) <= 100_000
    with pytest.raises(ArenaError, match="there is no column"):
        table.select(Query({"x": ["y"]}))
