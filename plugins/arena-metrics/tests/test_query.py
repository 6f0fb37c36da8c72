"""SQL over runs: the columns have their types, and nothing but the tables can be reached."""

import csv

import pytest

from arena_core import ConfigurationError, InputFileError
from arena_metrics.tables.query import QueryCommand, write_table

FEW = ("success", "collisions", "path_length")


@pytest.fixture
def runs(run_folder, tmp_path):
    run_folder(tmp_path / "runs" / "dwa", planner="dwa", episodes=4, fails=[1], only=FEW, errors=[3], records=False)
    run_folder(tmp_path / "runs" / "teb", planner="teb", episodes=6, fails=[2], only=FEW[:2], records=False)
    return tmp_path / "runs"


def ask(question, *words):
    return QueryCommand().run([question, *map(str, words)])


def test_the_answer_is_a_table(runs, capsys):
    ask("SELECT planner, count(*) AS n, avg(success) AS success FROM episodes GROUP BY planner ORDER BY planner", runs)
    lines = [line.split() for line in capsys.readouterr().out.splitlines()]
    assert lines == [["planner", "n", "success"], ["dwa", "4", "0.6667"], ["teb", "6", "0.8333"]]


def test_columns_are_numbers_or_texts_and_empty_ones_null(runs, capsys):
    ask("SELECT typeof(episode), typeof(success), typeof(robot), typeof(run) FROM episodes LIMIT 1", runs)
    assert capsys.readouterr().out.splitlines()[1].split() == ["BIGINT", "DOUBLE", "VARCHAR", "VARCHAR"]
    ask("SELECT count(*) - count(success) AS lost, count(*) - count(path_length) AS without FROM episodes", runs)
    assert capsys.readouterr().out.splitlines()[1].split() == ["1", "7"], (
        "an error has no metric, and a run may lack a column"
    )


def test_a_row_names_its_run(runs, capsys):
    ask("SELECT DISTINCT run FROM episodes ORDER BY run", runs / "dwa", runs)
    assert capsys.readouterr().out.splitlines()[1:] == [str(runs / "dwa"), str(runs / "teb")]


def test_an_answer_goes_to_a_file(runs, tmp_path, capsys):
    ask("SELECT planner, episode FROM episodes ORDER BY 1, 2", runs, f"out={tmp_path / 'a.csv'}")
    assert capsys.readouterr().out == f"10 rows: {tmp_path / 'a.csv'}\n"
    with (tmp_path / "a.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert rows[0] == {"planner": "dwa", "episode": "0"}
    ask("SELECT * FROM episodes;", runs, f"out={tmp_path / 'a.parquet'}")
    import duckdb

    assert duckdb.sql(f"SELECT count(*), sum(success) FROM '{tmp_path / 'a.parquet'}'").fetchall() == [(10, 7.0)]
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.csv", "a.parquet", "runs"]


@pytest.mark.parametrize(
    "question",
    [
        "SELECT * FROM read_csv('/etc/passwd')",
        "SELECT * FROM '/etc/passwd'",
        "COPY episodes TO 'stolen.csv'",
        "ATTACH 'other.db'",
        "INSTALL httpfs",
        "SET enable_external_access = true",
    ],
)
def test_nothing_else_can_be_reached(runs, question, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(ConfigurationError, match=r"^the query cannot be answered: .+"):
        ask(question, runs)
    assert [path.name for path in tmp_path.iterdir()] == ["runs"]


@pytest.mark.parametrize(
    ("question", "words", "message"),
    [
        ("SELEC 1", (), r"the query cannot be answered: .*syntax error"),
        ("SELECT nothing FROM episodes", (), r"the query cannot be answered: .*nothing"),
        ("SELECT 1", ("out=a.txt",), r"out is a\.txt; allowed: a file called \.csv or \.parquet"),
        ("SELECT 1", ("other=1",), "other"),
    ],
)
def test_a_wrong_query_is_refused_in_one_line(runs, question, words, message):
    with pytest.raises(ConfigurationError, match=message) as refused:
        ask(question, runs, *words)
    assert "\n" not in str(refused.value)


def test_folders_without_runs_are_refused(tmp_path):
    with pytest.raises(InputFileError, match="no run below it"):
        ask("SELECT 1", tmp_path)


def test_a_report_has_all_episodes_as_parquet_with_the_types_of_a_query(runs, tmp_path):
    import duckdb

    assert write_table(sorted(runs.iterdir()), tmp_path / "tables" / "episodes.parquet")
    found = duckdb.sql(
        f"SELECT count(*), sum(success), any_value(typeof(episode)) FROM '{tmp_path / 'tables' / 'episodes.parquet'}'"
    )
    assert found.fetchall() == [(10, 7.0, "BIGINT")]
    assert [path.name for path in (tmp_path / "tables").iterdir()] == ["episodes.parquet"]


def test_without_duckdb_there_is_no_parquet(runs, tmp_path, monkeypatch):
    monkeypatch.setattr("arena_metrics.tables.query.find_spec", lambda name: None)
    assert not write_table(sorted(runs.iterdir()), tmp_path / "tables" / "episodes.parquet")
    assert not (tmp_path / "tables").exists()
