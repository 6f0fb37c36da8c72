"""Ladders in `arena report`: found by their blocks, drawn from what `arena ladder` wrote, and sentences of pairs."""

import csv
import json
import shutil
from pathlib import Path

import pytest

from arena_core import InputFileError
from arena_core.records import EPISODE_COLUMNS
from arena_ladder.command import LadderCommand
from arena_ladder.driving import LadderFolder
from arena_ladder.plan import make_plan
from arena_metrics.pages.figures import report_style
from arena_metrics.pages.ladders import ladder_image, ladder_tables
from arena_metrics.pages.report import ReportCommand
from arena_metrics.pooling.ladders import LadderDocument, ladders_below, read_ladder_document

PLAN = make_plan("hall", "slow", 24, 0.2)
HEADER = [*EPISODE_COLUMNS, "success", "strict_success", "people_per_100m2"]


def write_ladder(folder, planner, wins):
    """Write a ladder with a block on each of the first rungs, and so many successes."""
    ladder = LadderFolder(folder, PLAN, (f"planner={planner}", "robot=jackal"))
    ladder.begin(resume=False)
    for number, (rung, won) in enumerate(zip(PLAN.first, wins, strict=True)):
        path = folder / "hall_slow" / f"{number:03d}_{PLAN.rungs[rung]:g}"
        path.mkdir(parents=True)
        with (path / "episodes.csv").open("w", newline="") as file:
            writer = csv.DictWriter(file, HEADER, restval="")
            writer.writeheader()
            for episode in range(PLAN.block):
                success = {"success": float(episode < won), "strict_success": float(episode < won)}
                facts = {"episode": episode, "seed": PLAN.seed + number, "outcome": "time_out", "stage": rung}
                names = {"config_hash": f"{planner}{rung}", "planner": planner, "preset": planner, "robot": "jackal"}
                people = {"people_per_100m2": PLAN.rungs[rung], "n_pedestrians": int(PLAN.rungs[rung])}
                writer.writerow({**facts, **names, **success, **people, "scenario": f"density/{episode:04d}"})


def report(*folders, out=None):
    return LadderCommand().run(["report", *map(str, folders), *([] if out is None else [f"out={out}"])])


def blocks(place):
    return sorted(path.parent for path in place.rglob("episodes.csv"))


@pytest.fixture(scope="module")
def ended(tmp_path_factory):
    """Two ladders that have ended, which no test changes."""
    folder = tmp_path_factory.mktemp("ended")
    for planner, wins in (("dwa", (8, 7, 5)), ("teb", (8, 4, 1))):
        write_ladder(folder / planner, planner, wins)
        assert report(folder / planner) == 0
    return folder


@pytest.fixture(scope="module")
def reported(ended):
    """How they compare in pairs."""
    folder = ended.with_name("reported")
    assert report(ended / "dwa", ended / "teb", out=folder) == 0
    return folder


@pytest.fixture
def ladders(ended, tmp_path):
    """Two ladders that have ended."""
    return Path(shutil.copytree(ended, tmp_path / "ladders"))


@pytest.fixture
def compared(ladders, reported):
    """Two ladders that have ended, and ``report``, which compares them."""
    shutil.copytree(reported, ladders / "report")
    return ladders


def test_a_document_holds_what_the_ladder_wrote(ladders):
    told = json.loads((ladders / "dwa" / "ladder.json").read_text())["ladders"][0]["cells"]["hall_slow"]["success"]
    (ladder,) = read_ladder_document(ladders / "dwa" / "ladder.json").ladders
    curve = ladder.cells["hall_slow"]["success"]
    assert [(x, episodes) for x, _, episodes in curve.driven] == [(0.0, 8), (4.0, 8), (12.0, 8)]
    assert (curve.rho90.value, curve.rho90.text) == (told["rho90"]["value"], told["rho90"]["text"])
    for x, y in curve.curve:
        slope = json.loads((ladders / "dwa" / "ladder.json").read_text())["ladders"][0]["slopes"]["success"]
        assert y == pytest.approx((1.0 - told["lapse"]) / (1.0 + (x / told["half"]) ** slope), abs=1e-6)
    assert curve.curve[-1][0] == ladder.highest == 24.0


def test_ladders_are_found_by_their_blocks_and_say_how_to_compare_them(ladders, reported):
    found = ladders_below(blocks(ladders))
    assert [one.name for one in found.ladders] == ["dwa on jackal", "teb on jackal"]
    assert found.pairs == []
    assert found.notes == [
        f"arena ladder report {ladders / 'dwa'} {ladders / 'teb'} out={ladders / 'report'} compares them in pairs; "
        "the next report then says which of them bears more people."
    ]
    shutil.copytree(reported, ladders / "report")
    found = ladders_below(blocks(ladders))
    (sentence,) = found.pairs
    assert "dwa" in sentence
    assert found.notes == []
    assert ladders_below(blocks(ladders / "dwa")).pairs == []
    assert ladders_below([ladders]) is None


def test_sentences_of_other_figures_are_not_taken(compared):
    ladders = compared
    assert ladders_below(blocks(ladders)).pairs
    told = json.loads((ladders / "dwa" / "ladder.json").read_text())
    told["ladders"][0]["cells"]["hall_slow"]["success"]["rho90"]["value"] = 5.0
    (ladders / "dwa" / "ladder.json").write_text(json.dumps(told))
    assert ladders_below(blocks(ladders)).pairs == []


def test_a_ladder_that_has_not_ended_or_is_of_before_is_noted(ladders):
    (ladders / "dwa" / "ladder.json").unlink()
    told = json.loads((ladders / "teb" / "ladder.json").read_text())
    del told["ladders"][0]["cells"]["hall_slow"]["success"]["curve"]
    (ladders / "teb" / "ladder.json").write_text(json.dumps(told))
    found = ladders_below(blocks(ladders))
    assert found.ladders == []
    first, second = found.notes
    assert first == f"{ladders / 'dwa'} has no ladder.json yet: its ladder has not ended."
    assert "lacks 'curve'; allowed: what this version of `arena ladder` wrote" in second
    assert ladder_image(found, pdf=False) is None
    assert ladder_tables(found) == []


def test_tables_have_a_row_for_each_cell_and_a_column_for_each_planner(ladders):
    tables = ladder_tables(ladders_below(blocks(ladders)))
    assert len(tables) == 4
    assert tables[0].head == ["world", "crowd", "dwa on jackal", "teb on jackal"]
    (row,) = tables[0].rows
    assert row[:2] == ["hall", "slow"]
    assert (
        row[2]
        == read_ladder_document(ladders / "dwa" / "ladder.json").ladders[0].cells["hall_slow"]["success"].rho90.text
    )


def test_a_report_over_ladders_shows_their_figure_tables_and_sentences(compared):
    ladders = compared
    assert ReportCommand().run([str(ladders / "dwa"), str(ladders / "teb"), f"out={ladders / 'over'}"]) == 0
    page = (ladders / "over" / "index.html").read_text()
    assert "Among how many people they break" in page
    assert ladders_below(blocks(ladders)).pairs[0] in page
    assert (ladders / "over" / "figures" / "ladders.png").read_bytes() == (
        ladders / "report" / "ladder.png"
    ).read_bytes()
    with (ladders / "over" / "tables" / "ladders.csv").open() as file:
        assert "dwa on jackal" in file.read()


def test_a_figure_is_the_same_for_the_same_document(ladders):
    document = ladders_below(blocks(ladders))
    with report_style():
        first, second = (ladder_image(document, pdf=True) for _ in range(2))
    assert first.png == second.png
    assert first.pdf is not None
    assert ladder_image(LadderDocument([], []), pdf=False) is None


@pytest.mark.parametrize(
    ("content", "told"),
    [
        ("{", "is no JSON"),
        ("[]", "holds no ladder"),
        ('{"ladders": [{"planner": "dwa"}], "pairs": []}', "lacks 'robot'"),
        ('{"ladders": [{"planner": "a", "robot": "b", "rungs": [], "cells": {}}], "pairs": []}', "holds no ladder"),
        ('{"ladders": [{"planner": "a", "robot": "b", "rungs": [true], "cells": {}}], "pairs": []}', "is no number"),
    ],
)
def test_what_is_no_document_is_told_in_one_line(tmp_path, content, told):
    (tmp_path / "ladder.json").write_text(content)
    with pytest.raises(InputFileError) as raised:
        read_ladder_document(tmp_path / "ladder.json")
    assert told in str(raised.value)
    assert "\n" not in str(raised.value)
