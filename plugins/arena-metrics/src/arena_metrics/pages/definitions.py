"""What the metrics of a page mean, for their names to lead to."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from arena_metrics.pooling.runs import Column
from arena_metrics.pooling.summary import Summary
from arena_metrics.tables.tables import unit_text

PAGES = {  # of the documentation, by pack or kind of findings
    **dict.fromkeys(("", "barn", "paper_legacy", "paper_published"), "metrics"),
    **dict.fromkeys(("social", "cost"), "social_metrics"),
    **dict.fromkeys(("reference", "explain"), "clairvoyant"),
}


@dataclass(frozen=True, slots=True)
class Definition:
    """One metric: its ``place`` on the page, name, unit, what a reader wishes, what it is, and its page of the
    documentation.
    """

    place: str
    name: str
    unit: str
    better: str
    text: str
    page: str


def definitions_of(summary: Summary) -> Mapping[str, Definition]:
    """Return the definitions of all metrics of a summary by their columns."""
    columns: Sequence[Column] = [*summary.columns, *summary.texts]
    return {
        column.name: Definition(
            f"metric-{number}",
            column.name,
            unit_text(column.unit),
            "" if column.better == "neither" else column.better,
            column.description,
            PAGES.get(column.pack, ""),
        )
        for number, column in enumerate(columns)
    }
