"""One episode three times over: as recorded, with the robot a millimetre aside, and without it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from arena_core import Branches, EpisodeRecord, ImpossibleScenario, Pose, Scenario, Snapshot
from arena_core.hosting import Benchmark
from arena_reference.arrays import Floats
from arena_reference.redriving import Driven, control_ticks, redrive
from arena_reference.visits import Routes, Visits, find_visits, routes_of

RECORDED, PLACEBO, WITHOUT = 0, 1, 2  # the three worlds
ASIDE = 0.001  # m between the robot and its placebo
BLOCKS = (
    5.0,
    5.0,
    5.0,
    5.0,
    10.0,
    10.0,
    10.0,
    10.0,
)  # s that people are driven on for at a time when the episode is over
LONGEST = sum(BLOCKS)  # s at most
# ways of starting (docs/scenarios.md): once the robot is there, and at a time
TRIGGERS, TIMER = ("trigger_zone", "signal_wait", "signal_proceed"), "wait_timer"


@dataclass(frozen=True, slots=True, eq=False)
class Twins:
    """The people of three worlds: ``stamps`` (R,) s, of which the first ``rows`` are the episode's; ``positions`` (R,
    3, P, 2) m and ``velocities`` (R, 3, P, 2) m/s, NaN for who is not there; and their ``visits`` to waypoints.
    """

    stamps: Floats
    rows: int
    positions: Floats
    velocities: Floats
    visits: Visits

    @property
    def end(self) -> float:
        """Return when the episode was over, s."""
        return float(self.stamps[self.rows - 1])


def drive_twins(benchmark: Benchmark, record: EpisodeRecord, scenario: Scenario) -> Twins:
    """Drive the worlds of an episode to its end, then its people on without any robot until each has come to the
    waypoint that it was on the way to, for ``LONGEST`` s at most.

    Raises RecordDiffers where the robot comes elsewhere than recorded, and ConfigurationError where the simulator or
    its people cannot be forked.
    """
    driven = _begin(benchmark, scenario, _without_triggers(benchmark, record, scenario))
    walk = [_people(snapshot) for snapshot in redrive(benchmark, record, driven)]
    stamps, rows = list(map(float, record["stamp"])), len(walk)
    routes = routes_of({person.id: person for person in scenario.pedestrians}, driven.snapshot.crowd.ids[0])
    for block in _drive_on(benchmark, driven):
        twins = _gather(stamps, rows, walk, routes)
        if not _awaited(twins, routes):
            break
        walk += block
        stamps += [stamps[-1] + benchmark.navigator.control_period * (k + 1) for k in range(len(block))]
    return _gather(stamps, rows, walk, routes)


def _begin(benchmark: Benchmark, scenario: Scenario, calm: Scenario) -> Driven:
    """Return the three worlds at their beginning."""
    for x, y in ((0.0, 1.0), (0.0, -1.0), (1.0, 0.0), (-1.0, 0.0)):
        start = scenario.start
        shifted = replace(scenario, start=Pose(start.x + ASIDE * x, start.y + ASIDE * y, start.theta))
        try:
            benchmark.simulator.reset([scenario, shifted, calm])
        except ImpossibleScenario:
            continue
        worlds = Branches(np.arange(3), np.zeros(3, np.uint64), np.array([[True], [True], [False]]))
        simulator = benchmark.simulator.fork(worlds)
        return Driven(simulator, simulator.advance(np.zeros((3, 3)), 0))
    raise ImpossibleScenario(f"{scenario.name}: the robot's start has no room for a placebo {ASIDE:g} m aside")


def _without_triggers(benchmark: Benchmark, record: EpisodeRecord, scenario: Scenario) -> Scenario:
    """Return a problem in which those who start when the robot comes start when it came in this episode."""
    waiting = [person.behaviour.get("start_up_mode") in TRIGGERS for person in scenario.pedestrians]
    if not any(waiting):
        return scenario
    released = _release_times(benchmark, record, scenario)
    people = [
        replace(person, behaviour={**person.behaviour, "start_up_mode": TIMER, "wait_time": released[person.id]})
        if waits and person.id in released
        else person
        for person, waits in zip(scenario.pedestrians, waiting, strict=True)
    ]
    return replace(scenario, pedestrians=tuple(people))


def _release_times(benchmark: Benchmark, record: EpisodeRecord, scenario: Scenario) -> dict[int, float]:
    """Return when each person first was in another state than at the beginning, s, by id."""
    driven = Driven(benchmark.simulator, benchmark.simulator.reset([scenario]))
    states = np.array([snapshot.crowd.states[0].copy() for snapshot in redrive(benchmark, record, driven)])
    other = states != states[0]
    ids = driven.snapshot.crowd.ids[0]
    first = other.argmax(axis=0)
    return {int(ids[p]): float(record["stamp"][first[p]]) for p in np.flatnonzero(other.any(axis=0))}


def _drive_on(benchmark: Benchmark, driven: Driven) -> Iterator[list[tuple[Floats, Floats]]]:
    """Yield what people do after the episode, block by block, the robots taken away."""
    alone = driven.simulator.fork(Branches.of([RECORDED, PLACEBO, WITHOUT], robots=False))
    period, stands = benchmark.navigator.control_period, np.zeros((3, 3))
    for block in BLOCKS:
        yield [_people(alone.advance(stands, control_ticks(benchmark))) for _ in range(round(block / period))]


def _people(snapshot: Snapshot) -> tuple[Floats, Floats]:
    return snapshot.crowd.positions, snapshot.crowd.velocities


def _awaited(twins: Twins, routes: Routes) -> bool:
    """Return whether a person is still on the way to the waypoint in hand in any of the worlds."""
    number = twins.visits.in_hand(twins.end)
    walks = (routes.counts > 1) | ((routes.counts == 1) & (number == 0))
    return bool(twins.visits.missing(number)[:, walks].any())


def _gather(stamps: list[float], rows: int, walk: list[tuple[Floats, Floats]], routes: Routes) -> Twins:
    positions, velocities = (np.array([step[part] for step in walk], np.float64) for part in (0, 1))
    times = np.array(stamps)
    return Twins(times, rows, positions, velocities, find_visits(times, positions, routes))
