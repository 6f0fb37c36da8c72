"""Ratings of drives by people: means by hand, and files that are no survey's."""

import json
import math

import pytest

from arena_core import ConfigurationError, InputFileError
from arena_core.records import record_digest
from arena_metrics.packs.survey import SurveyMetrics


@pytest.fixture(scope="module")
def record(record_of, straight_line):
    return record_of(straight_line(4.0, 1.0), meta={"columns": {"planner": "dwa"}, "events": []})


@pytest.fixture
def name(record):
    return f"dwa-jackal-0003-{record_digest(record)}"


def figures(path, record):
    return {metric.name: metric.compute(record) for metric in SurveyMetrics(str(path)).metrics()}


def test_a_rating_is_the_mean_over_those_who_rated(tmp_path, record, name):
    rated = tmp_path / "a.csv"
    rated.write_text(f"trajectory,context,score\n{name},a hospital,0.5\n{name}.json,,0.9\nother-0000-00ff,,0.1\n")
    found = figures(rated, record)
    assert found["rating"] == pytest.approx(0.7)
    assert found["disagreement"] == pytest.approx(math.sqrt(0.08))
    assert found["ratings"] == 2


def test_raters_of_a_folder_are_taken_together(tmp_path, record, name):
    (tmp_path / "a.json").write_text(json.dumps({"ratings": [[name, "a museum", 1]]}))
    (tmp_path / "b.csv").write_text(f"trajectory,score\n{name},0\n")
    (tmp_path / "notes.txt").write_text("not a rating")
    assert figures(tmp_path, record)["rating"] == 0.5


def test_who_was_not_rated_has_no_rating(tmp_path, record):
    rated = tmp_path / "a.csv"
    rated.write_text("trajectory,score\nother-0000-00ff,0.1\n")
    found = figures(rated, record)
    assert math.isnan(found["rating"])
    assert math.isnan(found["disagreement"])
    assert found["ratings"] == 0


@pytest.mark.parametrize(
    ("file", "text", "said"),
    [
        ("a.csv", "drive,score\nx,1\n", "has no column trajectory"),
        ("a.csv", "trajectory,score\nx,7\n", "a score is 7"),
        ("a.csv", "trajectory,score\nx,nan\n", "a score is nan"),
        ("a.json", "[]", "has no list ratings"),
        ("a.json", '{"ratings": {}}', "has no list ratings"),
        ("a.json", '{"ratings": [["x", 1]]}', "a rating is"),
        ("a.json", '{"ratings": [["x", "", true]]}', "a score is True"),
        ("a.json", '{"ratings": [["x", "", null]]}', "a score is None"),
    ],
)
def test_a_file_that_is_no_survey_s_is_one_line(tmp_path, file, text, said):
    (tmp_path / file).write_text(text)
    with pytest.raises(InputFileError, match=said) as refused:
        SurveyMetrics(str(tmp_path / file))
    assert "allowed" in str(refused.value)
    assert "\n" not in str(refused.value)


def test_a_folder_without_ratings_and_no_path_are_one_line(tmp_path):
    with pytest.raises(InputFileError, match="holds no ratings"):
        SurveyMetrics(str(tmp_path))
    with pytest.raises(ConfigurationError, match=r"metrics\.survey\.path is null"):
        SurveyMetrics(None)
