"""What has been driven in a tuning, line by line on disk: what is finished is never driven again."""

from __future__ import annotations

import json
from collections.abc import Mapping
from hashlib import blake2b
from pathlib import Path
from typing import Any

from arena_core.files import is_file
from arena_core.hosting import RunFolderError
from arena_tuning.problems import Problem

NAME = "episodes.jsonl"
Values = Mapping[str, Any]  # of what is searched, by key


class Journal:
    """The rows of finished episodes, by what was driven and on which problem; a line that was cut off is no row."""

    def __init__(self, folder: Path) -> None:
        self._path = folder / NAME
        self._rows: dict[str, dict[str, Any]] = dict(self._read())

    def row(self, values: Values, problem: Problem) -> dict[str, Any] | None:
        """Return the row of an episode, None where it has not been driven."""
        return self._rows.get(_key(values, problem))

    def add(self, values: Values, problem: Problem, row: Mapping[str, Any]) -> None:
        """Keep the row of a finished episode; raise RunFolderError where it cannot be written."""
        kept = {name: value for name, value in row.items() if isinstance(value, (str, int, float)) and value == value}
        key = _key(values, problem)
        line = json.dumps({"key": key, "values": dict(values), "problem": _facts(problem), "row": kept})
        try:
            with self._path.open("a", encoding="utf-8") as file:
                file.write(f"{line}\n")
        except OSError as error:
            raise RunFolderError(f"cannot write {self._path}: {error.strerror or error}") from error
        self._rows[key] = kept

    def count(self, name: str) -> int:
        """Return of how many episodes a column is known."""
        return sum(name in row for row in self._rows.values())

    def __len__(self) -> int:
        return len(self._rows)

    def _read(self) -> list[tuple[str, dict[str, Any]]]:
        if not is_file(self._path):
            return []
        text = self._path.read_text(encoding="utf-8", errors="replace")
        whole = text[: text.rfind("\n") + 1]
        if whole != text:  # the process was killed within a line
            self._path.write_text(whole, encoding="utf-8")
        try:
            found = [json.loads(line) for line in whole.splitlines()]
            return [(str(one["key"]), dict(one["row"])) for one in found]
        except (ValueError, KeyError, TypeError) as error:
            raise RunFolderError(f"{self._path} is damaged ({error}); allowed: what `arena tune` wrote") from None


def _key(values: Values, problem: Problem) -> str:
    text = json.dumps([dict(values), _facts(problem)], sort_keys=True)
    return blake2b(text.encode(), digest_size=8).hexdigest()


def _facts(problem: Problem) -> list[Any]:
    return [problem.purpose, problem.cell, problem.number]
