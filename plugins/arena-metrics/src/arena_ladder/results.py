"""What a ladder found: its fit, breaking densities, curves, and what the clairvoyant could have done."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from arena_core import ConfigurationError
from arena_ladder.allocation import Block, rungs_without_room
from arena_ladder.breaking import Breaking, Drive, find_breaking, make_sample
from arena_ladder.driving import LadderFolder
from arena_ladder.fitting import Fit
from arena_ladder.plan import Plan

SHARES = (0.9, 0.5)
STEP = 0.5  # people per 100 m2 between two points of a curve


@dataclass(frozen=True, slots=True, eq=False)
class Curve:
    """Success over density of all cells: the fit, episodes and successes by (cell, rung), and breaking densities."""

    fit: Fit
    densities: Any
    episodes: Any
    successes: Any
    breaking: Mapping[float, Sequence[Breaking]]


@dataclass(frozen=True, slots=True, eq=False)
class Ladder:
    """A planner on a robot: its plan, episodes, blocks, and its curves of success and strict success.

    ``limit`` is the share of problems that the clairvoyant solves, where a reference was found.
    """

    planner: str
    robot: str
    plan: Plan
    drives: Sequence[Drive]
    blocks: Mapping[str, Sequence[Block]]
    success: Curve
    strict: Curve
    limit: Curve | None = None
    words: Sequence[str] = field(default=())

    @property
    def name(self) -> str:
        """Return planner and robot."""
        return f"{self.planner} on {self.robot}"

    def without_room(self, cell: str) -> list[float]:
        """Return the rungs of a cell that were left out because people found no room."""
        return [self.plan.rungs[rung] for rung in sorted(rungs_without_room(self.plan, self.blocks[cell]))]


def read_ladders(folders: Sequence[Path]) -> list[Ladder]:
    """Read and fit ladders; raise InputFileError for what is none, ConfigurationError for two of one name."""
    found = [read_ladder(folder) for folder in folders]
    names = [one.name for one in found]
    for name in names:
        if names.count(name) > 1:
            raise ConfigurationError(f"two ladders are of {name}; allowed: one of each planner and robot")
    return found


def read_ladder(folder: Path) -> Ladder:
    """Read and fit one ladder; raise ConfigurationError where no episode was driven yet."""
    ladder = LadderFolder.read(folder)
    drives = ladder.drives()
    if all(drive.no_room for drive in drives):
        raise ConfigurationError(
            f"{folder} has no episode that found room yet; allowed: a ladder with some, resume=true"
        )
    given = {key: value for key, _, value in (word.partition("=") for word in ladder.words)}
    limit = ladder.limit()
    return Ladder(
        given["planner"],
        given["robot"],
        ladder.plan,
        drives,
        ladder.blocks(),
        make_curve(ladder.plan, drives),
        make_curve(ladder.plan, drives, strict=True),
        make_curve(ladder.plan, limit) if limit else None,
        ladder.words,
    )


def make_curve(plan: Plan, drives: Sequence[Drive], *, strict: bool = False) -> Curve:
    """Fit the episodes of a ladder."""
    sample = make_sample(plan, drives, strict=strict)
    fit, breaking = find_breaking(plan, sample, SHARES)
    counts = sample.counts(np.ones(sum(map(len, sample.strata))))
    return Curve(fit, counts.densities, counts.episodes, counts.successes, breaking)


def ladder_document(ladder: Ladder) -> dict[str, Any]:
    """Return what ``ladder.json`` holds of a ladder."""
    curves = {"success": ladder.success, "strict_success": ladder.strict}
    if ladder.limit is not None:
        curves["clairvoyant"] = ladder.limit
    return {
        "planner": ladder.planner,
        "robot": ladder.robot,
        "words": list(ladder.words),
        "rungs": list(ladder.plan.rungs),
        "cells": {name: _cell_document(ladder, curves, i) for i, name in enumerate(ladder.plan.names)},
        "slopes": {kind: curve.fit.slope for kind, curve in curves.items()},
    }


def _cell_document(ladder: Ladder, curves: Mapping[str, Curve], cell: int) -> dict[str, Any]:
    name = ladder.plan.names[cell]
    along = np.arange(0.0, ladder.plan.rungs[-1] + 0.5 * STEP, STEP)
    told: dict[str, Any] = {
        "episodes": sum(drive.cell == name and not drive.no_room for drive in ladder.drives),
        "no_room": sum(drive.cell == name and drive.no_room for drive in ladder.drives),
        "rungs_without_room": ladder.without_room(name),
    }
    for kind, curve in curves.items():
        rungs = [
            {"density": x, "episodes": int(n), "successes": int(k)}
            for x, n, k in zip(curve.densities[cell], curve.episodes[cell], curve.successes[cell], strict=True)
            if n
        ]
        points = [
            [x, round(p, 6)] for x, p in zip(along.tolist(), curve.fit.success(cell, along).tolist(), strict=True)
        ]
        told[kind] = {"half": curve.fit.halves[cell], "lapse": curve.fit.lapses[cell], "rungs": rungs, "curve": points}
        for share in SHARES:
            one = curve.breaking[share][cell]
            told[kind][f"rho{100.0 * share:.0f}"] = {
                **{"value": one.value, "low": one.low, "high": one.high, "text": one.text()},
                "within_precision": one.precise <= ladder.plan.precision,
            }
    return told
