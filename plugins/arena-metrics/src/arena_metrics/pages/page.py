"""The report's page: one HTML file with everything inside it."""

from __future__ import annotations

from importlib.resources import files

from arena_metrics.pages.contents import CELLS_IN_FULL, ReportContent
from arena_metrics.pages.tuned import HEAD

PICTURES = 6  # pictures of cells before the rest is folded away


def render(content: ReportContent) -> str:
    """Return the page of a report."""
    from jinja2 import Environment, StrictUndefined

    environment = Environment(autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    return environment.from_string(_template("report.html.j2")).render(
        report=content,
        script=_template("report.js"),
        style=_template("report.css"),
        cells_in_full=CELLS_IN_FULL,
        tuned_head=HEAD,
        pictures_unfolded=PICTURES,
    )


def _template(name: str) -> str:
    return (files("arena_metrics") / "templates" / name).read_text(encoding="utf-8")
