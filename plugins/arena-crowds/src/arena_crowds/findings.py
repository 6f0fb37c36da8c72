"""What an experiment found: a table and a picture."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True, slots=True, eq=False)
class Findings:
    """Rows with the same columns, and ``draw(figure)``, which fills a matplotlib figure of ``size`` (inches)."""

    rows: Sequence[Mapping[str, Any]]
    draw: Callable[[Any], None]
    size: tuple[float, float] = (7.0, 4.2)


def aligned(rows: Sequence[Mapping[str, Any]]) -> str:
    """Return rows as aligned text."""
    cells = [list(rows[0]), *([value if isinstance(value, str) else f"{value:.4g}" for value in row.values()] for row in rows)]
    widths = [max(len(row[i]) for row in cells) for i in range(len(cells[0]))]
    return "\n".join("  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip() for row in cells)
