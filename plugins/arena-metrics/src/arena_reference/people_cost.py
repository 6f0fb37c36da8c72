"""What a robot cost the people of an episode, against the same people without it (docs/social_metrics.md)."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from arena_core import EpisodeRecord
from arena_core.records import FindingColumn
from arena_reference.arrays import Floats, Mask
from arena_reference.twins import LONGEST, PLACEBO, RECORDED, WITHOUT, Twins
from arena_reference.visits import walked_lengths

STOPPED, WALKING = 0.1, 0.3  # m/s: below the one a person has stopped, above the other it walks again
COSTS = {
    "people_delay": ("s", "delay at the waypoint in hand, with the robot less without"),
    "people_detour": ("m", "way walked until then, with less without"),
    "people_displacement": ("m", "mean distance to where the person would have been"),
    "people_stops": ("-", "stops, with less without"),
}


def _columns() -> tuple[FindingColumn, ...]:
    three = [
        FindingColumn(name, unit, better, f"{text}{more}")
        for cost, (unit, text) in COSTS.items()
        for name, better, more in (
            (cost, "lower", ", mean over people"),
            (f"{cost}_worst", "lower", ", worst person"),
            (f"{cost}_floor", "neither", ": noise floor of the mean"),
        )
    ]
    return (
        *three,
        FindingColumn("aggregated_time", "s", "lower", "time of the robot and of all people to the waypoint in hand"),
        FindingColumn("people_compared", "-", "neither", "people with a waypoint in hand in both worlds"),
        FindingColumn("people_censored", "-", "neither", f"of those, who came there {LONGEST:g} s later or never"),
        FindingColumn("people_left_out", "-", "neither", "people who went to other waypoints than without the robot"),
        FindingColumn("note", "text", "neither", "why nothing is known, or what to know"),
    )


COLUMNS = _columns()


@dataclass(frozen=True, slots=True, eq=False)
class Difference:
    """What differs for each person (P,), NaN where that is not known, and by how much it does for a placebo."""

    cost: Floats
    noise: Floats


def cost_row(record: EpisodeRecord, twins: Twins) -> dict[str, float | str]:
    """Return a row of findings about one episode."""
    waypoints = _Waypoints(twins)
    displaced = _displacements(twins)
    stops = _stops(twins)
    found = {
        "people_delay": waypoints.difference(waypoints.stamps),
        "people_detour": waypoints.difference(waypoints.lengths),
        "people_displacement": displaced,
        "people_stops": Difference(stops[RECORDED] - stops[WITHOUT], np.abs(stops[PLACEBO] - stops[RECORDED])),
    }
    row: dict[str, float | str] = {}
    for name, difference in found.items():
        row |= _reduced(name, difference)
    duration = float(record["stamp"][-1] - record["stamp"][0])
    compared = waypoints.compared
    return row | {
        "aggregated_time": duration + float(waypoints.stamps[RECORDED, compared].sum()),
        "people_compared": float(compared.sum()),
        "people_censored": float((compared & waypoints.censored).sum()),
        "people_left_out": float(waypoints.left_out.sum()),
        "note": "",
    }


def _reduced(name: str, difference: Difference) -> dict[str, float]:
    """Return mean, worst and noise floor of what differs: 0 where no person's difference is above its own noise, nor
    their mean above its floor.
    """
    known = np.isfinite(difference.cost)
    if not known.any():
        return {name: math.nan, f"{name}_worst": math.nan, f"{name}_floor": math.nan}
    cost, noise = difference.cost[known], difference.noise[known]
    above = np.abs(cost) > noise
    floor = float(np.where(above, noise, 0.0).mean())
    mean = float(np.where(above, cost, 0.0).mean())
    worst = float(np.where(above, cost, 0.0).max())
    return {name: mean if abs(mean) > floor else 0.0, f"{name}_worst": worst, f"{name}_floor": floor}


class _Waypoints:
    """Each person's time and way to the waypoint in hand at the end of the episode, (3, P): censored where the person
    did not come there while it was driven on.
    """

    def __init__(self, twins: Twins) -> None:
        visits, last = twins.visits, float(twins.stamps[-1])
        number = visits.in_hand(twins.end)
        reached = np.full((3, len(number)), np.inf)
        length = reached.copy()
        people = np.flatnonzero(number < len(visits.stamps))
        reached[:, people] = visits.stamps[number[people], :, people].T
        length[:, people] = visits.lengths[number[people], :, people].T
        self.stamps, late = np.minimum(reached, last), ~np.isfinite(reached)
        self.lengths = np.where(late, _walked_at_last(twins), length)
        there = ~late[RECORDED] | ~late[WITHOUT]
        alike = visits.alike(WITHOUT, number)
        self.compared: Mask = there & alike
        self.left_out: Mask = there & ~alike
        self.censored: Mask = late[RECORDED] | late[WITHOUT]
        self._sure = visits.alike(PLACEBO, number)

    def difference(self, values: Floats) -> Difference:
        """Return with less without the robot, and what is noise of it; all is where the placebo went elsewhere."""
        cost = np.where(self.compared, values[RECORDED] - values[WITHOUT], np.nan)
        return Difference(cost, np.where(self._sure, np.abs(values[PLACEBO] - values[RECORDED]), np.abs(cost)))


def _walked_at_last(twins: Twins) -> Floats:
    found: Floats = walked_lengths(twins.positions)[-1]
    return found


def _displacements(twins: Twins) -> Difference:
    """Return each person's mean distance to where it would have been, and to where it is beside the placebo."""
    positions = twins.positions[: twins.rows]
    found = [_mean_distance(positions[:, RECORDED], positions[:, world]) for world in (WITHOUT, PLACEBO)]
    return Difference(*found)


def _mean_distance(one: Floats, other: Floats) -> Floats:
    """Return the mean distance of people in two worlds over the rows in which both are there, (P,); NaN without any."""
    distances = np.linalg.norm(one - other, axis=2)
    known = np.isfinite(distances)
    total = np.where(known, distances, 0.0).sum(axis=0)
    return np.where(known.any(axis=0), total / np.maximum(known.sum(axis=0), 1), np.nan)


def _stops(twins: Twins) -> Floats:
    """Return how often each person stopped in the episode, (3, P); NaN for who was never there."""
    speeds = np.linalg.norm(twins.velocities[: twins.rows], axis=3)
    state = np.where(speeds < STOPPED, 1, np.where(speeds > WALKING, 0, -1))
    rows = np.where(state >= 0, np.arange(len(state))[:, None, None], -1)
    latest = np.maximum.accumulate(rows, axis=0)
    held = np.where(latest >= 0, np.take_along_axis(state, np.maximum(latest, 0), axis=0), 1)
    stops = ((held[1:] == 1) & (held[:-1] == 0)).sum(axis=0).astype(float)
    return np.where(np.isfinite(speeds).any(axis=0), stops, np.nan)


def empty_row(note: str) -> dict[str, float | str]:
    """Return the row of an episode of which nothing is known, and why."""
    return {column.name: note if column.unit == "text" else math.nan for column in COLUMNS}


def free_row(record: EpisodeRecord, note: str) -> dict[str, float | str]:
    """Return the row of an episode whose people walk as they do whatever a robot does."""
    people = float(np.isfinite(record["pedestrian_positions"]).all(axis=2).any(axis=0).sum())
    row: Mapping[str, float | str] = {name: 0.0 for name in (column.name for column in COLUMNS[:-1])}
    return {**row, "aggregated_time": math.nan, "people_compared": people, "note": note}
