"""What ladders found, as `arena ladder` wrote it: curves of success over density, breaking densities, and pairs."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from arena_core import ArenaError, InputFileError
from arena_core.commands import one_line
from arena_core.files import is_file, read_json

DOCUMENT, REQUEST = "ladder.json", "ladder_request.json"  # what a ladder found; what was asked for
ALLOWED = "what this version of `arena ladder` wrote; `arena ladder report DIR` writes it again"
SUCCESS, LIMIT = "success", "clairvoyant"
KINDS = (SUCCESS, "strict_success", LIMIT)
Points = Sequence[tuple[float, float]]


@dataclass(frozen=True, slots=True)
class BreakingDensity:
    """A breaking density with its 95 % interval, people per 100 m2, and how it is told."""

    value: float
    low: float
    high: float
    text: str


@dataclass(frozen=True, slots=True)
class LadderCurve:
    """Success over density in a cell: the fitted ``curve``, what was ``driven`` (density, share, episodes), and where
    it comes down to .9 and .5.
    """

    curve: Points
    driven: Sequence[tuple[float, float, int]]
    rho90: BreakingDensity
    rho50: BreakingDensity


@dataclass(frozen=True, slots=True)
class LadderResult:
    """A planner on a robot: the highest rung, and its curves by cell and kind (``KINDS``)."""

    planner: str
    robot: str
    highest: float
    cells: Mapping[str, Mapping[str, LadderCurve]]

    @property
    def name(self) -> str:
        """Return planner and robot."""
        return f"{self.planner} on {self.robot}"


@dataclass(frozen=True, slots=True)
class LadderDocument:
    """Ladders that are shown together, a sentence for each pair, and ``notes`` on what is missing."""

    ladders: Sequence[LadderResult]
    pairs: Sequence[str]
    notes: Sequence[str] = ()

    @property
    def cells(self) -> list[str]:
        """Return the names of all cells, WORLD_CROWD, in order."""
        return list(dict.fromkeys(name for ladder in self.ladders for name in ladder.cells))


def read_ladder_document(path: Path) -> LadderDocument:
    """Read a ``ladder.json``; raise InputFileError (one line) for anything else."""
    return parse_ladder_document(read_json(path, ALLOWED), str(path))


def parse_ladder_document(told: Any, place: str) -> LadderDocument:
    """Return what a ``ladder.json`` holds; raise InputFileError (one line), which names its place."""
    try:
        ladders = [
            LadderResult(
                str(one["planner"]),
                str(one["robot"]),
                _number(one["rungs"][-1]),
                {str(name): _curves(cell) for name, cell in one["cells"].items()},
            )
            for one in told["ladders"]
        ]
        return LadderDocument(ladders, [str(text) for text in told["pairs"]])
    except KeyError as error:
        raise InputFileError(f"{place}: lacks {one_line(str(error), 40)}; allowed: {ALLOWED}") from None
    except (IndexError, TypeError, ValueError, AttributeError) as error:
        raise InputFileError(f"{place}: holds no ladder ({one_line(str(error), 60)}); allowed: {ALLOWED}") from None


def ladders_below(folders: Iterable[Path]) -> LadderDocument | None:
    """Return the ladders whose blocks are among the folders of runs; None where there are none.

    Sentences on pairs are those of a page over the same ladders, with the same content, that lies beside them.
    """
    places = [path for path in dict.fromkeys(folder.absolute().parent.parent for folder in folders) if _is_ladder(path)]
    if not places:
        return None
    found: list[tuple[Path, LadderResult]] = []
    notes = []
    for place in places:
        try:
            found.append((place, read_ladder_document(place / DOCUMENT).ladders[0]))
        except (ArenaError, IndexError) as error:
            there = is_file(place / DOCUMENT)
            notes.append(f"{error}." if there else f"{place} has no {DOCUMENT} yet: its ladder has not ended.")
    pairs, note = _pairs_beside(found) if len(found) > 1 else ([], [])
    return LadderDocument([ladder for _, ladder in found], pairs, [*notes, *note])


def _pairs_beside(found: Sequence[tuple[Path, LadderResult]]) -> tuple[Sequence[str], list[str]]:
    """Return the sentences of a page over these ladders, or how to get them."""
    wanted = {ladder.name: ladder for _, ladder in found}
    for path in sorted({path for place, _ in found for path in place.parent.glob(f"*/{DOCUMENT}")}):
        try:
            document = read_ladder_document(path)
        except ArenaError:  # no page of this version
            continue
        if {ladder.name: ladder for ladder in document.ladders} == wanted:
            return document.pairs, []
    command = f"arena ladder report {' '.join(str(place) for place, _ in found)} out={found[0][0].parent / 'report'}"
    return [], [f"{command} compares them in pairs; the next report then says which of them bears more people."]


def _is_ladder(place: Path) -> bool:
    return is_file(place / REQUEST)


def _curves(cell: Mapping[str, Any]) -> dict[str, LadderCurve]:
    return {kind: _curve(cell[kind]) for kind in KINDS if kind == SUCCESS or kind in cell}


def _curve(told: Mapping[str, Any]) -> LadderCurve:
    driven = [
        (_number(one["density"]), _number(one["successes"]) / _number(one["episodes"]), int(one["episodes"]))
        for one in told["rungs"]
        if one["episodes"]
    ]
    curve = [(_number(x), _number(y)) for x, y in told["curve"]]
    return LadderCurve(curve, driven, _breaking(told["rho90"]), _breaking(told["rho50"]))


def _breaking(told: Mapping[str, Any]) -> BreakingDensity:
    return BreakingDensity(_number(told["value"]), _number(told["low"]), _number(told["high"]), str(told["text"]))


def _number(value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not math.isfinite(value):
        raise ValueError(f"{value!r} is no number")
    return float(value)
