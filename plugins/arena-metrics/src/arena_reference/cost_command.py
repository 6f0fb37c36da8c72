"""``arena cost``: what the robots of runs cost the people there."""

from __future__ import annotations

import math
from collections.abc import Sequence
from statistics import fmean
from typing import ClassVar

from arena_core import Run, Runs
from arena_core.commands import Command, align_columns, read_words
from arena_core.hosting import load_registry
from arena_core.records import Findings
from arena_reference.costing import cost_of_run
from arena_reference.explain_command import planner_of
from arena_reference.people_cost import COSTS

USAGE = "usage: arena cost DIR..."


class CostCommand(Command):
    """Drive episodes again with and without their robot, and compare what people did."""

    help: ClassVar[str] = "what robots cost the people there, against the same people without: arena cost DIR..."

    def run(self, arguments: Sequence[str]) -> int:
        """Write ``findings/cost.json`` beside the records of each run, and print a line for it."""
        if any(word in ("-h", "--help") for word in arguments):
            print(USAGE)
            return 0
        words = read_words(USAGE, arguments, names=None)
        if not words.names:
            words.required("DIR")
        registry, lines, notes = load_registry(), [_head()], list[str]()
        for run in Runs.below(*words.names):
            found = cost_of_run(run, registry)
            lines.append(_cells(run, found))
            notes += [f"{run.folder}: {note}" for note in _notes(found)]
        print("\n".join(align_columns(lines) + notes))
        return 0


def _head() -> list[str]:
    costs = [f"{name} [{unit}]" if unit != "-" else name for name, (unit, _) in COSTS.items()]
    return ["run", "planner", "n", *costs, "worst delay [s]", "censored"]


def _cells(run: Run, found: Findings) -> list[str]:
    """Return a run's line of the table: means over the episodes of which something is known."""
    censored, compared = _sum(found, "people_censored"), _sum(found, "people_compared")
    return [
        str(run.folder),
        planner_of(run),
        str(len(found.rows)),
        *(_mean(found, name) for name in COSTS),
        _mean(found, "people_delay_worst"),
        f"{censored:.0f} of {compared:.0f}",
    ]


def _known(found: Findings, name: str) -> list[float]:
    values = [float(row[name]) for row in found.rows.values()]
    return [value for value in values if math.isfinite(value)]


def _sum(found: Findings, name: str) -> float:
    return sum(_known(found, name))


def _mean(found: Findings, name: str) -> str:
    known = _known(found, name)
    return f"{fmean(known):.3f}" if known else "-"


def _notes(found: Findings) -> list[str]:
    """Return each note once, with how many episodes it is about."""
    notes = [str(row["note"]) for row in found.rows.values() if row["note"]]
    return [f"{notes.count(note)} of {len(found.rows)} episodes: {note}" for note in dict.fromkeys(notes)]
