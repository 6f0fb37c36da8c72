"""The episodes of all runs below a folder, in memory: read again where files have changed,
filtered and sorted by column.
"""

from __future__ import annotations

import csv
import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import reduce
from operator import and_
from pathlib import Path
from threading import Lock
from typing import TYPE_CHECKING, Any

from arena_core import ArenaError, InputFileError
from arena_core.commands import one_line
from arena_core.files import LIMITS
from arena_core.records import EPISODE_COLUMNS

if TYPE_CHECKING:
    from pandas import DataFrame, Series

TABLE = "episodes.csv"
RUN = "run"  # the column with the run's folder
NUMBERS = ("stage", "n_pedestrians", "episode", "seed")  # among the columns that every table has
TEXTS = tuple(name for name in EPISODE_COLUMNS if name not in NUMBERS)
FILTERS = ("preset", "robot", "world", "outcome", "task", RUN)
# where a text is looked for
SOUGHT = (RUN, "preset", "planner", "robot", "world", "task", "scenario", "outcome", "error")
RECORDED = ("records", "timing", "worlds", "report")  # folders of a run, below which no other run lies
MOST_RUNS = 20_000
MOST_ROWS = 2_000_000


@dataclass(frozen=True, slots=True)
class Query:
    """Which episodes, in which order: the values allowed of each column, words that all have to
    be found, a column to sort by.
    """

    allowed: Mapping[str, Sequence[str]] = field(default_factory=dict)
    text: str = ""
    order: str = ""
    falling: bool = False


class EpisodeTable:
    """All episodes below ``root``.

    ``troubles`` are lines about tables that cannot be read, ``gone`` the runs that have vanished.
    """

    def __init__(self, root: Path) -> None:
        self._root = root
        self._lock = Lock()
        self._parts: dict[str, tuple[tuple[int, int], DataFrame | None]] = {}
        self._whole: DataFrame | None = None
        self._sought: Series[str] | None = None
        self.troubles: dict[str, str] = {}
        self.gone: dict[str, int] = {}

    def refresh(self) -> None:
        """Read what has changed since the last time."""
        with self._lock:
            found = dict(_find_tables(self._root))
            changed = [
                name for name, stamp in found.items() if name not in self._parts or self._parts[name][0] != stamp
            ]
            lost = [name for name in self._parts if name not in found]
            for name in lost:
                part = self._parts.pop(name)[1]
                self.troubles.pop(name, None)
                if part is not None:
                    self.gone[name] = len(part)
            for name in changed:
                self.gone.pop(name, None)
                self._parts[name] = found[name], self._read_part(name)
            if changed or lost or self._whole is None:
                self._join_tables()

    def select(self, query: Query) -> DataFrame:
        """Return the episodes that a query asks for, in its order; raise ArenaError for a column that no table has."""
        whole, masks = self._condition_masks(query)
        chosen = whole[_combine_masks(masks.values())] if masks else whole
        if not query.order:
            return chosen
        _check_column(query.order, whole)
        return chosen.sort_values(query.order, ascending=not query.falling, kind="stable", na_position="last")

    def counts(self, query: Query) -> dict[str, dict[str, int]]:
        """Return for each column to filter by how many episodes each value has among those that
        all other conditions leave.
        """
        whole, masks = self._condition_masks(query)
        found = {}
        for column in FILTERS:
            others = [mask for name, mask in masks.items() if name != column]
            counted = (whole[column][_combine_masks(others)] if others else whole[column]).value_counts(sort=False)
            kept = query.allowed.get(column, ())  # ticked ones stay, so that they can be unticked
            found[column] = {
                str(value): int(count) for value, count in sorted(counted.items()) if count or str(value) in kept
            }
        return found

    def folders(self, query: Query) -> list[Path]:
        """Return the folders of the runs that have an episode which a query asks for."""
        return [self._root / name for name in sorted(self.select(query)[RUN].astype(str).unique())]

    def _condition_masks(self, query: Query) -> tuple[DataFrame, dict[str, Series[bool]]]:
        """Return all episodes, and which of them fulfil each condition of a query, by column; the text's
        stands under an empty name.
        """
        with self._lock:
            if self._whole is None or self._sought is None:
                self._join_tables()
            whole, sought = self._whole, self._sought
        assert whole is not None
        assert sought is not None
        masks = {}
        for column, values in query.allowed.items():
            _check_column(column, whole)
            masks[column] = whole[column].isin([str(value) for value in values])
        words = query.text.lower().split()
        if words:
            masks[""] = _combine_masks([sought.str.contains(word, regex=False) for word in words])
        return whole, masks

    def _read_part(self, name: str) -> DataFrame | None:
        path = self._root / name / TABLE
        try:
            part = read_episodes(path)
        except ArenaError as error:
            self.troubles[name] = str(error)
            return None
        self.troubles.pop(name, None)
        part.insert(0, RUN, name)
        return part

    def _join_tables(self) -> None:
        """Put all tables together; texts that few rows differ in become categories, which are
        quick to filter and to sort by.
        """
        import pandas

        parts = [part for _, part in self._parts.values() if part is not None and len(part)]
        whole = (
            pandas.concat(parts, ignore_index=True)
            if parts
            else pandas.DataFrame(columns=[RUN, *EPISODE_COLUMNS], dtype=str)
        )
        if len(whole) > MOST_ROWS:
            raise ArenaError(
                f"{self._root}: {len(whole)} episodes; allowed: up to {MOST_ROWS}, those "
                "of a folder below, for instance"
            )
        texts = [str(name) for name in whole.columns if not pandas.api.types.is_numeric_dtype(whole[name])]
        whole = whole.assign(**{name: whole[name].fillna("").astype("category").cat.as_ordered() for name in texts})
        self._whole, self._sought = whole, _searched_text(whole)


def _check_column(column: str, whole: DataFrame) -> None:
    if column not in whole.columns:
        raise ArenaError(f"there is no column {one_line(column, 60)}; allowed: {', '.join(map(str, whole.columns))}")


def _combine_masks(masks: Iterable[Series[bool]]) -> Series[bool]:
    return reduce(and_, masks)


def read_episodes(path: Path) -> DataFrame:
    """Return a run's table, texts as they are and numbers as numbers; raise
    InputFileError (one line) for anything else.
    """
    import pandas

    allowed = "a table that `arena run` wrote"
    try:
        if path.stat().st_size > LIMITS.table_bytes:
            raise InputFileError(f"{path}: is larger than {LIMITS.table_bytes} bytes; allowed: up to that")
        with path.open(encoding="utf-8", newline="") as file:
            columns = next(csv.reader(file), [])
        numbers = {name: [""] for name in columns if name not in TEXTS}
        texts: Any = dict.fromkeys(TEXTS, str)
        read = pandas.read_csv(
            path, dtype=texts, keep_default_na=False, na_values=numbers, index_col=False, encoding="utf-8"
        )
    except (OSError, ValueError, csv.Error, OverflowError) as error:  # pandas' own errors are ValueErrors
        reason = getattr(error, "strerror", None) or error
        raise InputFileError(f"{path}: cannot be read ({one_line(str(reason), 120)}); allowed: {allowed}") from None
    lacking = [name for name in EPISODE_COLUMNS if name not in columns]
    if lacking:
        raise InputFileError(f"{path}: lacks the column {lacking[0]}; allowed: {allowed}")
    return _parse_numbers(read)


def _parse_numbers(read: DataFrame) -> DataFrame:
    """Return a table in which the columns that every table has and that are numbers
    are numbers, whatever stands there.
    """
    import pandas

    return read.assign(**{name: pandas.to_numeric(read[name], errors="coerce") for name in NUMBERS})


def _searched_text(whole: DataFrame) -> Series[str]:
    """Return for each row the text in which words are looked for."""
    joined = whole[SOUGHT[0]].astype(str).astype(object)
    for name in SOUGHT[1:]:
        joined = joined + " " + whole[name].astype(str).astype(object)
    return joined.str.lower()


def _find_tables(root: Path) -> Iterator[tuple[str, tuple[int, int]]]:
    """Yield the folder of every run below ``root``, relative, with what says whether its table has changed."""
    count = 0
    for folder, folders, names in os.walk(root):
        is_run = TABLE in names
        folders[:] = sorted(name for name in folders if not name.startswith(".") and not (is_run and name in RECORDED))
        if is_run and not (path := Path(folder, TABLE)).is_symlink():
            try:
                status = path.stat()
            except OSError:  # it vanishes as one looks
                continue
            count += 1
            if count > MOST_RUNS:
                raise ArenaError(f"{root}: more than {MOST_RUNS} runs; allowed: a folder below it")
            yield Path(folder).relative_to(root).as_posix(), (status.st_mtime_ns, status.st_size)
