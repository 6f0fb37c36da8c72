"""What an episode is worth to the search, and what kind of failure it is."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from arena_break.course import Draft, place_along
from arena_break.driving import Episode
from arena_core import EpisodeRecord
from arena_reference.causes import Cause, cause_of, row_before

KINDS = ("success", "ran into a person", "was run into", "was run into while standing", "wall or obstacle", "other")
PERSON = "person"  # how an explanation calls whom the robot met
PEOPLE, PLACES = 4, 4  # bins of people near the robot at the failure (0, 1, 2, more), and of places along its way
WORTHLESS, UNCERTIFIED = -2.0, -1.5  # of a problem that cannot be driven; in which the clairvoyant does not get through
CLEAR = 1.0  # m of clearance, beyond which it does not count how much


@dataclass(frozen=True, slots=True)
class Worth:
    """What a problem is worth to the search.

    ``objective`` is below 0 where the planner gets through, by as much clearance, m; between 0 and 1 it is the share of
    the seeds of noise under which it fails; above 1 it fails under all of them, and the clairvoyant keeps that much
    (less 1) from people, m. ``kind`` is one of ``KINDS``, ``people`` how many are near the robot when it fails, or when
    someone is nearest to it, ``place`` 0 .. 1 where on its way that is.
    """

    objective: float
    kind: int
    people: int
    place: float

    @property
    def hard(self) -> bool:
        """Return whether the planner fails under every seed and the clairvoyant gets through with its margin."""
        return self.objective >= 1.0

    @property
    def measures(self) -> tuple[float, float, float]:
        """Return where it belongs among problems of other kinds."""
        return float(self.kind), float(min(self.people, PEOPLE - 1)), self.place


@dataclass(frozen=True, slots=True, eq=False)
class Trial:
    """What was driven of a problem: the planner's episode under the first seed of noise, None where it was refused; the
    share of the seeds under which it failed; and what the clairvoyant keeps from people all the way, m, None where it
    does not get through with its margin.
    """

    episode: Episode | None
    failed: float = 0.0
    clear: float | None = None

    @property
    def objective(self) -> float:
        """Return what a failure is worth."""
        if self.clear is None:
            return UNCERTIFIED
        return 1.0 + self.clear if self.failed >= 1.0 else self.failed


def worth_of(draft: Draft | None, trial: Trial, near: float) -> Worth:
    """Return what a problem is worth; people within ``near`` m are near the robot."""
    episode = trial.episode
    if draft is None or episode is None:
        return Worth(WORTHLESS, 0, 0, 0.0)
    if episode.error:
        return Worth(trial.objective, KINDS.index("other") if trial.clear is not None else 0, 0, 0.0)
    record = episode.record()
    cause = cause_of(record)
    row = row_before(record, cause.stamp) if cause else int(np.argmin(record["clearance_people"]))
    people, place = people_near(record, row, near), place_along(draft.route, record["pose"][row, :2].tolist())
    if cause is None:
        return Worth(-min(least_clearance(record), CLEAR), 0, people, place)
    return Worth(trial.objective, kind_of(cause) if trial.clear is not None else 0, people, place)


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


def fails(driven: Sequence[Mapping[str, Episode]], name: str) -> bool:
    """Return whether a problem was driven under every seed, and never with strict success."""
    return all(name in by_name and not by_name[name].strict for by_name in driven)
