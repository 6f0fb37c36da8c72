"""Cells of CSV tables that no spreadsheet takes for formulas."""

from __future__ import annotations

import re
from typing import Any

FORMULA = ("=", "+", "-", "@", "\t", "\r")  # what a text begins with that spreadsheets run (OWASP, "CSV Injection")
FIGURES = re.compile(r"[-+][\d.,eE%() –…+-]*|[-+](inf|nan)")  # figures with their intervals: without letters nothing is called


def harmless(value: Any) -> Any:
    """Return a cell's value; a text that a spreadsheet would run, and that is no figure, begins with an apostrophe instead."""
    if not isinstance(value, str) or not value.startswith(FORMULA):
        return value
    return value if FIGURES.fullmatch(value) else f"'{value}"
