"""What runs left on disk: their rows, pooled and without repeats, their provenance, and what their columns mean."""

from __future__ import annotations

import math
from collections.abc import Callable, Container, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from arena_core import ArenaError, InputFileError, Metric
from arena_core.files import option_files, read_json, read_table
from arena_core.hosting import compose, load_registry
from arena_core.records import (
    EPISODE_COLUMNS,
    TEAM_TEXTS,
    TEXT,
    Findings,
    build_metrics,
    find_runs,
    metric_column,
    read_findings,
    record_path,
)

if TYPE_CHECKING:
    from arena_core.statistics import Kind

Bounds = tuple[float, float]
UNBOUNDED = (-math.inf, math.inf)
NO_FIGURES = (*EPISODE_COLUMNS, *TEAM_TEXTS)
LATER = "code"  # a column that older tables lack
OWN_PACK = "si"  # in which a bare column is looked for, even if no run was made with it
Row = Mapping[str, Any]


@dataclass(frozen=True, slots=True, eq=False)
class Run:
    """One run's folder: its rows of episodes.csv (metrics as floats, NaN where empty, or as
    texts) and of findings beside its records, what these mean, and its provenance.
    """

    folder: Path
    rows: Sequence[Row]
    provenance: Mapping[str, Any]
    found: Sequence[Column] = ()


@dataclass(frozen=True, slots=True)
class Column:
    """One metric's column: its name in episodes.csv, its pack (empty: bare), and what it means, unknown
    where that is not installed.
    """

    name: str
    pack: str
    unit: str
    better: str
    description: str
    path_metric: bool
    bounds: Bounds = UNBOUNDED

    @property
    def difference_bounds(self) -> Bounds:
        """Return between what the difference of two figures lies."""
        width = self.bounds[1] - self.bounds[0]
        return -width, width

    @property
    def is_proportion(self) -> bool:
        """Return whether every value is 0 or 1, so that the mean is a proportion."""
        return self.unit == "0/1"

    @property
    def text(self) -> bool:
        """Return whether every value is a text."""
        return self.unit == TEXT

    def kind(self, values: Iterable[float]) -> Kind:
        """Return what the values of all cells are: proportions, numbers of events, or figures,
        such as means of several of either.
        """
        whole = all(value >= 0.0 and value == int(value) for value in values if math.isfinite(value))
        if self.is_proportion and whole:
            return "proportion"
        return "count" if self.unit == "-" and whole else "figure"

    @property
    def title(self) -> str:
        """Return the name for a reader."""
        return self.name.rpartition(".")[2].replace("_", " ")


def read_runs(directories: Iterable[Path]) -> list[Run]:
    """Read every run at or below the given folders once; raise InputFileError when
    there is none or a table is broken.
    """
    folders = {folder.resolve(): folder for directory in directories for folder in find_runs(directory)}
    written = [_read_run(folder) for folder in folders.values()]
    texts = {column.name for column in metric_columns(written) if column.text}
    return [
        replace(run, rows=[_parse_row(run.folder, n, row, texts) for n, row in enumerate(run.rows, start=2)])
        for run in written
    ]


def _read_run(folder: Path) -> Run:
    """Return a run as it is written, all texts, its rows with what was found out about their episodes."""
    kinds = read_findings(folder)
    columns = [
        Column(f"{kind.kind}.{one.name}", kind.kind, one.unit, one.better, one.description, False, one.bounds)
        for kind in kinds
        for one in kind.columns
    ]
    rows = [
        {**row, **dict.fromkeys((column.name for column in columns), ""), **_found_about(row["episode"], kinds)}
        for row in _read_rows(folder / "episodes.csv")
    ]
    return Run(folder, rows, _read_provenance(folder), columns)


def _found_about(episode: str, kinds: Sequence[Findings]) -> dict[str, str]:
    number = int(episode) if episode.isdecimal() else -1
    return {f"{kind.kind}.{name}": str(value) for kind in kinds for name, value in kind.rows.get(number, {}).items()}


def _read_rows(path: Path) -> list[Row]:
    """Read an episodes.csv as it is written, all texts; raise InputFileError (file, what is allowed)."""
    allowed = "a table that `arena run` or `arena evaluate` wrote"
    columns, rows = read_table(path, allowed)
    missing = [name for name in EPISODE_COLUMNS if name not in columns and name != LATER]
    if missing:
        raise InputFileError(f"{path}: lacks the column {missing[0]}; allowed: {allowed}")
    return list(rows)


def _parse_row(folder: Path, line: int, written: Row, texts: Container[str]) -> Row:
    """Return a row with its numbers as numbers; ``texts`` are the metrics that are none."""
    try:
        figures = [key for key in written if key not in NO_FIGURES and key not in texts]
        metrics = {key: float(written[key]) if written[key] else math.nan for key in figures}
        numbers = {key: int(written[key]) for key in ("episode", "seed")}
        numbers |= {key: int(written[key]) if written[key] else -1 for key in ("n_pedestrians", "stage")}
    except ValueError as error:
        raise InputFileError(
            f"{folder / 'episodes.csv'}: line {line}: {error}; allowed: numbers in all metrics, episode, seed, "
            "stage and n_pedestrians"
        ) from None
    return {**written, **metrics, **numbers}


def _read_provenance(folder: Path) -> Mapping[str, Any]:
    path = folder / "provenance.json"
    if not path.exists():
        return {}
    provenance = read_json(path, "JSON that `arena run` wrote")
    for where, mapping in {"it": provenance, **_mapping_parts(provenance)}.items():
        if not isinstance(mapping, dict):
            raise InputFileError(f"{path}: {where} holds no mapping; allowed: JSON that `arena run` wrote")
    return provenance  # type: ignore[no-any-return]


def _mapping_parts(provenance: Any) -> dict[str, Any]:
    """Return the parts of a provenance that must be mappings, as far as they are there."""
    whole = provenance if isinstance(provenance, dict) else {}
    config = whole.get("config", {})
    inner = (
        {f"config.{key}": config.get(key) or {} for key in ("choices", "metrics")} if isinstance(config, dict) else {}
    )
    return {"config": config, "versions": whole.get("versions", {}), "code": whole.get("code") or {}, **inner}


@dataclass(frozen=True, slots=True, eq=False)
class Episode:
    """One row of a run, with the run that it came from."""

    row: Row
    run: Run

    @property
    def record_path(self) -> Path:
        """Return where the record is, if the episode got so far as to have one."""
        return record_path(self.run.folder, self.row["episode"])


def pool_episodes(runs: Iterable[Run]) -> tuple[list[Episode], int]:
    """Return the episodes of all runs and how many were left out as repeats (same cell, code,
    seed and number as another).
    """
    episodes: dict[tuple[Any, ...], Episode] = {}
    total = 0
    for run in runs:
        for row in run.rows:
            episodes[row["config_hash"], row.get("code", ""), row["seed"], row["episode"]] = Episode(row, run)
            total += 1
    return list(episodes.values()), total - len(episodes)


def metric_columns(runs: Sequence[Run]) -> list[Column]:
    """Return every metric's column in the order of the tables: bare ones first."""
    names = dict.fromkeys(name for run in runs for row in run.rows[:1] for name in row if name not in NO_FIGURES)
    packs = {name: name.rpartition(".")[0] for name in names}
    chosen = dict.fromkeys(name for run in runs for name in run.provenance.get("config", {}).get("metrics") or {})
    found = {column.name: column for run in runs for column in run.found}
    asked = dict.fromkeys([*chosen, *(pack for name, pack in packs.items() if pack and name not in found), OWN_PACK])
    known = _described_columns(runs, list(asked)) | found
    columns = [known[name] if name in known else _unknown_column(name, pack, runs) for name, pack in packs.items()]
    return sorted(columns, key=lambda column: column.pack)


def _unknown_column(name: str, pack: str, runs: Sequence[Run]) -> Column:
    """Return the column of a pack that is not installed here: one of texts where no value is a number."""
    values = [row[name] for run in runs for row in run.rows if row.get(name, "") != ""]
    return Column(name, pack, TEXT if values and not any(map(_is_number, values)) else "", "neither", "", False)


def _is_number(value: Any) -> bool:
    try:
        float(value)
    except ValueError:
        return False
    return True


def columns_of(packs: Mapping[str, Sequence[Metric]]) -> list[Column]:
    """Return the columns of metric packs as ``build_metrics`` returns them."""
    return [
        Column(metric_column(pack, m), pack, m.unit, m.better, m.description, m.path_metric, m.bounds)
        for pack, metrics in packs.items()
        for m in metrics
    ]


def _described_columns(runs: Sequence[Run], packs: Sequence[str]) -> dict[str, Column]:
    """Return what these packs say about their columns; one that is not installed here is left out."""
    registry = load_registry()
    columns: dict[str, Column] = {}
    for pack in packs:
        for node in _pack_configs(runs, pack):
            try:
                columns |= {c.name: c for c in columns_of(build_metrics({"metrics": {pack: node()}}, registry))}
                break
            except ArenaError:
                # a run of an older version lacks keys; without any, its figures are shown without unit and description
                continue
    return columns


def _pack_configs(runs: Sequence[Run], pack: str) -> Iterator[Callable[[], Any]]:
    """Yield ways to a pack's configuration: a run's own, then the preset, where the pack was evaluated
    afterwards or has new keys.
    """
    for run in runs:
        metrics = run.provenance.get("config", {}).get("metrics") or {}
        if pack in metrics:
            yield partial(metrics.__getitem__, pack)
            break
    if pack in option_files("metrics", load_registry().manager):
        yield partial(_pack_preset, pack)


def _pack_preset(pack: str) -> Any:
    from omegaconf import OmegaConf

    return OmegaConf.to_container(compose([f"metrics=[{pack}]"], "component").metrics[pack], resolve=True)
