"""A ladder on disk: a run for each block of each cell, ``WORLD_CROWD/NN_RUNG``, driven round by round."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

from arena_core import ConfigurationError, InputFileError, Run
from arena_core.files import read_json, write_text_whole
from arena_core.hosting import run_jobs
from arena_core.records import read_findings
from arena_ladder.allocation import Block, next_rungs
from arena_ladder.breaking import Drive
from arena_ladder.plan import Plan

REQUEST = "ladder_request.json"
ALLOWED = "a file that `arena ladder` wrote"
NO_ROOM = "ImpossibleScenario"  # of an episode whose people, start or goal found no place
EXPERIMENT = ("experiment=ladder", "report=false")


class LadderFolder:
    """A ladder's folder: what was asked for, and the blocks that are finished."""

    def __init__(self, folder: Path, plan: Plan, words: Sequence[str]) -> None:
        self.folder, self.plan, self.words = folder, plan, tuple(words)

    @staticmethod
    def read(folder: Path) -> LadderFolder:
        """Read a ladder that was begun; raise InputFileError."""
        told = read_json(folder / REQUEST, ALLOWED)
        try:
            return LadderFolder(folder, _read_plan(told["plan"]), [str(word) for word in told["words"]])
        except (KeyError, TypeError, ValueError) as error:
            raise InputFileError(f"{folder / REQUEST}: holds no ladder ({error}); allowed: {ALLOWED}") from None

    def begin(self, *, resume: bool) -> None:
        """Write what is asked for; raise ConfigurationError where the folder holds another ladder, or one is not to be
        resumed. A larger cap goes on where a smaller one ended.
        """
        lasting = [word for word in self.words if not word.startswith("executor")]  # workers change nothing
        asked = json.loads(json.dumps({"plan": asdict(self.plan), "words": lasting}))
        path = self.folder / REQUEST
        if path.exists():
            if not resume:
                raise ConfigurationError(
                    f"{self.folder} holds a ladder already; resume=true continues it, out=DIR takes another"
                )
            held = LadderFolder.read(self.folder)
            if (replace(held.plan, cap=self.plan.cap), list(held.words)) != (self.plan, lasting):
                raise ConfigurationError(f"{self.folder} holds another ladder; resume=true continues only the same one")
            if held.plan.cap > self.plan.cap:
                raise ConfigurationError(f"cap is {self.plan.cap}; allowed: {held.plan.cap} or more, as {path} has it")
        self.folder.mkdir(parents=True, exist_ok=True)
        write_text_whole(path, json.dumps(asked, indent=2) + "\n")

    def drive(self, report: Callable[[int, Mapping[str, int]], None]) -> None:
        """Drive all blocks that are left; those that are there are checked, and continued where one was cut short."""
        begun = [path for name in self.plan.names for path in self._begun(name)]
        if begun:
            run_jobs({path: [*self._words_of(path), "resume=true"] for path in begun})
        number = 0
        while due := next_rungs(self.plan, self.blocks()):
            report(number, due)
            places = [self._place(name, rung) for name, rung in due.items()]
            run_jobs({path: self._words_of(path) for path in places})
            number += 1

    def blocks(self) -> dict[str, list[Block]]:
        """Return what came of each cell's blocks, in order."""
        return {name: [_block_of(drives) for drives in self._drives_of(name)] for name in self.plan.names}

    def drives(self) -> list[Drive]:
        """Return all episodes."""
        return [drive for name in self.plan.names for drives in self._drives_of(name) for drive in drives]

    def limit(self) -> list[Drive]:
        """Return the same episodes as the clairvoyant solved them, where a reference was found; none elsewhere."""
        return [
            drive for name in self.plan.names for path in self._paths(name) for drive in _certified(self, name, path)
        ]

    def _drives_of(self, name: str) -> list[list[Drive]]:
        return [read_block(self.plan, name, path) for path in self._paths(name)]

    def _paths(self, name: str) -> list[Path]:
        return [path for path in self._begun(name) if (path / "episodes.csv").is_file()]

    def _begun(self, name: str) -> list[Path]:
        return sorted((self.folder / name).glob("[0-9][0-9][0-9]_*"))

    def _place(self, name: str, rung: int) -> Path:
        return self.folder / name / f"{len(self._paths(name)):03d}_{self.plan.rungs[rung]:g}"

    def _words_of(self, path: Path) -> list[str]:
        number, _, density = path.name.partition("_")
        rung = self.plan.rungs.index(float(density))
        own = [
            f"task.density={density}",
            f"task.rung={rung}",
            f"seed={self.plan.seed + int(number)}",
            f"episodes={self.plan.block}",
        ]
        return [*EXPERIMENT, *self.plan.cells[path.parent.name], *self.words, *own]


def read_block(plan: Plan, name: str, path: Path) -> list[Drive]:
    """Return the episodes of a block; an error of the planner is a failure, a problem without room is none."""
    rung = plan.rungs.index(float(path.name.partition("_")[2]))
    table = Run(path).episodes.sort_values("episode")
    return [_drive_of(row, name, rung, plan.rungs[rung]) for row in table.to_dict("records")]


def _drive_of(row: Mapping[str, Any], name: str, rung: int, asked: float) -> Drive:
    density = _number(row.get("people_per_100m2"))
    return Drive(
        name,
        rung,
        density if math.isfinite(density) and (density > 0.0) == (asked > 0.0) else asked,
        (name.partition("_")[0], int(row["seed"]), int(row["episode"])),
        _number(row.get("success")) == 1.0,
        _number(row.get("strict_success")) == 1.0,
        row["outcome"] == "error" and str(row["error"]).startswith(NO_ROOM),
    )


def _certified(ladder: LadderFolder, name: str, path: Path) -> list[Drive]:
    rows = next((found.rows for found in read_findings(path) if found.kind == "reference"), {})
    drives = read_block(ladder.plan, name, path)
    solved = {number: row.get("solvable") == "yes" for number, row in rows.items()}
    return [
        Drive(d.cell, d.rung, d.density, d.world_map, solved[number], solved[number], d.no_room)
        for d in drives
        if (number := d.world_map[2]) in solved
    ]


def _block_of(drives: Sequence[Drive]) -> Block:
    driven = [drive for drive in drives if not drive.no_room]
    density = math.fsum(drive.density for drive in driven) / len(driven) if driven else 0.0
    return Block(drives[0].rung, len(drives) - len(driven), len(driven), sum(d.success for d in driven), density)


def _number(value: Any) -> float:
    try:
        return float(value)
    except (TypeError, ValueError):
        return math.nan


def _read_plan(told: Mapping[str, Any]) -> Plan:
    cells = {str(name): tuple(map(str, words)) for name, words in told["cells"].items()}
    return Plan(
        cells,
        tuple(map(float, told["rungs"])),
        tuple(map(int, told["first"])),
        int(told["block"]),
        int(told["cap"]),
        float(told["precision"]),
        int(told["seed"]),
    )
