"""N worlds that are driven in step: commands on their way to the robots, and how episodes end.

A benchmark drives one, training many.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from arena_core.base.errors import ImpossibleScenario
from arena_core.contracts.simulation import Branches, Simulator, Snapshot
from arena_core.values.episode import Outcome, Scenario
from arena_core.values.geometry import FloatArray
from arena_core.values.success import ARRIVAL_SLACK

Flags = NDArray[np.bool_]
Slots = NDArray[np.int64]
NEVER = np.iinfo(np.int64).max
AT_ONCE = np.zeros(1, np.int64)


class CommandQueue:
    """Commands under way to N robots; each acts when its delay is over, until the next one does.

    Until the first one, a robot stands.
    """

    def __init__(self, robots: int) -> None:
        self._acting = np.zeros((robots, 3))
        self._commands = np.empty((0, robots, 3))  # under way, in the order in which they were sent
        # the tick of each from which on it acts; NEVER where it did, or was overtaken
        self._due = np.empty((0, robots), np.int64)
        self._now = 0

    def clear(self, slots: Slots) -> None:
        """Forget the commands of these robots, which then stand."""
        self._acting = self._acting.copy()
        self._acting[slots] = 0.0
        self._due[:, slots] = NEVER

    def send(self, commands: FloatArray, delays: NDArray[np.int64]) -> None:
        """Queue commands (N, 3) that act after ``delays`` (N,) ticks; one that overtakes older ones replaces them."""
        if not len(self._due) and not delays.any():
            self._acting = commands
            return
        due = np.broadcast_to(self._now + delays, len(commands))
        self._due[self._due >= due] = NEVER
        waiting = (self._due < NEVER).any(axis=1)
        self._due = np.vstack((self._due[waiting], due))
        self._commands = np.concatenate((self._commands[waiting], commands[None]))

    def segments(self, ticks: int) -> Iterator[tuple[FloatArray, int]]:
        """Yield (commands (N, 3), ticks) for so many ticks from now on."""
        end = self._now + ticks
        while self._now < end:
            until = end
            if len(self._due):
                self._let_act()
                until = min(end, int(self._due.min(initial=NEVER)))
            passed, self._now = until - self._now, until
            yield self._acting, passed

    def _let_act(self) -> None:
        """Let the commands act that are due now, the newest of each robot last."""
        due = self._due <= self._now
        if due.any():
            self._acting = self._acting.copy()
            for commands, acts in zip(self._commands, due, strict=True):
                self._acting[acts] = commands[acts]
            self._due[due] = NEVER
        waiting = (self._due < NEVER).any(axis=1)
        self._due, self._commands = self._due[waiting], self._commands[waiting]


@dataclass(frozen=True, slots=True, eq=False)
class Verdicts:
    """What the judge says of N worlds at one instant, (N,) each, at most one of the first three being true.

    ``arrived``: arrival was claimed, and is true; ``mistaken``: it is not; ``collided``: a contact began since the
    instant before. ``failed``: this was the last collision that is allowed, or the simulation cannot go on;
    ``timed_out``: the time is over, and no arrival was claimed.
    """

    arrived: Flags
    mistaken: Flags
    collided: Flags
    failed: Flags
    timed_out: Flags

    def outcome(self, slot: int) -> Outcome | None:
        """Return how the episode of a world ends now, or None."""
        if self.arrived[slot]:
            return "goal_reached"
        if self.mistaken[slot]:
            return "false_arrival"
        if self.failed[slot]:
            return "collision"
        return "time_out" if self.timed_out[slot] else None


class EpisodeLoop:
    """N episodes in the worlds of one simulator, a control period at a time; slot k is bit for bit what it is alone.

    In worlds of ``team`` robots each the arrays of N have a row for each robot instead, as snapshots do; ``robots`` is
    the number of rows.

    ``snapshot`` is what is now. ``collisions`` (N,) counts them since each episode began; at ``collisions_to_end`` of
    them it ends (None: at no number). ``goals`` (N, 3) are in ``map``, ``ticks`` are those of a control period,
    of ``inner_step`` s each.
    """

    snapshot: Snapshot

    def __init__(
        self, simulator: Simulator, control_period: float, worlds: int, collisions_to_end: int | None, *, team: int = 1
    ) -> None:
        self._simulator, self.worlds, self._team = simulator, worlds, team
        self._collisions_to_end = NEVER if collisions_to_end is None else collisions_to_end
        self.robots = worlds * team
        self._queue = CommandQueue(self.robots)
        self._all = np.arange(worlds)
        self.inner_step = simulator.inner_step
        self.ticks = round(control_period / self.inner_step)
        self.goals = np.zeros((self.robots, 3))
        self.goal_radii, self.time_limits = np.zeros(self.robots), np.zeros(self.robots)
        self.collisions = np.zeros(self.robots, np.int64)

    def begin(self, scenarios: Sequence[Scenario], slots: Slots | None = None) -> Snapshot:
        """Begin episodes: in all worlds, or in these slots while the others go on.

        Raises ImpossibleScenario for doors in a simulator that has none.
        """
        self.snapshot = self._simulator.reset(scenarios, slots)
        with_doors = next((scenario.name for scenario in scenarios if scenario.doors), None)
        if with_doors is not None and self.snapshot.doors_open is None:
            simulator = type(self._simulator).__name__
            raise ImpossibleScenario(f"{with_doors}: has doors, and {simulator} has none; allowed: scenarios without")
        slots = self._all if slots is None else slots
        if self._team > 1:
            slots = (slots[:, None] * self._team + np.arange(self._team)).reshape(-1)
            scenarios = [scenario.seen_by(member) for scenario in scenarios for member in range(self._team)]
        self._queue.clear(slots)
        self.goals[slots] = [scenario.goal.array() for scenario in scenarios]
        self.goal_radii[slots] = [scenario.goal_radius for scenario in scenarios]
        self.time_limits[slots] = [scenario.time_limit for scenario in scenarios]
        self.collisions[slots] = 0
        return self.snapshot

    def drive(self, commands: FloatArray, delays: NDArray[np.int64] = AT_ONCE) -> Snapshot:
        """Drive for one control period; ``commands`` (N, 3) in ``base_link`` act after ``delays`` (N,) ticks."""
        self._queue.send(commands, delays)
        self.snapshot = join_snapshots(
            [self._simulator.advance(acting, ticks) for acting, ticks in self._queue.segments(self.ticks)]
        )
        self.collisions += [len(contacts) for contacts in self.snapshot.contacts]
        return self.snapshot

    def fork(self, branches: Branches) -> Simulator:
        """Return worlds that go on from these, as they are now."""
        return self._simulator.fork(branches)

    def goal_distances(self) -> FloatArray:
        """Return how far each robot really is from its goal, (N,) m."""
        return np.hypot(self.snapshot.poses[:, 0] - self.goals[:, 0], self.snapshot.poses[:, 1] - self.goals[:, 1])

    def judge(self, claims: Flags) -> Verdicts:
        """Judge what is now; ``claims`` (N,) say which navigators believe to have arrived."""
        near = self.goal_distances() <= self.goal_radii + ARRIVAL_SLACK
        collided = np.array([len(contacts) > 0 for contacts in self.snapshot.contacts]) & ~claims
        failed = collided & (self.collisions >= self._collisions_to_end)
        failed[[slot for slot in self.snapshot.failures if not claims[slot]]] = True
        timed_out = (self.snapshot.stamps >= self.time_limits - 1e-9) & ~claims
        return Verdicts(claims & near, claims & ~near, collided, failed, timed_out)


def join_snapshots(snapshots: Sequence[Snapshot]) -> Snapshot:
    """Return the last of some snapshots in a row, with the contacts and the times in contact of all."""
    if len(snapshots) == 1:
        return snapshots[0]
    contacts = tuple(
        tuple(contact for part in parts for contact in part)
        for parts in zip(*(s.contacts for s in snapshots), strict=True)
    )
    times = np.sum([snapshot.contact_times for snapshot in snapshots], axis=0)
    return replace(snapshots[-1], contacts=contacts, contact_times=times)
