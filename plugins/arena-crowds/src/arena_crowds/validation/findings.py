"""What an experiment found: a table and a picture."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from arena_core.commands import align_columns


@dataclass(frozen=True, slots=True, eq=False)
class Findings:
    """Rows with the same columns, and ``draw(figure)``, which fills a matplotlib figure of ``size`` (inches)."""

    rows: Sequence[Mapping[str, Any]]
    draw: Callable[[Any], None]
    size: tuple[float, float] = (7.0, 4.2)


def table_lines(rows: Sequence[Mapping[str, Any]]) -> str:
    """Return rows as a table of text, numbers with four digits."""
    cells = [[value if isinstance(value, str) else f"{value:.4g}" for value in row.values()] for row in rows]
    return "\n".join(align_columns([list(rows[0]), *cells]))
