"""What was found out about episodes, in files beside their records."""

import json
import math

import pytest

from arena_core import InputFileError
from arena_core.records import FindingColumn, FindingMark, Findings, read_findings, write_findings

COLUMNS = (
    FindingColumn("seconds", "s", "lower", "how long"),
    FindingColumn("word", "text", "neither", "what was said"),
)


def test_bounds_of_a_column_are_read_back(tmp_path):
    bounded = FindingColumn("share", "-", "higher", "a share", (0.0, 1.0))
    above = FindingColumn("time", "s", "lower", "a time", (0.0, math.inf))
    free = FindingColumn("regret", "s", "lower", "may be either")
    written = Findings("kind", "code", (bounded, above, free), {0: {"share": 0.5, "time": 1.0, "regret": -1.0}})
    write_findings(tmp_path, written)
    assert read_findings(tmp_path)[0].columns == [bounded, above, free]


def test_what_is_written_is_read(tmp_path):
    assert read_findings(tmp_path) == []
    rows = {
        3: {"seconds": math.inf, "word": "1.0"},
        0: {"seconds": 2.5, "word": ""},
        7: {"seconds": math.nan, "word": "x"},
    }
    write_findings(tmp_path, Findings("kind", "abc", COLUMNS, rows))
    (found,) = read_findings(tmp_path)
    assert (found.kind, found.code, tuple(found.columns)) == ("kind", "abc", COLUMNS)
    assert found.rows[3] == rows[3]
    assert found.rows[0] == rows[0]
    assert math.isnan(found.rows[7]["seconds"])


def test_moments_of_episodes_are_written_and_read(tmp_path):
    marks = {
        2: [FindingMark("stand", 3.5, "stood 4 s"), FindingMark("way", 9.0, "until then", ((0.0, 1.5), (1.0, 2.0)))]
    }
    write_findings(tmp_path, Findings("kind", "abc", COLUMNS, {}, marks))
    assert read_findings(tmp_path)[0].marks == marks


@pytest.mark.parametrize(
    "told",
    [
        {"code": "a", "columns": [], "episodes": {}, "marks": {"1": [{"kind": "x", "stamp": 1.0}]}},
        {
            "code": "a",
            "columns": [],
            "episodes": {},
            "marks": {"1": [{"kind": "x", "stamp": 1, "text": "", "way": [1]}]},
        },
        {"code": "a", "columns": [], "episodes": {}, "marks": []},
        {},
        {"code": "a", "columns": [], "episodes": []},
        {"code": "a", "columns": [{"name": "x"}], "episodes": {}},
        {"code": "a", "columns": [], "episodes": {"first": {}}},
        {"code": "a", "columns": [], "episodes": {"1": {"x": "much"}}},
        [],
    ],
)
def test_what_is_none_is_refused_in_one_line(tmp_path, told):
    (tmp_path / "findings").mkdir()
    (tmp_path / "findings" / "kind.json").write_text(json.dumps(told))
    with pytest.raises(InputFileError, match=r"kind\.json: .*allowed: findings"):
        read_findings(tmp_path)
