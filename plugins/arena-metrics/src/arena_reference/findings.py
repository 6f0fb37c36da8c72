"""What is found out about the problems of a run: how its episodes compare with what could have been done."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from arena_core import ArenaError, EpisodeRecord
from arena_core.records import FindingColumn, Findings, is_success, read_findings, write_findings

KIND = CERTIFICATES = "reference"  # of the findings; and the folder of certificates in a run's
POSITIVE = (0.0, math.inf)
COLUMNS = (
    FindingColumn(
        "solvable", "text", "neither", "yes: there is a certificate; no: not even the lower bound is in time"
    ),
    FindingColumn("time_lower", "s", "neither", "lower bound of the time to the goal without any contact", POSITIVE),
    FindingColumn("time_certified", "s", "neither", "time of the certificate", POSITIVE),
    FindingColumn("time_regret", "s", "lower", "time of a strict success less that of the certificate"),
    FindingColumn(
        "stl",
        "-",
        "higher",
        "success weighted by time: certified by taken time, 0 without strict success",
        (0.0, 1.0),
    ),
    FindingColumn("avoidable", "0/1", "lower", "no strict success although a certificate exists"),
    FindingColumn("problem", "text", "neither", "digest of the problem and of the code that solved it"),
)
STRICT = 0  # contacts of a strict success

Solvable = Literal["yes", "no", "unknown"]


@dataclass(frozen=True, slots=True)
class Finding:
    """What is known of one episode and its problem; times in s, NaN where there is none.

    ``solvable``: ``yes`` with a certificate, ``no`` where not even the lower bound is within the time limit.
    ``time_lower`` is that bound, ``time_certified`` the time of the certificate. ``time_regret`` and ``stl``
    (T*/max(T*, T), T* the certificate's time; 0 for what is no strict success) tell how the episode compares.
    ``avoidable`` is 1 for a failure where a certificate exists. ``problem`` is the digest of problem and code.
    """

    episode: int
    scenario: str
    solvable: Solvable
    time_lower: float
    time_certified: float
    time_regret: float
    stl: float
    avoidable: float
    problem: str


def compare(
    episode: int, record: EpisodeRecord, certificates: Sequence[EpisodeRecord | None], problem: str, *, reacts: bool
) -> Finding:
    """Return what certificates say of an episode: the records of all robots of its team, in their order, None where one
    left none; it is one only if all succeed. Among people who react the lower bound is that of the walls.
    """
    certificate = certificates[episode % len(certificates)]
    notes = {} if certificate is None else certificate.meta.get("notes", {})
    lower = float(notes.get("time_lower_static" if reacts else "time_lower", math.nan))
    times = [math.nan if one is None else _strict_time(one) for one in certificates]
    certified = times[episode % len(times)] if all(map(math.isfinite, times)) else math.nan
    solvable: Solvable = "yes" if math.isfinite(certified) else "no" if lower == math.inf else "unknown"
    needed = _strict_time(record)
    succeeded, known = math.isfinite(needed), solvable == "yes"
    return Finding(
        episode,
        str(record.meta["scenario"]["name"]),
        solvable,
        lower,
        certified,
        needed - certified,
        (certified / max(certified, needed) if succeeded else 0.0) if known else math.nan,
        float(not succeeded) if known else math.nan,
        problem,
    )


def check_simulated(folder: Path, record: EpisodeRecord) -> None:
    """Raise ArenaError for an episode whose truth no simulator knows, such as one that was imported."""
    if "truth" in record.meta:
        raise ArenaError(f"{folder}: no simulator knows its truth (a recording); allowed: runs that `arena run` drove")


def _strict_time(record: EpisodeRecord) -> float:
    """Return the time to the goal of a strict success, NaN of anything else."""
    return float(record["stamp"][-1]) if is_success(record, collisions_allowed=STRICT) else math.nan


def keep_findings(folder: Path, found: Iterable[Finding], code: str) -> None:
    """Write the findings about a run beside its records."""
    rows = {one.episode: {column.name: getattr(one, column.name) for column in COLUMNS} for one in found}
    write_findings(folder, Findings(KIND, code, COLUMNS, rows))


def known_problems(folder: Path) -> dict[int, str]:
    """Return the digests of the problems of a run that were certified, by episode."""
    return {
        episode: str(row["problem"])
        for found in read_findings(folder)
        if found.kind == KIND
        for episode, row in found.rows.items()
    }
