"""How the people of a scenario begin, made once: training meets the same people in many episodes."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from arena_core import PedestrianSpec
from arena_pedsim.people import PERSON
from arena_pedsim.state_ids import NONE, STANDING, WALKING
from arena_pedsim.states.person_defaults import CrowdDefaults
from arena_pedsim.states.spawning import init_spawning

KEPT = 2048  # scenarios


@dataclass(frozen=True, slots=True, eq=False)
class InitialCrowd:
    """P people as they begin: arrays over them, and ``people`` (P,), what the model remembers; ``waypoints`` (P, W, 2)
    m, then zeros.

    ``positions`` and ``velocities`` (P, 2) are NaN for who comes later.
    """

    specs: tuple[PedestrianSpec, ...]
    ids: NDArray[np.int32]
    radii: NDArray[np.float64]
    states: NDArray[np.int8]
    positions: NDArray[np.float64]
    velocities: NDArray[np.float64]
    people: NDArray[Any]
    waypoints: NDArray[np.float64]


@lru_cache(maxsize=KEPT)
def initial_crowd(customs: CrowdDefaults, pedestrians: tuple[PedestrianSpec, ...]) -> InitialCrowd:
    """Return how these people begin; raise ConfigurationError for an impossible behaviour."""
    specs = tuple(customs.of(spec) for spec in pedestrians)
    people = np.zeros(len(specs), PERSON)
    waypoints = np.zeros((len(specs), max((len(spec.waypoints_xy) for spec in specs), default=0), 2))
    there = np.zeros(len(specs), np.bool_)
    for i, spec in enumerate(specs):
        people[i] = customs.memory(spec)
        there[i] = init_spawning(people[i], spec)
        waypoints[i, : len(spec.waypoints_xy)] = spec.waypoints_xy
    starts = np.array([spec.position_xy for spec in specs]).reshape(-1, 2)
    states = [WALKING if len(spec.waypoints_xy) else STANDING for spec in specs]
    return InitialCrowd(
        specs,
        np.array([spec.id for spec in specs], np.int32),
        np.array([spec.radius for spec in specs], np.float64),
        np.where(there, states, NONE).astype(np.int8),
        np.where(there[:, None], starts, np.nan),
        np.where(there[:, None], 0.0, np.nan) * np.ones((1, 2)),
        people,
        waypoints,
    )
