"""Which code drove the cells shown, and where cells that are compared were driven by different
states of the same package.
"""

from __future__ import annotations

from collections.abc import Mapping

from arena_metrics.pooling.cells import Cell, Cells


def other_code(cells: Cells) -> list[str]:
    """Return a sentence for each package of which cells used different states; one cell's own
    planner is no such package.
    """
    drove: dict[str, dict[str, list[str]]] = {}
    for cell in cells.cells:
        for package, content in code_parts(cell).items():
            drove.setdefault(package, {}).setdefault(content, []).append(cells.name(cell))
    told = {package: found for package, found in drove.items() if len(found) > 1}
    return [f"Driven with different code: {package} {_codes_text(found)}." for package, found in told.items()]


def code_parts(cell: Cell) -> Mapping[str, str]:
    """Return the packages that drove a cell, as its run's provenance has them; nothing where that is of
    other code than the cell.
    """
    for episode in cell.episodes:
        code = episode.run.provenance.get("code") or {}
        if code.get("digest") == cell.code:
            return dict(code.get("parts") or {})
    return {}


def _codes_text(found: Mapping[str, list[str]]) -> str:
    return "; ".join(
        f"{content} ({names[0]}{f' and {len(names) - 1} more' if len(names) > 1 else ''})"
        for content, names in found.items()
    )
