"""Score cards: what a planner's episodes of a standing benchmark are worth, all together, by robot and by situation."""

from __future__ import annotations

import math
from collections.abc import Hashable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory

from arena_core.commands import align_columns
from arena_core.statistics import Estimate, estimate
from arena_metrics.pages.tuned import NOT_TOLD, tuned_rows
from arena_metrics.pooling.cells import Cell, Cells, cells_of
from arena_metrics.pooling.problems import problem_key
from arena_metrics.pooling.runs import Column, Row, metric_columns, pool_episodes, read_runs
from arena_submit.packing import Pack
from arena_submit.standing import condition_of, planner_of

HEAD = ["", "episodes", "success", "95 %", "no collision", "collisions", "time to goal", "CPU a step", "CPU p99"]
SUCCESS, STRICT = "success", "strict_success"


@dataclass(frozen=True, slots=True, eq=False)
class ScoreCard:
    """A pack's planner with its cells; ``code`` and ``digest`` say whose they are, ``origin`` how the planner was tuned
    and what it learned by.
    """

    planner: str
    code: str
    digest: str
    cells: Sequence[Cell]
    origin: tuple[str, str] = (NOT_TOLD, NOT_TOLD)

    def success(self, cells: Iterable[Cell] | None = None, column: str = SUCCESS) -> Estimate:
        """Estimate the share of successes over cells, by problem and within scenarios; an error is no success.

        Where scenarios are drawn by seed, the problem is the map, which scenarios of one world and robots share.
        """
        chosen = list(self.cells if cells is None else cells)
        values = [value if math.isfinite(value) else 0.0 for cell in chosen for value in cell.values(column)]
        places = [_place(cell, episode.row) for cell in chosen for episode in cell.episodes]
        return estimate(values, True, places, [world for world, _ in places])

    def parts(self, by: str) -> dict[str, list[Cell]]:
        """Return the cells by ``robot``, or by ``situation``: the scenario without its density."""
        found: dict[str, list[Cell]] = {}
        for cell in self.cells:
            found.setdefault(cell.factors["robot"] if by == "robot" else _situation(cell), []).append(cell)
        return dict(sorted(found.items()))

    def only(self, start: str) -> ScoreCard:
        """Return the card of the scenarios that begin so."""
        return replace(self, cells=[cell for cell in self.cells if scenario_of(cell).startswith(start)])

    def without_own(self, searched: Sequence[str]) -> ScoreCard:
        """Return the card without the problems of ``searched`` scenarios that were searched against this planner."""
        kept = [
            replace(cell, episodes=[each for each in cell.episodes if not _is_own(each.row)])
            if scenario_of(cell) in searched
            else cell
            for cell in self.cells
        ]
        return replace(self, cells=[cell for cell in kept if cell.episodes])

    def row(self, name: str, cells: Sequence[Cell], column: str = SUCCESS) -> list[str]:
        """Return a line of the card for a reader, the share of ``column`` first and then that of the other success."""
        success, other = self.success(cells, column), STRICT if column == SUCCESS else SUCCESS
        interval = f"{100 * success.low:.0f}–{100 * success.high:.0f}" if success.has_interval else "–"
        return [
            *(
                name,
                str(success.n),
                f"{100 * success.mean:.0f} %",
                interval,
                _percent_text(_finite_mean(cells, other)),
            ),
            *(
                _value_text(_finite_mean(cells, "collisions"), ".2f"),
                _value_text(_mean_of_successes(cells, "time_to_goal"), ".1f", " s"),
            ),
            _value_text(_finite_mean(cells, "planning_cpu_mean"), ".1f", " ms"),
            _value_text(_finite_mean(cells, "planning_cpu_p99"), ".1f", " ms"),
        ]

    def rows(self, tables: Mapping[str, str] | None = None) -> list[list[str]]:
        """Return the whole card: all episodes, each robot, each situation; where planners are ranked in ``tables``,
        those with their robots in the place of all episodes.
        """
        own = {title: self.only(start) for start, title in tables.items()} if tables else {"all": self}
        parts: dict[str, Sequence[Cell]] = {}
        for title, card in own.items():
            robots = card.parts("robot")
            parts[title] = card.cells
            parts |= {f"{title}, {robot}" if tables else robot: cells for robot, cells in robots.items()}
        return [self.row(name, cells) for name, cells in {**parts, **self.parts("situation")}.items() if cells]


@dataclass(frozen=True, slots=True, eq=False)
class CardSet:
    """The cards of packs, in the packs' order, and what they have in common for comparisons."""

    cards: Sequence[ScoreCard]
    cells: Cells
    columns: Mapping[str, Column]


def read_card_set(packs: Sequence[Pack]) -> CardSet:
    """Read the tables of packs into cards whose cells can be compared."""
    with TemporaryDirectory(prefix="arena-cards-") as place:
        for number, pack in enumerate(packs):
            tables = [
                name
                for name in pack.archive.names
                if name.endswith((".csv", "provenance.json")) and name.startswith("runs/")
            ]
            pack.archive.unpack(tables, Path(place, str(number)))
        runs = read_runs([Path(place)])
        columns = {column.name: column for column in metric_columns(runs)}
        cells = cells_of(pool_episodes(runs)[0])
        cards = [_make_card(pack, Path(place, str(number)).resolve(), cells) for number, pack in enumerate(packs)]
    return CardSet(cards, cells, columns)


def read_cards(packs: Sequence[Pack]) -> Sequence[ScoreCard]:
    """Return the cards of packs, in their order."""
    return read_card_set(packs).cards


def card_text(card: ScoreCard, tables: Mapping[str, str] | None = None) -> str:
    """Return a card for the terminal."""
    return "\n".join(align_columns([[card.planner, *HEAD[1:]], *card.rows(tables)]))


def _make_card(pack: Pack, folder: Path, cells: Cells) -> ScoreCard:
    own = [cell for cell in cells.cells if cell.episodes[0].run.folder.resolve().is_relative_to(folder)]
    codes = sorted({cell.code for cell in own})
    rows = tuned_rows([cell.episodes[0].run for cell in own])
    return ScoreCard(planner_of(pack.runs[0]), ", ".join(codes), pack.digest, own, (_tuned_text(rows), _each(rows, -1)))


def _tuned_text(rows: Sequence[Sequence[str]]) -> str:
    """Return how a planner was tuned, with its budget where there was one."""
    return ", ".join(dict.fromkeys(row[2] if row[3] == NOT_TOLD else f"{row[2]}, {row[3]}" for row in rows))


def _each(rows: Sequence[Sequence[str]], column: int) -> str:
    return ", ".join(dict.fromkeys(row[column] for row in rows))


def scenario_of(cell: Cell) -> str:
    """Return the scenario that a cell is of, or its experiment where that has none."""
    return condition_of(cell.config)[1]


def _situation(cell: Cell) -> str:
    pack, _, name = scenario_of(cell).rpartition("/")
    return name.rpartition("_")[0] if pack else name


def _place(cell: Cell, row: Row) -> tuple[str, Hashable]:
    """Return the stratum of an episode and its problem: scenario and variation, or world and map of a drawn one."""
    name = scenario_of(cell) if row.get("scenario_hash") else str(row["world"])
    return name, (name, problem_key(row))


def _is_own(row: Row) -> bool:
    """Return whether a problem, TEXT_NN, is called after the planner and the robot of its row."""
    return str(row["scenario"]).partition("/")[0].rpartition("_")[0] == f"{row['preset']}_{row['robot']}"


def _finite_mean(cells: Sequence[Cell], column: str) -> float:
    values = [value for cell in cells for value in cell.values(column) if math.isfinite(value)]
    return sum(values) / len(values) if values else math.nan


def _mean_of_successes(cells: Sequence[Cell], column: str) -> float:
    both = [pair for cell in cells for pair in zip(cell.values(column), cell.values("success"), strict=True)]
    values = [value for value, success in both if success == 1.0 and math.isfinite(value)]
    return sum(values) / len(values) if values else math.nan


def _percent_text(share: float) -> str:
    return f"{100 * share:.0f} %" if math.isfinite(share) else "–"


def _value_text(value: float, form: str, unit: str = "") -> str:
    return f"{value:{form}}{unit}" if math.isfinite(value) else "–"
