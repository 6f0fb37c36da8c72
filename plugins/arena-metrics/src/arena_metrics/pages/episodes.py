"""The page's table of episodes: what identifies each, how it ended, and the headline's metrics."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from arena_metrics.pages.headline import factor_values, outcome_text
from arena_metrics.pages.replays import episode_anchor
from arena_metrics.pooling.cells import Cell, Cells
from arena_metrics.pooling.drives import number_episodes
from arena_metrics.pooling.outcomes import describe_outcome
from arena_metrics.pooling.runs import Column, Episode
from arena_metrics.pooling.summary import Summary
from arena_metrics.tables.tables import headline_columns

EPISODES = 600  # rows of the table
# beside the headline's metrics of an episode
BESIDE = ("collisions_people", "collisions_people_caused", "impact_speed", "goal_error")


@dataclass(frozen=True, slots=True)
class EpisodeReference:
    """An episode's number, the place of its row in the page, how it ended, and whether it was no success."""

    label: str
    place: str
    verdict: str
    failed: bool


@dataclass(frozen=True, slots=True, eq=False)
class EpisodeRow:
    """One episode of the table: its cell's name, its row of episodes.csv, its metrics as texts, and by what
    it can be chosen.
    """

    cell: str
    row: Mapping[str, object]
    reference: EpisodeReference
    facts: Mapping[str, str]
    values: Sequence[str]


@dataclass(frozen=True, slots=True, eq=False)
class EpisodeTable:
    """The table of episodes, and how many more there are."""

    columns: Sequence[Column]
    rows: Sequence[EpisodeRow]
    left_out: int


def episode_table(summary: Summary) -> EpisodeTable:
    """Return the table of a summary's episodes; where they are too many, those that were no success come first."""
    cells = summary.cells
    columns = [column for column, _ in headline_columns(summary)] + [c for c in summary.columns if c.name in BESIDE]
    columns += summary.texts
    found = [(cell, episode, label) for cell in cells.cells for episode, label in number_episodes(cells, cell)]
    if len(found) > EPISODES:  # those that were no success are looked for
        found.sort(key=lambda one: one[1].row.get("success") == 1.0)
    rows = [
        EpisodeRow(
            cells.name(cell),
            episode.row,
            _episode_reference(cell, episode, label),
            {**factor_values(cells, cell), "outcome": outcome_text(episode.row)},
            [_format_value(episode, column) for column in columns],
        )
        for cell, episode, label in found[:EPISODES]
    ]
    return EpisodeTable(columns, rows, len(found) - len(rows))


def episode_references(cells: Cells, cell: Cell) -> list[EpisodeReference]:
    """Return the episodes of a cell, by the numbers that its picture shows."""
    return [_episode_reference(cell, episode, label) for episode, label in number_episodes(cells, cell)]


def _episode_reference(cell: Cell, episode: Episode, label: str) -> EpisodeReference:
    row = episode.row
    return EpisodeReference(label, episode_anchor(cell, episode), describe_outcome(row), row.get("success") != 1.0)


def _format_value(episode: Episode, column: Column) -> str:
    """Return what the table of episodes shows of a metric: words for texts and for
    what was so or not, else a number.
    """
    value = episode.row.get(column.name, float("nan"))
    if isinstance(value, str):
        return value or "–"
    if column.is_proportion and value in (0.0, 1.0):
        return "yes" if value else "no"
    return "–" if value != value else f"{value:.4g}"
