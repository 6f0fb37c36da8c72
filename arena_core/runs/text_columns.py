"""Rows of text in aligned columns."""

from __future__ import annotations

from collections.abc import Collection, Sequence


def align_columns(rows: Sequence[Sequence[str]], right: Collection[int] = (), widest: int = 1000) -> list[str]:
    """Return a line for each row, cells below each other as wide as the widest, those of the columns ``right`` at their
    right ends.

    A row of fewer cells than the first counts for no width, nor does a cell of more than ``widest`` characters.
    """
    full = [row for row in rows if len(row) == len(rows[0])]
    widths = [
        max((len(text) for text in column if len(text) <= widest), default=0) for column in zip(*full, strict=True)
    ]
    return [
        "  ".join(_pad_cell(text, widths[k], right=k in right) for k, text in enumerate(row)).rstrip() for row in rows
    ]


def _pad_cell(text: str, width: int, *, right: bool) -> str:
    return text.rjust(width) if right else text.ljust(width)
