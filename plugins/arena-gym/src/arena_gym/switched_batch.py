"""N worlds whose actions choose which planner drives."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from arena_core import ConfigurationError, ObservationBatch, Snapshot
from arena_gym.batch import Flags, Floats, NavigationBatch, Slots, Step
from arena_gym.building import Parts


class SwitchedBatch(NavigationBatch):
    """Drives N robots by members that a policy chooses among, for some control steps at a time;
    slot k is what it is alone.
    """

    def __init__(self, parts: Parts, worlds: int, *, team: int = 1) -> None:
        super().__init__(parts, worlds, team=team)
        assert parts.switch is not None
        self._steps_of_action = parts.switch.every * parts.switch.held
        self._members = len(parts.switch.members)
        self._drivers = [parts.switch.make_driver() for _ in range(self.robots)]
        self._places: list[tuple[ObservationBatch, int] | None] = [None] * self.robots

    def _commanded_velocities(self, actions: NDArray[Any], driving: Flags) -> Floats:
        """Let the members in the places ``actions`` (N,) say how, for those that are ``driving``."""
        chosen = np.asarray(actions).reshape(self.robots)
        if not np.isin(chosen, np.arange(self._members)).all():
            raise ConfigurationError(
                f"an action is {chosen.tolist()}; allowed: 0 .. {self._members - 1} each, the places of members"
            )
        commands = np.zeros((self.robots, 3))
        for slot in np.flatnonzero(driving).tolist():
            place = self._places[slot]
            assert place is not None
            commands[slot] = self._drivers[slot].drive(int(chosen[slot]), *place)
        return commands

    def _drive_control_step(self, actions: NDArray[Any], driving: Flags) -> Step:
        step = super()._drive_control_step(actions, driving)
        self._places = [(self.seen, slot) for slot in range(self.robots)]
        return step

    def _begin_episodes(self, slots: Slots, snapshot: Snapshot) -> NDArray[np.float32]:
        observations = super()._begin_episodes(slots, snapshot)
        for row, slot in enumerate(slots.tolist()):
            self._drivers[slot].begin(self.episodes[slot].problem, self.truth(slot))
            self._places[slot] = (self.seen, row)
        return observations


def make_batch(parts: Parts, worlds: int, *, team: int = 1) -> NavigationBatch:
    """Return worlds whose actions are velocities, or choose planners where the environment has a switch."""
    return (NavigationBatch if parts.switch is None else SwitchedBatch)(parts, worlds, team=team)
