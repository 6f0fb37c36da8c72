"""What planners cost the people, side by side, as findings and the pack ``social`` have it."""

from __future__ import annotations

from arena_metrics.pooling.summary import Summary
from arena_metrics.tables.tables import Table, column_title, decimal_places, estimate_text

DELAY, FLOOR = "cost.people_delay", "cost.people_delay_floor"
SHOWN = (  # where they are known
    *(DELAY, FLOOR, "cost.people_delay_worst", "cost.people_detour", "cost.people_displacement", "cost.people_stops"),
    *("social.people_touched", "social.near_misses", "social.intimate_share", "social.proxemic_intrusion"),
    *("social.personal_space_cost", "social.group_intrusion", "social.yield_score", "social.reversals"),
)


def people_table(summary: Summary) -> Table | None:
    """Return a line for each cell, mean and interval of each figure; None where none of them is known."""
    by_name = {column.name: column for column in summary.columns}
    columns = [by_name[name] for name in SHOWN if name in by_name]
    if not columns:
        return None
    found = [[summary.get(cell, column) for column in columns] for cell in summary.cells.cells]
    places = [decimal_places(row[i] for row in found) for i in range(len(columns))]
    rows = [
        [summary.cells.name(cell), *(estimate_text(e, c, p) for e, c, p in zip(row, columns, places, strict=True))]
        for cell, row in zip(summary.cells.cells, found, strict=True)
    ]
    titles = {column_title(column): column.name for column in columns}
    return Table("What it cost the people: mean [95 % interval] over all episodes", ["cell", *titles], rows, titles)
