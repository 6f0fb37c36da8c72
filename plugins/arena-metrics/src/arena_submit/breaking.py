"""Where planners break, from the scenarios of a standing benchmark that differ in how many people there are."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from arena_ladder.breaking import Drive
from arena_ladder.plan import Plan
from arena_ladder.results import SHARES, make_curve
from arena_metrics.pooling.cells import Cell
from arena_metrics.pooling.runs import Row
from arena_submit.cards import ScoreCard, scenario_of
from arena_submit.markdown import markdown_table

DENSITY = "density"  # the task whose scenarios are rungs
TITLE = "Where planners break"
EXPLAINED = """\
People per 100 m² of free ground at which a planner's success falls to .9, with its 95 % interval
([ladder](../ladder.md)): one fit for each planner and robot, resampled by map.
"""


def breaking_lines(cards: Sequence[ScoreCard]) -> list[str]:
    """Return a section with each planner's breaking densities on each robot; nothing where no scenario is a rung."""
    rungs = sorted({_density(cell) for card in cards for cell in card.cells if _is_rung(cell)})
    if len(rungs) < 2:
        return []
    robots = {robot for card in cards for robot in card.parts("robot")}
    found = [(card, robot, _rungs(card, robot)) for card in cards for robot in sorted(robots)]
    names = sorted({name for _, _, cells in found for name in _names(cells)})
    rows = [
        [card.planner, robot, *_breaking_texts(cells, names, rungs)] for card, robot, cells in found if len(cells) > 1
    ]
    return ["", f"## {TITLE}", "", EXPLAINED, *markdown_table(["planner", "robot", *names], rows)]


def _rungs(card: ScoreCard, robot: str) -> list[Cell]:
    return [cell for cell in card.parts("robot").get(robot, []) if _is_rung(cell)]


def _is_rung(cell: Cell) -> bool:
    return bool(cell.config["task"].get("name") == DENSITY)


def _density(cell: Cell) -> float:
    return float(cell.config["task"]["density"])


def _situation(cell: Cell) -> str:
    """Return WORLD_CROWD of a scenario WORLD_CROWD_DENSITY, WORLD of one without people."""
    return scenario_of(cell).rpartition("/")[2].rpartition("_")[0]


def _names(cells: Sequence[Cell]) -> list[str]:
    """Return the situations with people among some rungs."""
    return sorted({_situation(cell) for cell in cells if _density(cell) > 0.0})


def _breaking_texts(cells: Sequence[Cell], names: Sequence[str], rungs: Sequence[float]) -> list[str]:
    """Return the breaking density of each situation, as a text."""
    own = _names(cells)
    plan = Plan(dict.fromkeys(own, ()), tuple(rungs), (), 0, 0, math.nan, 0)
    curve = make_curve(plan, list(_drives(cells, own, rungs)))
    texts = dict(zip(own, (one.text() for one in curve.breaking[SHARES[0]]), strict=True))
    return [texts.get(name, "–") for name in names]


def _drives(cells: Sequence[Cell], names: Sequence[str], rungs: Sequence[float]) -> Iterator[Drive]:
    """Yield the episodes of some cells; those without people are of all crowds of their world."""
    for cell in cells:
        density = _density(cell)
        of = [_situation(cell)] if density > 0.0 else [name for name in names if name.startswith(_situation(cell))]
        for episode in cell.episodes:
            for name in of:
                yield _drive_of(episode.row, name, rungs.index(density), density)


def _drive_of(row: Row, name: str, rung: int, density: float) -> Drive:
    won, strict = (row.get(column) == 1.0 for column in ("success", "strict_success"))
    return Drive(name, rung, density, (str(row["world"]), int(row["seed"]), int(row["episode"])), won, strict)
