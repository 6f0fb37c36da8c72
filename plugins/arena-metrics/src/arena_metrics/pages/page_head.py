"""What stands at the head of a report's page: what was compared, how much of it, and what to beware of."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from arena_metrics.pooling.cells import VARIANT, Cells
from arena_metrics.pooling.codes import other_code
from arena_metrics.pooling.runs import Episode, Run

TITLE = ("planner", "robot", "world", "people")  # what the title of a single cell says


@dataclass(frozen=True, slots=True, eq=False)
class PageHead:
    """The page's title, the factors common to all cells, counts, and warnings; ``failed`` ended with an error."""

    title: str
    common: Mapping[str, str]
    counts: Mapping[str, int]
    seeds: str
    other_code: Sequence[str]
    untuned: Sequence[str]
    privileged: Sequence[str]
    failed: Sequence[Episode]


def page_head(cells: Cells, runs: Sequence[Run], repeats: int) -> PageHead:
    """Return the head of the page of these cells; ``repeats`` rows were left out."""
    episodes = [episode for cell in cells.cells for episode in cell.episodes]
    return PageHead(
        _page_title(cells),
        {k: v for k, v in cells.common.items() if len(cells.cells) > 1 or k not in TITLE},
        {"runs": len(runs), "cells": len(cells.cells), "episodes": len(episodes), "repeats": repeats},
        _format_ranges(sorted({episode.row["seed"] for episode in episodes})),
        other_code(cells),
        sorted({note for run in runs for note in run.provenance.get("untuned") or []}),
        sorted({name for run in runs for name in run.provenance.get("privileged") or []}),
        [episode for episode in episodes if episode.row["outcome"] == "error"],
    )


def _page_title(cells: Cells) -> str:
    """Return what was compared, or what the one cell is."""
    if len(cells.cells) == 1:
        factors = cells.cells[0].factors
        parts = [factors[f] for f in TITLE if f != "people"]
        return " · ".join([*parts, f"{factors['people']} people"] if factors["people"] else parts)
    nouns = {"planner": "planners", "robot": "robots", "world": "worlds", "people": "crowd sizes", VARIANT: "variants"}
    counts = {f: len({cell.factors[f] for cell in cells.cells}) for f in cells.varying if f in nouns}
    single = [cells.common[f] for f in ("planner", "robot", "world") if f in cells.common]
    compared = " × ".join(f"{n} {nouns[f]}" for f, n in counts.items()) or f"{len(cells.cells)} cells"
    return " · ".join([compared, *single])


def _format_ranges(numbers: Sequence[int]) -> str:
    """Return whole numbers in short, runs of them as a range."""
    parts: list[list[int]] = []
    for number in numbers:
        if parts and number == parts[-1][-1] + 1:
            parts[-1].append(number)
        else:
            parts.append([number])
    return ", ".join(str(p[0]) if len(p) == 1 else f"{p[0]}–{p[-1]}" for p in parts)
