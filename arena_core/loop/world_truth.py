"""The truth of one world that an episode loop drives, as privileged parts of a brain are shown it; of a team, too."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from arena_core.base.errors import ConfigurationError
from arena_core.contracts.simulation import Branches, Simulator, Snapshot
from arena_core.contracts.truth import PeopleAhead
from arena_core.values.episode import Scenario, WorldState
from arena_core.values.geometry import FloatArray
from arena_core.values.robot import Robot
from arena_core.values.world import Crowd

LONGEST = 600.0  # s ahead


class DrivenWorlds(Protocol):
    """Worlds as they are now: those of an ``EpisodeLoop``, or others that can be forked."""

    @property
    def snapshot(self) -> Snapshot:
        """Return what is now."""
        ...

    @property
    def inner_step(self) -> float:
        """Return the length of a tick, s."""
        ...

    def fork(self, branches: Branches) -> Simulator:
        """Return worlds that go on from these."""
        ...


class WorldTruth:
    """The truth of world ``slot`` of a loop; what it tells never changes that world."""

    def __init__(self, loop: DrivenWorlds, slot: int, scenario: Scenario) -> None:
        self._loop, self._slot = loop, slot
        self._row = slot  # of the robot in the arrays of snapshots
        self.scenario = scenario
        self.team: Sequence[TeamWorldTruth] = ()

    def __deepcopy__(self, memo: dict[int, Any]) -> WorldTruth:
        """Return this one: the world is not the brain's to copy."""
        return self

    def state(self) -> WorldState:
        """Return what is true now."""
        return self._loop.snapshot.state(self._row)

    def fork(self, streams: Sequence[int] = (0,), *, robots: bool = True) -> Simulator:
        """Return worlds that go on from this one, one for each of ``streams``."""
        return self._loop.fork(Branches.of([self._slot] * len(streams), streams, robots=robots))

    def people_ahead(self, times: ArrayLike) -> PeopleAhead:
        """Return where people will be, as if no robot were there."""
        ticks = _ticks_of(np.asarray(times, np.float64), self._loop.inner_step)
        future, stands = self.fork(robots=False), np.zeros((1, 3))
        crowds = [future.advance(stands, int(step)).crowd for step in np.diff(ticks, prepend=0)]
        now = crowds[0] if crowds else self._loop.snapshot.crowd.take(np.array((self._slot,)))
        count = int(now.counts[0])
        return PeopleAhead(
            np.asarray(ticks * self._loop.inner_step, np.float64),
            now.ids[0, :count].copy(),
            _along(crowds, "positions", count),
            _along(crowds, "velocities", count),
            now.radii[0, :count].copy(),
        )


class TeamWorldTruth(WorldTruth):
    """The truth of robot ``member`` of the team in the one world of a loop; ``shared`` is the same for all of them."""

    def __init__(
        self, loop: DrivenWorlds, member: int, scenario: Scenario, robot: Robot, shared: dict[str, Any]
    ) -> None:
        super().__init__(loop, 0, scenario)
        self._row, self.robot, self.shared = member, robot, shared


def truths_of_team(loop: DrivenWorlds, scenario: Scenario, robots: Sequence[Robot]) -> list[TeamWorldTruth]:
    """Return the truth of each of a scenario's ``robots`` in the one world of a loop."""
    shared: dict[str, Any] = {}
    team = [
        TeamWorldTruth(loop, member, scenario.seen_by(member), robot, shared) for member, robot in enumerate(robots)
    ]
    for truth in team:
        truth.team = team
    return team


def _along(crowds: Sequence[Crowd], name: str, count: int) -> FloatArray:
    """Return what crowds of one world say of each person, (P, H, 2)."""
    steps = [getattr(crowd, name)[0, :count] for crowd in crowds]
    return np.stack(steps, axis=1) if steps else np.empty((count, 0, 2))


def _ticks_of(times: FloatArray, inner_step: float) -> NDArray[np.int64]:
    if times.ndim != 1 or not (np.diff(times, prepend=0.0) >= 0.0).all() or not (times <= LONGEST).all():
        raise ConfigurationError(f"times ahead are {times.tolist()}; allowed: rising, from 0 to {LONGEST:g} s")
    return np.rint(times / inner_step).astype(np.int64)
