"""The last moment at which a contact could still have been avoided, found in forks of the world as it was recorded."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import islice

import numpy as np

from arena_core import Branches, EpisodeRecord, Scenario, Simulator, Snapshot
from arena_core.hosting import Benchmark, Truth, WorldTruth
from arena_reference.arrays import Floats
from arena_reference.outlook import foresee, part_of
from arena_reference.redriving import Driven, redrive
from arena_reference.ways import Way, WayFinder, rehearse

AFTER = 4.0  # s after the contact that a way out has to lead to
FIRST = 0.1  # s before the contact, where the search for the moment begins; twice as far each time
STILL = 0.025  # m/s, up to which a way stands


class HeldWorld:
    """One world at one instant, which can be asked and forked again and again."""

    def __init__(self, simulator: Simulator) -> None:
        self._simulator, self.inner_step = simulator, simulator.inner_step
        self.snapshot: Snapshot = simulator.advance(np.zeros((1, 3)), 0)

    def fork(self, branches: Branches) -> Simulator:
        """Return worlds that go on from this one."""
        return self._simulator.fork(branches)


@dataclass(frozen=True, slots=True, eq=False)
class Moment:
    """Until when a contact could be avoided, s, None where that was not found; and the way out from there."""

    stamp: float | None
    way: Way | None


def drive_again(
    benchmark: Benchmark, record: EpisodeRecord, scenario: Scenario, since: float, until: float
) -> Iterator[tuple[float, Truth]]:
    """Drive the recorded commands and yield time, s, and truth of each control step from ``since`` to ``until``, s.

    Raises RecordDiffers where the robot comes elsewhere.
    """
    driven = Driven(benchmark.simulator, benchmark.simulator.reset([scenario]))
    for snapshot in islice(redrive(benchmark, record, driven), len(record["stamp"]) - 1):
        if since - 1e-9 <= snapshot.stamps[0] <= until + 1e-9:
            held = HeldWorld(benchmark.simulator.fork(Branches.of([0])))
            yield float(snapshot.stamps[0]), WorldTruth(held, 0, scenario)
        if snapshot.stamps[0] > until:
            break


def last_avoidable(worlds: Sequence[Truth], finder: WayFinder, contact: float) -> Moment:
    """Return the last of some worlds in a row from which the robot gets away from what it touches at ``contact`` s.

    A search may miss a way: the moment is one from which a way out was driven, and a step later none was found.
    """
    before, ways = len(worlds), dict[int, Way | None]()

    def way_from(k: int) -> Way | None:
        if k not in ways:
            ways[k] = way_out(worlds[k], finder, contact)
        return ways[k]

    stamps = [world.state().stamp for world in worlds]
    away, early, late = FIRST, None, before
    while early is None and late > 0:
        k = max(int(np.searchsorted(stamps, contact - away)) - 1, 0)
        if k < late and way_from(k) is not None:
            early = k
        else:
            late = min(late, k)
            if k == 0:
                break
        away *= 2.0
    if early is None:
        return Moment(None, None)
    while late - early > 1:
        middle = (early + late) // 2
        early, late = (middle, late) if way_from(middle) is not None else (early, middle)
    return Moment(stamps[early], ways[early])


def way_out(truth: Truth, finder: WayFinder, contact: float) -> Way | None:
    """Return a way that was driven from here past the contact, or to the goal, without touching anything."""
    now = truth.state().stamp
    until = min(contact - now + AFTER, truth.scenario.time_limit - now)
    people = foresee(truth, until, part_of(finder.control_period))
    for attempt in finder.attempts:
        way = finder.find(truth, people, attempt, open_end=True)
        if way is None or not (way.arrives or way.arrival >= now + until - 1.0):
            continue
        if rehearse(truth, way).touched == math.inf:
            return way
    return None


def in_words(way: Way) -> str:
    """Return what a way does in its first second, by where it leads, beside what the robot did when it began."""
    first = way.states[: max(2, round(1.0 / way.period) + 1)]
    time, before = way.period * (len(first) - 1), float(first[0, 3])
    along, left = _displacement(first)
    if math.hypot(along, left) <= STILL * time:
        turned = (float(first[-1, 2] - first[0, 2]) + math.pi) % (2.0 * math.pi) - math.pi
        return f"turning on the spot{_side(turned, 0.2)}" if abs(turned) >= 0.2 else _halting(before)
    aside = _side(math.atan2(left, abs(along)), 0.1)
    if along < -STILL * time:
        return f"reversing{' on' if before < -STILL else ''}{aside}"
    if before < STILL:
        return f"driving off{aside}"
    if along < 0.6 * before * time:
        return f"slowing down{aside}"
    return f"turning{aside}" if aside else "driving on"


def _displacement(states: Floats) -> tuple[float, float]:
    """Return how far the last of some states is from the first one, ahead of that and to its left, m."""
    x, y, theta = states[0, :3]
    dx, dy = states[-1, 0] - x, states[-1, 1] - y
    return math.cos(theta) * dx + math.sin(theta) * dy, math.cos(theta) * dy - math.sin(theta) * dx


def _halting(before: float) -> str:
    return "stopping" if abs(before) > STILL else "standing"


def _side(angle: float, least: float) -> str:
    return "" if abs(angle) < least else " to the left" if angle > 0.0 else " to the right"
