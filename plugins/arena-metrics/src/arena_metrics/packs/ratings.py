"""Ratings of drives by people: files of a survey.

A rating names its trajectory by what ``arena export RUN to=socnav.json`` calls it, whose last part is the record's
digest. As CSV: columns ``trajectory`` and ``score``, and ``context`` where one was told. As JSON, as SocNav3
describes it: an object whose ``ratings`` is a list of [trajectory, context, score].
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from arena_core import InputFileError
from arena_core.files import read_json, read_table

ALLOWED_CSV = "a table with the columns trajectory and score, scores from 0 to 1"
ALLOWED_JSON = 'an object with "ratings": [[trajectory, context, score], ...], scores from 0 to 1'
ENDINGS = (".csv", ".json")


def read_ratings(path: Path) -> Mapping[str, Sequence[float]]:
    """Return the scores of each record, by its digest; raise InputFileError for a file that is no survey's.

    ``path`` is a file, or a folder whose files are read in the order of their names.
    """
    files = [file for file in sorted(path.iterdir()) if file.suffix in ENDINGS] if path.is_dir() else [path]
    if not files:
        raise InputFileError(f"{path}: holds no ratings; allowed: files that end in {' or '.join(ENDINGS)}")
    found: dict[str, list[float]] = {}
    for file in files:
        for trajectory, score in _file_ratings(file):
            found.setdefault(trajectory.removesuffix(".json").rpartition("-")[2], []).append(score)
    return found


def _file_ratings(file: Path) -> Iterable[tuple[str, float]]:
    if file.suffix == ".json":
        return _json_ratings(file)
    columns, rows = read_table(file, ALLOWED_CSV)
    if missing := [name for name in ("trajectory", "score") if name not in columns]:
        raise InputFileError(f"{file}: has no column {missing[0]}; allowed: {ALLOWED_CSV}")
    return [(row["trajectory"], _score(file, row["score"], ALLOWED_CSV)) for row in rows]


def _json_ratings(file: Path) -> Iterable[tuple[str, float]]:
    content = read_json(file, ALLOWED_JSON)
    ratings = content.get("ratings") if isinstance(content, dict) else None
    if not isinstance(ratings, list):
        raise InputFileError(f"{file}: has no list ratings; allowed: {ALLOWED_JSON}")
    found = []
    for rating in ratings:
        if not (isinstance(rating, list) and len(rating) == 3 and isinstance(rating[0], str)):
            raise InputFileError(f"{file}: a rating is {str(rating)[:80]}; allowed: {ALLOWED_JSON}")
        found.append((rating[0], _score(file, rating[2], ALLOWED_JSON)))
    return found


def _score(file: Path, value: Any, allowed: str) -> float:
    try:
        score = math.nan if isinstance(value, bool) else float(value)
    except (TypeError, ValueError):
        score = math.nan
    if not 0.0 <= score <= 1.0:
        raise InputFileError(f"{file}: a score is {str(value)[:40]}; allowed: {allowed}")
    return score
