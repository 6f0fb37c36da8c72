"""The social side of N worlds: what people remember of each other, and when they do something else."""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from typing import Any

import numpy as np
from numpy.typing import NDArray

from arena_core import Branches, Crowd, PedestrianSpec, Scenario, stream_key
from arena_pedsim.state_ids import NONE, STANDING, WALKING
from arena_pedsim.states.behaviour import CHANCES, TRAITS, Behaviour, is_service_robot, traits_of
from arena_pedsim.states.initial_crowd import KEPT
from arena_pedsim.states.person_state import MIND, NOBODY, WORLD, SocialArrays
from arena_pedsim.states.state_table import state_table

Beginning = tuple[NDArray[np.void], NDArray[np.int8], bool]
START_UPS = {
    "wait_timer": "waiting_for_timer",
    "trigger_zone": "waiting_for_trigger",
    "signal_wait": "signalling_wait",
    "signal_proceed": "signalling_proceed",
}


class SocialState:
    """``minds`` (N, P) and ``worlds`` (N,); worlds in which no one can change state cost nothing.

    ``links`` (3, P) and ``angles`` (P,) are room for the kernels to work in.
    """

    def __init__(self, worlds: int, defaults: Behaviour) -> None:
        self._defaults = defaults
        self._table = state_table()
        self.minds = np.zeros((worlds, 0), MIND)
        self.worlds = np.zeros(worlds, WORLD)
        self.links, self.angles = np.zeros((3, 0), np.int32), np.zeros(0)
        self.lively = False
        self._beginnings: dict[tuple[PedestrianSpec, ...], Beginning] = {}

    @property
    def social(self) -> SocialArrays:
        """All of it as kernels take it."""
        return SocialArrays(self.minds, self.worlds, self.links, self.angles)

    def begin_slots(self, slot: int, scenario: Scenario, crowd: Crowd, people: NDArray[np.void]) -> None:
        """Begin a scenario in a slot, whose ``people`` (P,) are settled; who starts up later
        waits in ``crowd.states``.
        """
        specs = tuple(scenario.pedestrians)
        if len(people) > self.minds.shape[1]:
            more = np.zeros((len(self.worlds), len(people) - self.minds.shape[1]), MIND)
            self.minds = np.concatenate((self.minds, more), axis=1)
            self.links, self.angles = np.zeros((3, len(people)), np.int32), np.zeros(len(people))
        begun = crowd.states[slot, : len(specs)]
        minds, states, lively = self._beginnings.get(specs) or self._begin_people(specs, people[: len(specs)], begun)
        self.minds[slot, : len(specs)], self.minds[slot, len(specs) :] = minds, np.zeros(1, MIND)
        begun[:] = states
        people["party"] = np.arange(len(people))
        key = stream_key(scenario.seed, scenario.name, "social_states")
        groups = 1 + int(minds["group"].max(initial=NOBODY))
        self.worlds[slot] = np.array([(key, 0.0, scenario.goal.x, scenario.goal.y, groups, lively)], WORLD)[0]
        self.lively = bool(self.worlds["lively"].any())

    def fork(self, branches: Branches) -> SocialState:
        """Return a social side of its own that goes on from this one."""
        forked = copy(self)
        forked.minds, forked.worlds = self.minds[branches.slots], self.worlds[branches.slots]
        forked.links, forked.angles = self.links.copy(), self.angles.copy()
        forked.worlds["key"] ^= branches.streams
        return forked

    def _begin_people(
        self, specs: tuple[PedestrianSpec, ...], people: NDArray[np.void], states: NDArray[np.int8]
    ) -> Beginning:
        """Return what these people have in mind when they begin, their states, and whether those may change;
        keep it for the next time.
        """
        minds = np.zeros(len(specs), MIND)
        groups, queues = _number_groups(specs, "group"), _number_groups(specs, "queue")
        started = np.array(
            [self._start_state(spec, int(state)) for spec, state in zip(specs, states, strict=True)], np.int8
        )
        for i, spec in enumerate(specs):
            minds[i] = self._make_mind(spec, people[i], int(started[i]), groups[i], queues[i])
        if len(self._beginnings) >= KEPT:
            self._beginnings.clear()
        self._beginnings[specs] = minds, started, self._can_change_state(specs, minds)
        return self._beginnings[specs]

    def _start_state(self, spec: PedestrianSpec, state: int) -> int:
        mode: Any = spec.behaviour.get("start_up_mode", "default")
        return self._table.code(START_UPS[mode]) if mode in START_UPS and state != NONE else state

    def _make_mind(self, spec: PedestrianSpec, person: np.void, state: int, group: int, queue: int) -> np.void:
        mind: np.void = np.zeros(1, MIND)[0]
        mind["own_social"] = person["factor_social"]
        mind["traits"] = traits_of(spec, self._defaults, sociable=bool(person["sociable"]))
        mind["state"], mind["partner"], mind["group"], mind["queue"] = state, NOBODY, group, queue
        mind["duration"] = (
            mind["traits"][TRAITS.index("wait_time")] if state == self._table.code("waiting_for_timer") else np.inf
        )
        mind["queue_waypoint"] = spec.behaviour.get("queue_waypoint", 0)
        mind["queue_heading"] = spec.behaviour.get("queue_heading", 0.0)
        mind["serves"] = is_service_robot(spec)
        return mind

    def _can_change_state(self, specs: Sequence[PedestrianSpec], minds: NDArray[np.void]) -> bool:
        """Return whether anybody could ever leave walking and waiting."""
        minds = minds[: len(specs)]
        chances = minds["traits"][:, [TRAITS.index(name) for name in CHANCES]]
        waits = ~np.isin(minds["state"], (NONE, STANDING, WALKING))
        return bool(
            chances.any() or waits.any() or (minds["group"] != NOBODY).any() or (minds["queue"] != NOBODY).any()
        )


def _number_groups(specs: Sequence[PedestrianSpec], key: str) -> list[int]:
    """Return the number of each person's group or queue, NOBODY without one; what it is called
    in the file does not matter.
    """
    names = list(dict.fromkeys(spec.behaviour[key] for spec in specs if key in spec.behaviour))
    return [names.index(spec.behaviour[key]) if key in spec.behaviour else NOBODY for spec in specs]
