"""The limit of a standing benchmark: certificates beside runs of it, as a card that competes with no one."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from arena_core import InputFileError
from arena_core.hosting import Registry
from arena_metrics.pooling.cells import cells_of
from arena_metrics.pooling.certificates import certificate_episodes
from arena_metrics.pooling.runs import Episode, read_runs
from arena_submit.cards import ScoreCard
from arena_submit.packing import PackedRun
from arena_submit.standing import Condition, Standing, run_condition, run_fault

ALLOWED = "finished runs with what `arena reference` found beside their records"


def read_limit(folder: Path, wanted: Standing, registry: Registry) -> ScoreCard:
    """Return the card of the certificates beside runs at or below a folder, one run for each condition.

    Raises InputFileError where a run is not of the benchmark, or no run has certificates.
    """
    found: dict[Condition, list[Episode]] = {}
    for condition, episodes in _certified(folder, wanted, registry):
        found.setdefault(condition, episodes)
    if not found:
        raise InputFileError(f"{folder}: holds no certificates; allowed: {ALLOWED}")
    cells = cells_of([episode for episodes in found.values() for episode in episodes]).cells
    codes = sorted({cell.code for cell in cells})
    return ScoreCard(cells[0].factors["planner"], ", ".join(codes), "", cells)


def _certified(folder: Path, wanted: Standing, registry: Registry) -> Iterator[tuple[Condition, list[Episode]]]:
    """Yield the condition of each run that has certificates, and those."""
    for run in read_runs([folder]):
        if "config" not in run.provenance:
            raise InputFileError(f"{run.folder}: lacks provenance.json; allowed: {ALLOWED}")
        told = PackedRun(str(run.folder), run.rows, run.provenance, ())
        if fault := run_fault(told, wanted, registry):
            raise InputFileError(
                f"{run.folder}: {fault}; allowed: runs of experiment={wanted.experiment} as it is here"
            )
        if episodes := certificate_episodes([run]):
            yield run_condition(told), episodes
