"""``arena query``: SQL over the tables of runs, by DuckDB."""

from __future__ import annotations

from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

from arena_core import ConfigurationError, InputFileError
from arena_core.commands import Command, align_columns, one_line, read_words
from arena_core.files import csv_text, write_text_whole
from arena_core.records import EPISODE_COLUMNS, find_runs, read_findings

if TYPE_CHECKING:
    from duckdb import DuckDBPyConnection

USAGE = 'arena query "SELECT planner, avg(success) FROM episodes GROUP BY planner" DIR... [out=FILE.csv|FILE.parquet]'
NUMBERS = ("episode", "seed", "n_pedestrians", "stage")  # of the columns that are no metrics
PRINTED = 200  # rows that go to the terminal


class QueryCommand(Command):
    """Ask SQL of all runs below the given folders."""

    help: ClassVar[str] = (
        'SQL over runs: arena query "select planner, avg(success) from episodes group by planner" DIR...'
    )

    def run(self, arguments: Sequence[str]) -> int:
        """Print the answer, or write it to a file."""
        if not arguments or any(word in ("-h", "--help") for word in arguments):
            print(
                f"usage: {USAGE}\n\nThe table is called episodes: a row an episode, the columns of episodes.csv, "
                "and run, the folder."
            )
            return 0
        if find_spec("duckdb") is None:
            raise ConfigurationError("arena query needs duckdb; install the extra arena-metrics[query]")
        words = read_words(USAGE, arguments[1:], names=None, keys=("out",))
        out = _output_file(words.keys.get("out"))
        runs = list(dict.fromkeys(run for folder in words.names or (".",) for run in find_runs(Path(folder))))
        beside = out.with_name(f".{out.name}.new") if out is not None and out.suffix == ".parquet" else None
        with _connect_database(runs, beside) as database:
            if beside is not None and out is not None:
                _write_parquet(database, arguments[0], beside, out)
            else:
                _print_answer(database, arguments[0], out)
        return 0


def _output_file(name: str | None) -> Path | None:
    """Return the file to write, None for the terminal; raise ConfigurationError for another kind of file."""
    if name is None:
        return None
    if Path(name).suffix not in (".csv", ".parquet"):
        raise ConfigurationError(f"out is {name}; allowed: a file called .csv or .parquet")
    return Path(name)


def _connect_database(runs: Sequence[Path], out: Path | None) -> DuckDBPyConnection:
    """Return a database in memory that holds the table ``episodes`` and can reach nothing else but the file ``out``."""
    import duckdb

    database = duckdb.connect(":memory:")
    files = [str(run / "episodes.csv") for run in runs]
    try:
        database.execute(
            "CREATE TABLE written AS SELECT * REPLACE (regexp_replace(filename, '/?episodes[.]csv$', "
            "'') AS filename) FROM read_csv(?, "
            "header = true, all_varchar = true, union_by_name = true, filename = true)",
            [files],
        )
        _add_findings(database, runs)
        names = [name for name, *_ in database.execute("DESCRIBE written").fetchall() if name != "filename"]
        columns = [_typed_column(database, name) for name in names]
        wanted = ", ".join(columns)  # quoted names
        database.execute(f"CREATE TABLE episodes AS SELECT {wanted}, filename AS run FROM written")  # noqa: S608
        database.execute("DROP TABLE written")
        if out is not None:
            database.execute("SET allowed_paths = [$path]", {"path": str(out.resolve())})
        database.execute("SET enable_external_access = false")
        database.execute("SET lock_configuration = true")
    except duckdb.Error as error:
        raise InputFileError(
            f"{files[0]}{' ...' if len(files) > 1 else ''}: {_error_reason(error)}; allowed: tables of runs"
        ) from None
    return database


def _add_findings(database: DuckDBPyConnection, runs: Sequence[Path]) -> None:
    """Add what was found out about episodes to their rows: columns such as ``reference.stl``."""
    known = [
        (str(run), str(episode), f"{kind.kind}.{name}", str(value))
        for run in runs
        for kind in read_findings(run)
        for episode, row in kind.rows.items()
        for name, value in row.items()
        if value == value  # NaN is NULL
    ]
    database.execute("CREATE TABLE found (run VARCHAR, episode VARCHAR, name VARCHAR, value VARCHAR)")
    if known:
        database.executemany("INSERT INTO found VALUES (?, ?, ?, ?)", known)
    for name in dict.fromkeys(name for _, _, name, _ in known):
        quoted = f'"{name.replace(chr(34), chr(34) * 2)}"'
        database.execute(f"ALTER TABLE written ADD COLUMN {quoted} VARCHAR")
        database.execute(
            f"UPDATE written SET {quoted} = found.value FROM found "  # noqa: S608 - quoted names
            "WHERE found.run = written.filename AND found.episode = written.episode AND found.name = ?",
            [name],
        )
    database.execute("DROP TABLE found")


def _typed_column(database: DuckDBPyConnection, name: str) -> str:
    """Return a column as a number, where every value of it is one; empty values are NULL."""
    quoted = f'"{name.replace(chr(34), chr(34) * 2)}"'
    if name in EPISODE_COLUMNS and name not in NUMBERS:
        return quoted
    no_number = f"nullif({quoted}, '') IS NOT NULL AND try_cast({quoted} AS DOUBLE) IS NULL"
    wrong = database.execute(f"SELECT count(*) FROM written WHERE {no_number}").fetchone()  # noqa: S608 - quoted
    kind = "BIGINT" if name in NUMBERS else "DOUBLE"
    return quoted if wrong is None or wrong[0] else f"CAST(nullif({quoted}, '') AS {kind}) AS {quoted}"


def _run_query(database: DuckDBPyConnection, question: str) -> tuple[list[str], list[tuple[Any, ...]]]:
    import duckdb

    try:
        found = database.execute(question)
        return [str(column[0]) for column in found.description or ()], found.fetchall()
    except duckdb.Error as error:
        raise ConfigurationError(f"the query cannot be answered: {_error_reason(error)}") from None


def _print_answer(database: DuckDBPyConnection, question: str, out: Path | None) -> None:
    head, rows = _run_query(database, question)
    if out is not None:
        write_text_whole(out, csv_text([head, *rows]))
        print(f"{len(rows)} rows: {out}")
        return
    print("\n".join(align_columns([head, *([_cell_text(value) for value in row] for row in rows[:PRINTED])])))
    if len(rows) > PRINTED:
        print(f"... {len(rows) - PRINTED} more; out=FILE.csv writes all")


def _write_parquet(database: DuckDBPyConnection, question: str, beside: Path, out: Path) -> None:
    print(f"{_copy_answer(database, question, beside, out)} rows: {out}")


def _copy_answer(database: DuckDBPyConnection, question: str, beside: Path, out: Path) -> int:
    """Write an answer to a Parquet file by way of the one that the database can reach; return its number of rows."""
    import duckdb

    try:
        database.execute(f"CREATE TABLE answer AS {question.rstrip().rstrip(';')}")
        count = database.execute("SELECT count(*) FROM answer").fetchone()
        target = str(beside.resolve()).replace("'", "''")
        database.execute(f"COPY answer TO '{target}' (FORMAT parquet)")
        beside.replace(out)
    except duckdb.Error as error:
        raise ConfigurationError(f"the query cannot be answered: {_error_reason(error)}") from None
    finally:
        beside.unlink(missing_ok=True)
    return int(count[0]) if count else 0


def write_table(runs: Sequence[Path], out: Path) -> bool:
    """Write all episodes of these runs to a Parquet file, whole or not at all; return whether
    DuckDB is installed to do so.
    """
    if find_spec("duckdb") is None:
        return False
    out.parent.mkdir(parents=True, exist_ok=True)
    beside = out.with_name(f".{out.name}.new")
    with _connect_database(runs, beside) as database:
        _copy_answer(database, "SELECT * FROM episodes", beside, out)
    return True


def _cell_text(value: Any) -> str:
    if value is None:
        return ""
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def _error_reason(error: Exception) -> str:
    return one_line(str(error).partition("\n\n")[0].replace("\n", " "), 300)
