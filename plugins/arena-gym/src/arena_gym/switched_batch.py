"""N worlds whose actions choose which planner drives."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from arena_core import ConfigurationError, ObservationBatch, Snapshot
from arena_gym.batch import Flags, NavigationBatch, Slots, Step
from arena_gym.building import Parts


class SwitchedBatch(NavigationBatch):
    """Drives N robots by members that a policy chooses among, for some control steps at a time; slot k is what it is alone.

    A robot whose episode ends in between stands until all have driven so long.
    """

    def __init__(self, parts: Parts, worlds: int) -> None:
        super().__init__(parts, worlds)
        assert parts.switch is not None
        self._steps_of_action = parts.switch.every * parts.switch.held
        self._members = len(parts.switch.members)
        self._drivers = [parts.switch.make_driver() for _ in range(worlds)]
        self._places: list[tuple[ObservationBatch, int] | None] = [None] * worlds

    def step(self, actions: NDArray[Any]) -> Step:
        """Drive by the members ``actions`` (N,), for so many control steps as an action holds; rewards add up."""
        chosen = np.asarray(actions).reshape(self.worlds)
        if not np.isin(chosen, np.arange(self._members)).all():
            raise ConfigurationError(f"an action is {chosen.tolist()}; allowed: 0 .. {self._members - 1} each, the places of members")
        total = self._control(chosen, np.ones(self.worlds, bool))
        for _ in range(self._steps_of_action - 1):
            goes_on = ~(total.terminated | total.truncated)
            if goes_on.any():
                total = _joined(total, self._control(chosen, goes_on), goes_on)
        return total

    def _control(self, chosen: NDArray[Any], driving: Flags) -> Step:
        """Let the robots that are ``driving`` (N,) do so for one control step; return what came of it, of use for those alone."""
        steps, collisions = self.steps.copy(), self.collisions.copy()
        commands = np.zeros((self.worlds, 3))
        for slot in np.flatnonzero(driving).tolist():
            place = self._places[slot]
            assert place is not None
            commands[slot] = self._drivers[slot].drive(int(chosen[slot]), *place)
        step = self.drive(commands)
        self.steps, self._loop.collisions = np.where(driving, self.steps, steps), np.where(driving, self.collisions, collisions)
        self._places = [(self.seen, slot) for slot in range(self.worlds)]
        return step

    def _begin(self, slots: Slots, snapshot: Snapshot) -> NDArray[np.float32]:
        observations = super()._begin(slots, snapshot)
        for row, slot in enumerate(slots.tolist()):
            self._drivers[slot].begin(self.episodes[slot].problem)
            self._places[slot] = (self.seen, row)
        return observations


def make_batch(parts: Parts, worlds: int) -> NavigationBatch:
    """Return worlds whose actions are velocities, or choose planners where the environment has a switch."""
    return NavigationBatch(parts, worlds) if parts.switch is None else SwitchedBatch(parts, worlds)


def _joined(first: Step, then: Step, goes_on: Flags) -> Step:
    """Return two steps in a row as one, of which only those that go on took the second."""
    flags = {
        name: getattr(first, name) | (getattr(then, name) & goes_on)
        for name in ("arrived", "collided", "timed_out", "terminated", "truncated")
    }
    observations = np.where(goes_on[:, None], then.observations, first.observations)
    return replace(first, observations=observations, rewards=first.rewards + goes_on * then.rewards, **flags)
