"""The section of a report that says what planners cost people, and the columns that its reader chooses."""

import json
import re

import numpy as np
import pytest

from arena_core import ConfigurationError, InputFileError
from arena_core.records import Findings, write_findings
from arena_metrics.pages.people import pareto_front
from arena_metrics.pages.report import ReportCommand
from arena_reference.people_cost import COLUMNS, empty_row


def cost_of(folder, delays):
    """Write findings as ``arena cost`` does, with these delays."""
    rows = {
        episode: {**empty_row(""), "people_delay": delay, "people_delay_floor": 0.1}
        for episode, delay in enumerate(delays)
    }
    write_findings(folder, Findings("cost", "00000000", COLUMNS, rows))


@pytest.fixture
def costed(run_folder, tmp_path):
    """Give the folder of two planners' runs whose cost to people is known."""
    for planner, delay in (("dwa", 2.0), ("teb", 0.5)):
        run_folder(tmp_path / planner, planner=planner, episodes=6)
        cost_of(tmp_path / planner, delay + 0.1 * np.arange(6.0))
    return tmp_path


def report(folder, *words):
    assert (
        ReportCommand().run([str(folder), f"out={folder / 'page'}", "--pictures", "0", "--replays", "0", *words]) == 0
    )
    return (folder / "page" / "index.html").read_text()


def test_the_page_says_what_planners_cost_people(costed):
    page = report(costed)
    assert "What it cost the people" in page
    assert (costed / "page/figures/cost_to_people.png").stat().st_size > 1000
    table = (costed / "page/tables/cost_to_people.csv").read_text().splitlines()
    assert table[0].startswith("cell,people delay [s],people delay floor [s]")
    assert table[1].startswith("dwa,2.25 [")


def test_a_report_without_such_findings_has_no_such_section(run_folder, tmp_path):
    run_folder(tmp_path / "dwa", episodes=3)
    page = report(tmp_path)
    assert "What it cost the people" not in page
    assert not (tmp_path / "page/figures/cost_to_people.png").exists()


def test_every_name_of_a_metric_leads_to_its_definition(costed):
    page = report(costed, "report.columns=success,cost.people_delay")
    places = set(re.findall(r'<tr id="(metric-\d+)">', page))
    links = re.findall(r'<a class="metric" href="#(metric-\d+)"', page)
    assert set(links) == places
    assert "delay at the waypoint in hand, with the robot less without" in page
    headline = page.partition('class="headline"')[2].partition("</thead>")[0]
    assert headline.count('class="metric"') == headline.count("<small>") == 2


def test_chosen_columns_are_those_of_the_headline(costed, capsys):
    report(costed, "report.columns=[path_length,cost.people_delay]")
    head = (costed / "page/tables/headline.csv").read_text().splitlines()[0]
    assert head == 'planner,n,"path length [m], successful",people delay [s]'


@pytest.mark.parametrize(
    ("words", "error", "said"),
    [
        (
            ["report.columns=success,calm"],
            InputFileError,
            "report.columns names calm; allowed: success, strict_success",
        ),
        (["report.columns="], ConfigurationError, "allowed: report.columns=METRIC,METRIC, once"),
        (["report.columns=success", "report.columns=spl"], ConfigurationError, "once"),
    ],
)
def test_columns_that_are_not_there_are_refused(costed, words, error, said):
    with pytest.raises(error, match=re.escape(said)):
        report(costed, *words)


def test_the_front_holds_whom_nobody_beats_in_both():
    points = np.array([(10.0, 2.0), (12.0, 1.0), (13.0, 1.5), (10.0, 3.0), (9.0, 4.0)])
    assert pareto_front(points) == [4, 0, 1]
    assert pareto_front(points[:1]) == [0]


def test_findings_of_before_are_read_as_they_are(costed):
    text = json.loads((costed / "dwa/findings/cost.json").read_text())
    text["columns"] = text["columns"][:1]
    text["episodes"] = {episode: {"people_delay": row["people_delay"]} for episode, row in text["episodes"].items()}
    (costed / "dwa/findings/cost.json").write_text(json.dumps(text))
    assert "What it cost the people" in report(costed)
