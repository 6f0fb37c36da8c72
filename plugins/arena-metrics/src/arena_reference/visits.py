"""When people came to which of their waypoints, and how far they had walked until then."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from arena_core import PedestrianSpec
from arena_reference.arrays import Floats, Mask

REACH = 0.75  # m from a waypoint within which a person is there: the crowds' own 0.5 m and two steps of walking
Numbers = NDArray[np.int64]


@dataclass(frozen=True, slots=True, eq=False)
class Routes:
    """Where P people are to go: ``waypoints`` (P, W, 2) m, NaN behind the ``counts`` (P,) of each, in a loop or
    ``at_random`` (P,). Who belongs to the same ``group`` (P,) has the route of its first member, and any of them
    comes for all; -1 for nobody's.
    """

    waypoints: Floats
    counts: Numbers
    at_random: Mask
    group: Numbers


@dataclass(frozen=True, slots=True, eq=False)
class Visits:
    """The visits of the people of B worlds, in order, K at most: ``stamps`` (K, B, P) s and ``lengths`` (K, B, P) m
    walked until then, inf behind the last one, and ``waypoints`` (K, B, P), -1 there.
    """

    stamps: Floats
    lengths: Floats
    waypoints: Numbers

    def in_hand(self, end: float) -> Numbers:
        """Return the number of the visit that each person of the first world is on the way to at ``end`` s, (P,)."""
        found: Numbers = (self.stamps[:, 0] <= end).sum(axis=0)
        return found

    def missing(self, number: Numbers) -> Mask:
        """Return who of whom in which world has not made the visit of a ``number`` (P,), (B, P)."""
        found: Mask = np.isfinite(self.stamps).sum(axis=0) <= number
        return found

    def alike(self, world: int, number: Numbers) -> Mask:
        """Return who of a world made the same visits as in the first one up to this one, (P,), as far as both made
        them.
        """
        before = np.arange(len(self.waypoints))[:, None] <= number
        own, first = self.waypoints[:, world], self.waypoints[:, 0]
        same: Mask = ((own == first) | (own < 0) | (first < 0) | ~before).all(axis=0)
        return same


def routes_of(people: dict[int, PedestrianSpec], ids: NDArray[np.int32]) -> Routes:
    """Return the routes of people with these ids (P,), in their order; none for who is not among ``people``."""
    known = [people.get(name) for name in ids.tolist()]
    names = [None if person is None else person.behaviour.get("group") for person in known]
    leaders = [p if name is None else names.index(name) for p, name in enumerate(names)]
    own = [_waypoints(known[leader]) for leader in leaders]
    waypoints = np.full((len(ids), max(map(len, own), default=0), 2), np.nan)
    for p, points in enumerate(own):
        waypoints[p, : len(points)] = points
    counts = np.array([len(points) for points in own], np.int64)
    drawn = [known[leader] for leader in leaders]
    at_random = np.array([bool(person and person.behaviour.get("waypoint_mode")) for person in drawn], np.bool_)
    return Routes(
        waypoints,
        counts,
        at_random,
        np.array([-1 if n is None else g for n, g in zip(names, leaders, strict=True)], np.int64),
    )


def _waypoints(person: PedestrianSpec | None) -> Floats:
    return np.empty((0, 2)) if person is None else np.asarray(person.waypoints_xy, float).reshape(-1, 2)


def find_visits(stamps: Floats, positions: Floats, routes: Routes) -> Visits:
    """Return the visits of people at ``positions`` (R, B, P, 2), rows at ``stamps`` (R,).

    A visit is the first row within ``REACH`` of the waypoint that comes next; of who goes at random, of any but the
    last one. It begins where a straight walk from the row before comes within reach. Who comes to the two after the
    next one first has given that up.
    """
    away = _squared_distances(positions, routes)
    soonest = _rows_ahead(away < REACH**2)
    row, latest = np.zeros(away.shape[1:3], np.int64), np.full(away.shape[1:3], -1)
    made: list[tuple[Numbers, Numbers]] = []
    while away.shape[3]:
        found, number = _next_visit(soonest, routes, row, latest)
        if (found == len(away)).all():
            break
        latest = np.where(found < len(away), number, latest)
        made.append((found, np.where(found < len(away), number, -1)))
        row = np.minimum(found + 1, len(away))
    return _timed(stamps, positions, away, made)


def _next_visit(soonest: Numbers, routes: Routes, row: Numbers, latest: Numbers) -> tuple[Numbers, Numbers]:
    """Return the row of the next visit from ``row`` on and its waypoint, (B, P), when ``latest`` was visited last."""
    rows, counts = len(soonest) - 1, np.maximum(routes.counts, 1)
    following = [(latest + step) % counts for step in (1, 2, 3)]
    come = [_row_of(soonest, row, following[0]), _row_of(soonest, row, following[1])]
    skipped = (counts > 2) & (_row_of(soonest, come[1], following[2]) < come[0])
    found, number = np.where(skipped, come[1], come[0]), np.where(skipped, following[1], following[0])
    any_other = np.take_along_axis(soonest, row[None, ..., None], axis=0)[0]
    any_other = np.where(np.arange(soonest.shape[3]) == latest[..., None], rows, any_other)
    found = np.where(routes.at_random, any_other.min(axis=2), found)
    number = np.where(routes.at_random, any_other.argmin(axis=2), number)
    going = (routes.counts > 1) | ((routes.counts == 1) & (latest < 0))
    return np.where(going, found, rows), number


def _row_of(soonest: Numbers, row: Numbers, waypoint: Numbers) -> Numbers:
    """Return the first row from ``row`` on within reach of a waypoint, (B, P)."""
    worlds, people = np.indices(row.shape)
    found: Numbers = soonest[row, worlds, people, waypoint]
    return found


def _squared_distances(positions: Floats, routes: Routes) -> Floats:
    """Return how far each person, or the nearest of its group, is from each of its waypoints, squared, (R, B, P, W),
    m^2; inf for who is not there.
    """
    dx, dy = (positions[..., None, axis] - routes.waypoints[..., axis] for axis in (0, 1))
    away = dx * dx + dy * dy
    away[np.isnan(away)] = np.inf
    for group in np.unique(routes.group[routes.group >= 0]).tolist():
        members = routes.group == group
        away[:, :, members] = away[:, :, members].min(axis=2, keepdims=True)
    return away


def _rows_ahead(inside: Mask) -> Numbers:
    """Return the first row from each on in which it is so, (R + 1, ...); R where it never is again."""
    rows = len(inside)
    ahead = np.full((rows + 1, *inside.shape[1:]), rows)
    np.copyto(ahead[:-1], np.arange(rows).reshape(-1, 1, 1, 1), where=inside)
    np.minimum.accumulate(ahead[::-1], axis=0, out=ahead[::-1])
    return ahead


def _timed(stamps: Floats, positions: Floats, away: Floats, made: list[tuple[Numbers, Numbers]]) -> Visits:
    """Return visits by their rows and waypoints, with when they began and what had been walked until then."""
    shape = (len(made), *positions.shape[1:3])
    rows, numbers = (np.array([visit[part] for visit in made], np.int64).reshape(shape) for part in (0, 1))
    known = numbers >= 0
    here = np.where(known, rows, 0)
    before = np.maximum(here - 1, 0)
    worlds, people = np.indices(shape)[1:]
    far, near = (np.sqrt(away[row, worlds, people, np.maximum(numbers, 0)]) for row in (before, here))
    with np.errstate(invalid="ignore", divide="ignore"):
        share = np.where(known & np.isfinite(far) & (far > REACH), (far - REACH) / (far - near), 1.0)
    walked = walked_lengths(positions)
    lengths = walked[before, worlds, people] * (1.0 - share) + walked[here, worlds, people] * share
    times = stamps[before] * (1.0 - share) + stamps[here] * share
    return Visits(np.where(known, times, np.inf), np.where(known, lengths, np.inf), numbers)


def walked_lengths(positions: Floats) -> Floats:
    """Return how far people had walked in each row, (R, B, P), m; from where they vanish to where they appear is no
    walk.
    """
    steps = np.linalg.norm(np.diff(positions, axis=0), axis=3)
    walked = np.where(np.isfinite(steps), steps, 0.0).cumsum(axis=0)
    return np.concatenate((np.zeros((1, *walked.shape[1:])), walked))
