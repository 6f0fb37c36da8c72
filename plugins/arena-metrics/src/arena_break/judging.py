"""What an episode is worth to the search, and what kind of failure it is."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from arena_break.course import Draft, place_along
from arena_break.driving import Episode
from arena_core import EpisodeRecord
from arena_reference.causes import Cause, cause_of, row_before

KINDS = ("success", "ran into a person", "was run into", "was run into while standing", "wall or obstacle", "other")
PERSON = "person"  # how an explanation calls whom the robot met
PEOPLE, PLACES = 4, 4  # bins of people near the robot at the failure (0, 1, 2, more), and of places along its way
WORTHLESS = -2.0  # of a problem that cannot be driven, or is not certified
CLEAR = 1.0  # m of clearance, beyond which it does not count how much


@dataclass(frozen=True, slots=True)
class Worth:
    """What a problem is worth to the search: below 0 the planner gets through, by as much clearance, m; above 1 it
    fails, and the clairvoyant keeps that much (less 1) from people, m.

    ``kind`` is one of ``KINDS``, ``people`` how many are near the robot when it fails, or when someone is nearest to
    it, ``place`` 0 .. 1 where on its way that is.
    """

    objective: float
    kind: int
    people: int
    place: float

    @property
    def hard(self) -> bool:
        """Return whether the planner fails and the clairvoyant gets through with its margin."""
        return self.objective >= 1.0

    @property
    def measures(self) -> tuple[float, float, float]:
        """Return where it belongs among problems of other kinds."""
        return float(self.kind), float(min(self.people, PEOPLE - 1)), self.place


def worth_of(draft: Draft | None, episode: Episode | None, clear: float | None, near: float) -> Worth:
    """Return what a problem is worth; ``clear`` is what the clairvoyant keeps from people all the way, m, None where it
    does not get through with its margin.
    """
    if draft is None or episode is None:
        return Worth(WORTHLESS, 0, 0, 0.0)
    if episode.error:
        return Worth(WORTHLESS if clear is None else 1.0 + min(clear, CLEAR), KINDS.index("other"), 0, 0.0)
    record = episode.record()
    cause = cause_of(record)
    row = row_before(record, cause.stamp) if cause else int(np.argmin(record["clearance_people"]))
    people, place = people_near(record, row, near), place_along(draft.route, record["pose"][row, :2].tolist())
    if cause is None:
        return Worth(-min(least_clearance(record), CLEAR), 0, people, place)
    kind = kind_of(cause)
    return Worth(-1.5 if clear is None else 1.0 + min(clear, CLEAR), 0 if clear is None else kind, people, place)


def kind_of(cause: Cause) -> int:
    """Return which of ``KINDS`` a cause is."""
    if cause.what == "ran into":
        return 1 if cause.whom.startswith(PERSON) else 4
    if cause.what.startswith("was run into"):
        return 3 if cause.what.endswith("standing") else 2
    return 5


def least_clearance(record: EpisodeRecord) -> float:
    """Return how near a person came to the robot, m; inf where there is no one."""
    return max(float(np.min(record["clearance_people"])), 0.0)


def people_near(record: EpisodeRecord, row: int, near: float) -> int:
    """Return how many people are within so many metres of the robot's middle at a row."""
    away = np.hypot(*(np.asarray(record["pedestrian_positions"][row], np.float64) - record["pose"][row, :2]).T)
    return int(np.count_nonzero(away <= near))


def certified_clearance(episode: Episode | None, margin: float) -> float | None:
    """Return what the clairvoyant keeps from people all the way, m, up to ``CLEAR``; None where it does not get through
    with the margin.
    """
    if episode is None or episode.error or not episode.strict:
        return None
    clear = least_clearance(episode.record())
    return min(clear, CLEAR) if clear >= margin - 1e-3 else None
