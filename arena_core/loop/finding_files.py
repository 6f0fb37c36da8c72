"""What was found out about episodes afterwards, in small files of its own beside their records, which never change."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from arena_core.base.errors import InputFileError
from arena_core.base.files import AnyPath, read_json
from arena_core.base.whole_files import write_text_whole

FOLDER = "findings"
ALLOWED = "findings that a command of `arena` wrote"
Value = float | str


@dataclass(frozen=True, slots=True)
class FindingColumn:
    """What a column means: its unit as metrics have it (``0/1``, ``text``), and whether ``higher``, ``lower`` or
    ``neither`` is better. No number lies outside ``bounds``.
    """

    name: str
    unit: str
    better: str
    description: str
    bounds: tuple[float, float] = (-math.inf, math.inf)


@dataclass(frozen=True, slots=True)
class FindingMark:
    """A moment of an episode: of what ``kind`` it is, when, s, and what happened, in words.

    ``way`` are the places (x, y), m in ``map``, of a way that was possible from then on; none where none is known.
    """

    kind: str
    stamp: float
    text: str
    way: Sequence[tuple[float, float]] = ()


@dataclass(frozen=True, slots=True, eq=False)
class Findings:
    """The findings of one kind about a run: ``rows`` by episode, each with a value for every column; ``code`` is the
    digest of what found them. ``marks`` are moments of episodes, which replays show.
    """

    kind: str
    code: str
    columns: Sequence[FindingColumn]
    rows: Mapping[int, Mapping[str, Value]]
    marks: Mapping[int, Sequence[FindingMark]] = field(default_factory=dict)


def write_findings(folder: AnyPath, findings: Findings) -> Path:
    """Write ``findings/KIND.json`` beside a run's records, whole or not at all; numbers that are not finite are
    written as texts. Return the file.
    """
    rows = {
        str(episode): {name: _written(value) for name, value in row.items()} for episode, row in findings.rows.items()
    }
    told = {"code": findings.code, "columns": list(map(_written_column, findings.columns)), "episodes": rows}
    marks = {str(episode): [asdict(mark) for mark in of] for episode, of in findings.marks.items() if of}
    told |= {"marks": marks} if marks else {}
    path = Path(folder) / FOLDER / f"{findings.kind}.json"
    path.parent.mkdir(exist_ok=True)
    write_text_whole(path, json.dumps(told, indent=1) + "\n")
    return path


def read_findings(folder: AnyPath) -> list[Findings]:
    """Return what was found out about a run, by kind; nothing where there is nothing. Raise InputFileError."""
    return [_read(path) for path in sorted((Path(folder) / FOLDER).glob("*.json"))]


def _written_column(column: FindingColumn) -> dict[str, Any]:
    """Return a column as its file has it; one without bounds says nothing of any."""
    told = asdict(column)
    bounds = told.pop("bounds")
    return told | ({"bounds": [_written(end) for end in bounds]} if any(map(math.isfinite, bounds)) else {})


def _column(told: Mapping[str, Any]) -> FindingColumn:
    least, most = map(float, told.get("bounds", (-math.inf, math.inf)))
    name, unit, better, description = (str(told[key]) for key in ("name", "unit", "better", "description"))
    return FindingColumn(name, unit, better, description, (least, most))


def _written(value: Value) -> Value:
    return value if isinstance(value, str) or math.isfinite(value) else str(float(value))


def _read(path: Path) -> Findings:
    told = read_json(path, ALLOWED)
    try:
        columns = list(map(_column, told["columns"]))
        texts = {column.name for column in columns if column.unit == "text"}
        rows = {int(episode): _row(row, texts) for episode, row in told["episodes"].items()}
        marks = {int(episode): [_mark(mark) for mark in of] for episode, of in told.get("marks", {}).items()}
        return Findings(path.stem, str(told["code"]), columns, rows, marks)
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise InputFileError(f"{path}: holds no findings ({error}); allowed: {ALLOWED}") from None


def _mark(told: Mapping[str, Any]) -> FindingMark:
    way = tuple((float(x), float(y)) for x, y in told["way"])
    return FindingMark(str(told["kind"]), float(told["stamp"]), str(told["text"]), way)


def _row(row: Mapping[str, Any], texts: set[str]) -> dict[str, Value]:
    return {name: str(value) if name in texts else float(value) for name, value in row.items()}
