"""CSV tables: one writer for all, so that each cell is read back as one, and no spreadsheet
takes a text for a formula.
"""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Iterable
from typing import Any

# what a text begins with that spreadsheets run (OWASP, "CSV Injection"); the last four are the full-width forms of the
# first
FORMULA = ("=", "+", "-", "@", "\t", "\r", "\uff1d", "\uff0b", "\uff0d", "\uff20")
# figures with their intervals: without letters nothing is called
FIGURES = re.compile(r"[-+][\d.,eE%() –…+-]*|[-+](inf|nan)")
BREAKS = re.compile("[\0-\x1f\x7f-\x9f\u2028\u2029]")  # control characters, and what else ends a line for some reader


def escape_formula(value: Any) -> Any:
    """Return a cell's value; a text that a spreadsheet would run, and that is no figure, begins
    with an apostrophe instead.
    """
    if not isinstance(value, str) or not value.startswith(FORMULA):
        return value
    return value if FIGURES.fullmatch(value) else f"'{value}"


def csv_text(rows: Iterable[Iterable[Any]]) -> str:
    r"""Return rows as CSV, the names of the columns among them; None and NaN are empty cells, control
    characters escapes such as ``\r``.
    """
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows([_format_cell(value) for value in row] for row in rows)
    return text.getvalue()


def _format_cell(value: Any) -> Any:
    if isinstance(value, float):
        return "" if value != value else repr(float(value))
    if not isinstance(value, str):
        return value
    return BREAKS.sub(lambda found: found.group().encode("unicode_escape").decode(), str(escape_formula(value)))
