"""Recoveries, stands and reversals of an episode, each with its reason, as its record tells."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, Literal

import numpy as np

from arena_core import EpisodeRecord
from arena_reference.causes import STANDING, stands_of

LONG = 3.0  # s, from which on a stand is an incident
NEAR = 1.0  # m, within which what is about the robot may be a reason
LEANS = 0.1  # m, within which a robot leans on what it is said to lean on
TOGETHER = 2.0  # s, within which reversals are one incident
LEADS = 4.0  # s after a recovery began within which the robot reverses because of it
LONG_REASON = 80  # characters of what a planner said

Kind = Literal["recovery", "stand", "reversal"]


@dataclass(frozen=True, slots=True)
class Incident:
    """Something that held a robot up: when it began, s, for how long it lasted, s, and why, in words."""

    kind: Kind
    stamp: float
    lasted: float
    reason: str

    def sentence(self) -> str:
        """Return it in words."""
        if self.kind == "stand":
            return f"stood {self.lasted:.1f} s: {self.reason}"
        return f"recovery {self.reason}" if self.kind == "recovery" else f"reversed {self.reason}"


def incidents_of(record: EpisodeRecord) -> list[Incident]:
    """Return the incidents of an episode, in order."""
    found = [*_recoveries(record), *_stands(record), *_reversals(record)]
    return sorted(found, key=lambda one: (one.stamp, one.kind))


def _recoveries(record: EpisodeRecord) -> Iterator[Incident]:
    lean_time = record.meta.get("config", {}).get("recoveries", {}).get("lean_time")
    for event in _events(record, "recovery"):
        row = _row_at(record, float(event["stamp"]))
        behaviour, _, why = str(event["detail"]).partition(": ")
        about, gap = what_is_near(record, row)
        if why.startswith("leans on") and about and gap <= LEANS:
            reason = f"leaned {lean_time or 0.0:.0f} s on {about}"
        else:
            reason = "; ".join(filter(None, (why, f"{about} {gap:.1f} m away" if about else "")))
        yield Incident("recovery", float(event["stamp"]), 0.0, f"{behaviour}: {reason}")


def _stands(record: EpisodeRecord) -> Iterator[Incident]:
    """Yield the stands of ``LONG`` s or more."""
    stamps = record["stamp"]
    edges = np.flatnonzero(np.diff(np.concatenate(([0], stands_of(record).astype(np.int8), [0]))))
    for first, after in zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True):
        last = min(after, len(stamps) - 1)
        lasted = float(stamps[last] - stamps[first])
        if lasted >= LONG:
            yield Incident("stand", float(stamps[first]), lasted, _why_standing(record, first, last))


def _why_standing(record: EpisodeRecord, first: int, last: int) -> str:
    """Return why a robot stood from row ``first`` to row ``last``, by what it was told, and what was about it."""
    begin, end = float(record["stamp"][first]), float(record["stamp"][last])
    told = np.hypot(*record["command"][first:last, :2].T)
    refused = [event for event in _events(record, "no_valid_command") if begin <= float(event["stamp"]) < end]
    waits = [event for event in _events(record, "recovery") if str(event["detail"]).startswith("wait")]
    reasons = []
    if float((told > STANDING).mean()) > 0.5:
        reasons.append("was told to drive" + (" and touched something" * bool(record["in_contact"][first:last].any())))
    elif any(begin - 1.0 <= float(event["stamp"]) < end for event in waits):
        reasons.append("a recovery waited")
    elif refused:
        reasons.append(f"the planner found no command ({str(refused[0]['detail'])[:LONG_REASON]})")
    reasons += filter(None, [_ahead_text(record, first)])
    return "; ".join(reasons) or "nothing was near"


def _reversals(record: EpisodeRecord) -> Iterator[Incident]:
    """Yield changes between forwards and backwards; those within ``TOGETHER`` s of each other as one."""
    speeds, stamps = record["twist"][:, 0], record["stamp"]
    moving = np.flatnonzero(np.abs(speeds) > STANDING)
    rows = [int(after) for before, after in pairwise(moving) if speeds[before] * speeds[after] < 0.0]
    groups: list[list[int]] = []
    for row in rows:
        if groups and stamps[row] - stamps[groups[-1][-1]] <= TOGETHER:
            groups[-1].append(row)
        else:
            groups.append([row])
    for group in groups:
        lasted = float(stamps[group[-1]] - stamps[group[0]])
        way = "backwards" if speeds[group[0]] < 0.0 else "forwards"
        how = f"{len(group)} times in {lasted:.1f} s" if len(group) > 1 else way
        yield Incident("reversal", float(stamps[group[0]]), lasted, f"{how}: {_why_reversing(record, group[0])}")


def _why_reversing(record: EpisodeRecord, row: int) -> str:
    stamp = float(record["stamp"][row])
    begun = [event for event in _events(record, "recovery") if 0.0 <= stamp - float(event["stamp"]) <= LEADS]
    moving = [event for event in begun if str(event["detail"]).partition(":")[0] in ("back_up", "drive_on")]
    if moving:
        return f"recovery {str(moving[-1]['detail']).partition(':')[0]}"
    return _ahead_text(record, max(row - 1, 0)) or "nothing was near"


def what_is_near(record: EpisodeRecord, row: int) -> tuple[str, float]:
    """Return what is nearest to the robot at a row, and how far away, m; an empty text where nothing is within
    ``NEAR``.
    """
    gap, person = float(record["clearance"][row]), float(record["clearance_people"][row])
    if person <= min(gap + 1e-3, NEAR):
        return f"person {_nearest_person(record, row)[0]}", max(person, 0.0)
    standing = "a wall, obstacle or teammate" if "team" in record.meta else "a wall or obstacle"
    return (standing, max(gap, 0.0)) if gap <= NEAR else ("", math.inf)


def _ahead_text(record: EpisodeRecord, row: int) -> str:
    """Return what is nearest and on which side, empty where nothing is near."""
    about, gap = what_is_near(record, row)
    if not about:
        return ""
    where = _nearest_person(record, row)[1] if about.startswith("person") else "away"
    return f"{about} {gap:.1f} m {where}"


def _nearest_person(record: EpisodeRecord, row: int) -> tuple[int, str]:
    """Return the id of the person whose body is nearest, and on which side of the robot that is."""
    x, y, theta = record["pose"][row]
    offsets = np.asarray(record["pedestrian_positions"][row], np.float64) - (x, y)
    nearest = int(np.nanargmin(np.hypot(*offsets.T) - record["pedestrian_radii"]))
    bearing = (math.atan2(offsets[nearest, 1], offsets[nearest, 0]) - theta + math.pi) % (2.0 * math.pi) - math.pi
    sides = "ahead" if abs(bearing) < math.pi / 4 else "behind" if abs(bearing) > 3 * math.pi / 4 else ""
    return int(record["pedestrian_ids"][nearest]), sides or ("to the left" if bearing > 0.0 else "to the right")


def _events(record: EpisodeRecord, kind: str) -> Iterator[dict[str, Any]]:
    return (event for event in record.meta.get("events", ()) if event["kind"] == kind)


def _row_at(record: EpisodeRecord, stamp: float) -> int:
    return min(int(np.searchsorted(record["stamp"], stamp - 1e-9)), len(record["stamp"]) - 1)
