"""Why an episode is no strict success, as its record tells."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from arena_core import EpisodeRecord
from arena_core.records import is_success

PERSON = 2  # contact_kind of a contact with a person
STANDING = 0.03  # m/s and rad/s (of 10 times as much), below which a robot stands
AT_LEAST = 0.3  # s for which a robot stood that was run into while standing
STOOD = 0.4  # share of a time-out in which a robot that stood too long stood
LOST = 0.5  # m between estimate and truth, from which on a pose is lost
TURNS_BACK = 0.5  # changes between forward and backward a second, from which on a robot oscillates

CAUSES = (
    "ran into",
    "was run into while driving",
    "was run into while standing",
    "lost its pose",
    "no path",
    "error",
    "stood too long",
    "oscillated",
    "too slow",
)


@dataclass(frozen=True, slots=True)
class Contact:
    """A contact of an episode: when, s, with whom or what, whether the robot ran into it, and how fast, m/s.

    It did where at least half of the speed at which both came together was its own: who backs away, or hardly moves,
    does not run into a person who walks on.
    """

    stamp: float
    whom: str
    caused: bool
    speed: float


@dataclass(frozen=True, slots=True)
class Cause:
    """Why an episode failed: one of ``CAUSES``, with whom, and when that was decided, s."""

    what: str
    whom: str
    stamp: float


def contacts_of(record: EpisodeRecord) -> list[Contact]:
    """Return the contacts of an episode, in order."""
    stamps, speeds = record["contact_stamp"].tolist(), record["contact_speed"].tolist()
    return [
        Contact(stamp, _name_of(record, i), _is_own(record, i), speed)
        for i, (stamp, speed) in enumerate(zip(stamps, speeds, strict=True))
    ]


def _name_of(record: EpisodeRecord, i: int) -> str:
    kind, number = int(record["contact_kind"][i]), int(record["contact_person"][i])
    return ("a wall", "an obstacle", f"person {number}", f"robot {number}")[kind]


def _is_own(record: EpisodeRecord, i: int) -> bool:
    """Return whether the robot brought at least half of the speed at which it met what it touched in contact ``i``."""
    rows = np.flatnonzero(record["pedestrian_ids"] == record["contact_person"][i])
    if record["contact_kind"][i] != PERSON or not record["contact_caused"][i] or len(rows) == 0:
        return bool(record["contact_caused"][i])
    row, person = row_before(record, float(record["contact_stamp"][i])), int(rows[0])
    (x, y, theta), (vx, vy, wz) = record["pose"][row], record["twist"][row]
    touched = record["contact_position"][i]
    c, s = math.cos(theta), math.sin(theta)
    surface = (c * vx - s * vy - wz * (touched[1] - y), s * vx + c * vy + wz * (touched[0] - x))
    towards = np.asarray(record["pedestrian_positions"][row, person], np.float64) - touched
    walked = np.asarray(record["pedestrian_velocities"][row, person], np.float64)
    return not float(np.dot(towards, surface)) < float(-np.dot(towards, walked))


def row_before(record: EpisodeRecord, stamp: float) -> int:
    """Return the last row before a time."""
    return max(int(np.searchsorted(record["stamp"], stamp)) - 1, 0)


def cause_of(record: EpisodeRecord) -> Cause | None:
    """Return why an episode is no strict success; None where it is one. The first contact decides, whatever follows."""
    contacts = contacts_of(record)
    end = float(record["stamp"][-1])
    if contacts:
        first = contacts[0]
        return Cause(_kind_of(record, first), first.whom, first.stamp)
    if is_success(record, collisions_allowed=0):
        return None
    if record.meta["outcome"] == "error":
        return Cause("no path" if "path" in str(record.meta["error"]).lower() else "error", "", end)
    if record.meta["outcome"] == "false_arrival" or _is_lost(record):
        return Cause("lost its pose", "", _lost_since(record))
    return Cause(_slow_kind(record), "", end)


def _kind_of(record: EpisodeRecord, contact: Contact) -> str:
    if contact.caused:
        return "ran into"
    return f"was run into while {'standing' if _stood_before(record, contact.stamp) else 'driving'}"


def _stood_before(record: EpisodeRecord, stamp: float) -> bool:
    """Return whether a robot stood for ``AT_LEAST`` s before a time; a disc that turns on the spot stands."""
    last = row_before(record, stamp)
    first = min(row_before(record, stamp - AT_LEAST), last)
    vx, vy, wz = np.abs(record["twist"][first : last + 1]).T
    turns = 0.0 if not record.meta["robot"]["footprint"]["vertices_xy"] else float(wz.max())
    return float(np.hypot(vx, vy).max()) < STANDING and turns < 10.0 * STANDING


def stands_of(record: EpisodeRecord) -> NDArray[np.bool_]:
    """Return (T,) whether the robot stands."""
    twist = record["twist"]
    return np.asarray((np.hypot(twist[:, 0], twist[:, 1]) < STANDING) & (np.abs(twist[:, 2]) < 10.0 * STANDING))


def _off(record: EpisodeRecord) -> NDArray[np.float64]:
    return np.asarray(np.hypot(*(record["estimate"][:, :2] - record["pose"][:, :2]).T))


def _is_lost(record: EpisodeRecord) -> bool:
    off = _off(record)
    known = off[np.isfinite(off)]
    return bool(len(known) and known[-1] > LOST)


def _lost_since(record: EpisodeRecord) -> float:
    """Return since when the estimate has been off, s; the end where it is not."""
    off = np.nan_to_num(_off(record), nan=math.inf)
    fine = np.flatnonzero(off <= LOST)
    row = min(int(fine[-1]) + 1, len(off) - 1) if len(fine) else 0
    return float(record["stamp"][row])


def _slow_kind(record: EpisodeRecord) -> str:
    if float(stands_of(record).mean()) >= STOOD:
        return "stood too long"
    speeds = record["twist"][:, 0]
    moving = speeds[np.abs(speeds) > STANDING]
    changes = int(np.count_nonzero(np.diff(np.sign(moving))))
    time = max(float(record["stamp"][-1] - record["stamp"][0]), 1e-9)
    return "oscillated" if changes / time >= TURNS_BACK else "too slow"
