"""The social side of N worlds: what people remember of each other, and when they do something else."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from arena_core import Crowd, PedestrianSpec, Scenario, stream_key
from arena_pedsim.behaviour import CHANCES, TRAITS, Behaviour, serves, traits_of
from arena_pedsim.minds import MIND, NOBODY, WORLD
from arena_pedsim.state_table import state_table
from arena_pedsim.states import NONE, STANDING, WALKING

START_UPS = {"wait_timer": "waiting_for_timer", "trigger_zone": "waiting_for_trigger"}


class Society:
    """``minds`` (N, P) and ``worlds`` (N,); worlds in which nobody can change state cost nothing."""

    def __init__(self, worlds: int, defaults: Behaviour) -> None:
        self._defaults = defaults
        self._table = state_table()
        self.minds = np.zeros((worlds, 0), MIND)
        self.worlds = np.zeros(worlds, WORLD)
        self.lively = False

    def settle(self, slot: int, scenario: Scenario, crowd: Crowd, people: NDArray[np.void]) -> None:
        """Begin a scenario in a slot, whose ``people`` (P,) are settled; who starts up later waits in ``crowd.states``."""
        specs = scenario.pedestrians
        if len(people) > self.minds.shape[1]:
            more = np.zeros((len(self.worlds), len(people) - self.minds.shape[1]), MIND)
            self.minds = np.concatenate((self.minds, more), axis=1)
        minds = self.minds[slot]
        minds[:] = np.zeros(1, MIND)
        people["party"] = np.arange(len(people))
        groups, queues = _numbered(specs, "group"), _numbered(specs, "queue")
        for i, spec in enumerate(specs):
            state = self._start(spec, int(crowd.states[slot, i]))
            crowd.states[slot, i] = state
            minds[i] = self._mind(spec, people[i], state, groups[i], queues[i])
        lively = self._is_lively(specs, minds)
        key = stream_key(scenario.seed, scenario.name, "social_states")
        self.worlds[slot] = np.array([(key, 0.0, scenario.goal.x, scenario.goal.y, lively)], WORLD)[0]
        self.lively = bool(self.worlds["lively"].any())

    def _start(self, spec: PedestrianSpec, state: int) -> int:
        mode: Any = spec.behaviour.get("start_up_mode", "default")
        return self._table.code(START_UPS[mode]) if mode in START_UPS and state != NONE else state

    def _mind(self, spec: PedestrianSpec, person: np.void, state: int, group: int, queue: int) -> np.void:
        mind: np.void = np.zeros(1, MIND)[0]
        mind["own_speed"], mind["own_social"] = person["max_speed"], person["factor_social"]
        mind["traits"] = traits_of(spec, self._defaults, bool(person["sociable"]))
        mind["state"], mind["partner"], mind["group"], mind["queue"] = state, NOBODY, group, queue
        mind["duration"] = mind["traits"][TRAITS.index("wait_time")] if state == self._table.code("waiting_for_timer") else np.inf
        mind["queue_waypoint"] = spec.behaviour.get("queue_waypoint", 0)
        mind["queue_heading"] = spec.behaviour.get("queue_heading", 0.0)
        mind["serves"] = serves(spec)
        return mind

    def _is_lively(self, specs: Sequence[PedestrianSpec], minds: NDArray[np.void]) -> bool:
        """Tell whether anybody could ever leave walking and waiting."""
        minds = minds[: len(specs)]
        chances = minds["traits"][:, [TRAITS.index(name) for name in CHANCES]]
        waits = ~np.isin(minds["state"], (NONE, STANDING, WALKING))
        return bool(chances.any() or waits.any() or (minds["group"] != NOBODY).any() or (minds["queue"] != NOBODY).any())


def _numbered(specs: Sequence[PedestrianSpec], key: str) -> list[int]:
    """Return the number of each person's group or queue, NOBODY without one; what it is called in the file does not matter."""
    names = list(dict.fromkeys(spec.behaviour[key] for spec in specs if key in spec.behaviour))
    return [names.index(spec.behaviour[key]) if key in spec.behaviour else NOBODY for spec in specs]
