"""Why episodes failed: how many of each cell by each cause, as `arena explain` found it out."""

from __future__ import annotations

from collections import Counter

from arena_metrics.pooling.cells import Cell, Cells
from arena_metrics.pooling.runs import Row
from arena_metrics.tables.tables import Table

CAUSE, LEAD = "explain.cause", "explain.lead"  # columns of findings
FINE, OPEN = "strict success", "not explained"


def causes_of(cell: Cell) -> Counter[str] | None:
    """Return how many episodes of a cell failed by each cause, with those that were strict successes, and those that
    are not explained yet; None where no episode was ever explained.
    """
    if not any(CAUSE in episode.row for episode in cell.episodes):
        return None
    return Counter(_cause(episode.row) for episode in cell.episodes)


def _cause(row: Row) -> str:
    if CAUSE not in row or _is_open(row):
        return OPEN
    return str(row[CAUSE]) or FINE


def _is_open(row: Row) -> bool:
    """Return whether an episode failed and no one has said why."""
    return not row.get(CAUSE) and row.get("strict_success") == 0.0


def known_causes(cells: Cells) -> list[str]:
    """Return the causes of all cells, the most frequent first."""
    found: Counter[str] = Counter()
    for cell in cells.cells:
        found += causes_of(cell) or Counter()
    return [cause for cause, _ in found.most_common() if cause not in (FINE, OPEN)]


def cause_table(cells: Cells) -> Table | None:
    """Return a line for each cell that was explained, a column for each cause; None where none was."""
    counted = [(cell, counts) for cell in cells.cells if (counts := causes_of(cell)) is not None]
    if not counted:
        return None
    open_ones = [OPEN] * any(counts[OPEN] for _, counts in counted)
    columns = [*known_causes(cells), FINE, *open_ones]
    rows = [
        [cells.name(cell), str(len(cell.episodes)), *(str(counts[name]) for name in columns), _lead_text(cell)]
        for cell, counts in counted
    ]
    return Table("Why episodes failed: how many by each cause", ["cell", "n", *columns, "avoidable until [s]"], rows)


def _lead_text(cell: Cell) -> str:
    """Return until how long before the contact that decided, in the median, a failure could be avoided."""
    leads = sorted(lead for lead in cell.values(LEAD) if lead == lead)
    return f"{leads[len(leads) // 2]:.1f} before (n={len(leads)})" if leads else "–"


def failures_to_explain(cells: Cells) -> int:
    """Return how many failures are not explained."""
    return sum(_is_open(episode.row) for cell in cells.cells for episode in cell.episodes)
