"""What is found out about an episode: why it failed, until when that could be avoided, and what held it up."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, fields
from pathlib import Path

from arena_core.files import csv_text, write_text_whole
from arena_core.records import FindingColumn, FindingMark, Findings, write_findings
from arena_reference.incidents import Incident

KIND, TABLE = "explain", "explain.csv"  # of the findings; and beside episodes.csv
COLUMNS = (
    FindingColumn("cause", "text", "neither", "why the episode is no strict success"),
    FindingColumn("whom", "text", "neither", "with whom or what the robot met"),
    FindingColumn("lead", "s", "neither", "how long before the contact that decided it could still have been avoided"),
    FindingColumn("instead", "text", "neither", "what would have done until then"),
    FindingColumn("recoveries", "-", "lower", "recovery behaviours that began"),
    FindingColumn("stands", "-", "lower", "stands of 3 s or more"),
    FindingColumn("stood", "s", "lower", "how long they lasted together"),
    FindingColumn("reversals", "-", "lower", "changes between forwards and backwards, those within 2 s as one"),
)
UNEXPLAINED = {"cause": "", "whom": "", "lead": math.nan, "instead": ""}  # of a strict success
MOMENT = "last avoidable moment"  # the kind of its mark


@dataclass(frozen=True, slots=True)
class Explanation:
    """One contact, or one failure without any: ``cause``, ``whom``, ``stamp`` s, and whether it ``decided``.

    ``avoidable_until`` s is the last moment from which a way out was driven, NaN where none was found; ``lead`` s is
    how long before the contact that was, ``instead`` what the way out begins with, ``note`` why nothing is known.
    ``way`` is the way out, places (x, y) in ``map``, m.
    """

    episode: int
    cause: str
    whom: str
    stamp: float
    decided: bool
    avoidable_until: float
    lead: float
    instead: str
    note: str
    way: Sequence[tuple[float, float]] = ()

    def mark(self) -> FindingMark | None:
        """Return the last moment at which it could be avoided, None where that is not known."""
        if self.avoidable_until != self.avoidable_until:
            return None
        met = f"{self.cause}{_by(self.cause)} {self.whom}, {self.lead:.1f} s later"
        return FindingMark(MOMENT, self.avoidable_until, f"{met}; until here {self.instead} would have done", self.way)

    def sentence(self) -> str:
        """Return it in words."""
        whom = f"{_by(self.cause)} {self.whom}" if self.whom else ""
        what = f"episode {self.episode}: {self.cause}{whom} at {self.stamp:.1f} s"
        if self.note:
            return f"{what}; {self.note}"
        if self.lead == self.lead:
            return f"{what}; avoidable until {self.lead:.1f} s before: until then {self.instead} would have done"
        return what


def _by(cause: str) -> str:
    return " by" if cause.startswith("was run into") else ""


@dataclass(frozen=True, slots=True, eq=False)
class ExplainedEpisode:
    """What is known of an episode: its contacts or its failure without any, none for a strict success, and what held
    it up.
    """

    episode: int
    contacts: Sequence[Explanation]
    incidents: Sequence[Incident]

    def sentences(self) -> list[str]:
        """Return it in words, in order of time."""
        told = [(one.stamp, one.sentence()) for one in self.contacts]
        told += [
            (one.stamp, f"episode {self.episode}: {one.sentence()} at {one.stamp:.1f} s") for one in self.incidents
        ]
        return [text for _, text in sorted(told, key=lambda one: one[0])]

    def row(self) -> Mapping[str, float | str]:
        """Return its row of findings."""
        decided = next((one for one in self.contacts if one.decided), None)
        told = UNEXPLAINED if decided is None else {name: getattr(decided, name) for name in UNEXPLAINED}
        counts = Counter(one.kind for one in self.incidents)
        stood = sum(one.lasted for one in self.incidents if one.kind == "stand")
        held = {"recoveries": counts["recovery"], "stands": counts["stand"], "stood": stood}
        return {**told, **held, "reversals": counts["reversal"]}

    def marks(self) -> list[FindingMark]:
        """Return its moments, in order."""
        moments = [mark for one in self.contacts if (mark := one.mark()) is not None]
        moments += [FindingMark(one.kind, one.stamp, one.sentence()) for one in self.incidents]
        return sorted(moments, key=lambda mark: mark.stamp)


def write_explanations(folder: Path, found: Sequence[ExplainedEpisode], code: str) -> None:
    """Write all contacts and failures of a run as a table, and of each episode what decided, what held it up, and the
    moments of both as findings.
    """
    names = [field.name for field in fields(Explanation) if field.name != "way"]
    told = [asdict(one) for episode in found for one in episode.contacts]
    cells = [["" if row[name] != row[name] else row[name] for name in names] for row in told]
    write_text_whole(folder / TABLE, csv_text([names, *cells]))
    rows, marks = {one.episode: one.row() for one in found}, {one.episode: one.marks() for one in found}
    write_findings(folder, Findings(KIND, code, COLUMNS, rows, marks))
