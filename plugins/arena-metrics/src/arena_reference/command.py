"""``arena reference``: how far runs are from what could have been done."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from statistics import fmean
from typing import ClassVar

from arena_core import Run, Runs
from arena_core.commands import Command, align_columns, complete_overrides, read_words
from arena_core.hosting import compose, load_registry, to_plain
from arena_reference.certifying import reference_runs
from arena_reference.findings import Finding

USAGE = "usage: arena reference DIR... [executor=NAME ...]"


class ReferenceCommand(Command):
    """Certify what could have been done in the problems of runs, and compare."""

    help: ClassVar[str] = "lower bounds and certificates of what could have been done: arena reference DIR..."

    def run(self, arguments: Sequence[str]) -> int:
        """Write ``reference.csv`` and the certificates' records beside each run's own; print what they show."""
        if any(word in ("-h", "--help") for word in arguments):
            print(USAGE)
            return 0
        words = read_words(USAGE, arguments, names=None, overrides=("executor",))
        if not words.names:
            words.required("DIR")
        registry = load_registry()
        found = reference_runs(list(Runs.below(*words.names)), to_plain(compose(words.overrides))["executor"], registry)
        print("\n".join(align_columns([HEADER, *(_cells(run, findings) for run, findings in found.items())])))
        return 0

    def complete(self, words: Sequence[str], word: str) -> Sequence[str]:
        """Return the executor's keys; folders are the shell's."""
        return complete_overrides(words, word) if word.startswith("executor") else ()


HEADER = ["run", "n", "solvable", "lower [s]", "certified [s]", "regret [s], strict", "stl", "avoidable failures"]


def _cells(run: Run, findings: Sequence[Finding]) -> list[str]:
    """Return a run's line of the table."""
    known = [one for one in findings if one.solvable == "yes"]
    return [
        str(run.folder),
        str(len(findings)),
        _counts(findings),
        _mean(one.time_lower for one in known),
        _mean(one.time_certified for one in known),
        _mean(one.time_regret for one in known),
        _mean(one.stl for one in known),
        f"{sum(one.avoidable == 1.0 for one in known)} of {len(known)}",
    ]


def _counts(findings: Sequence[Finding]) -> str:
    counted = ((word, sum(one.solvable == word for one in findings)) for word in ("yes", "no", "unknown"))
    return ", ".join(f"{count} {word}" for word, count in counted if count)


def _mean(values: Iterator[float]) -> str:
    known = [value for value in values if math.isfinite(value)]
    return f"{fmean(known):.2f}" if known else "-"
