"""The arrays of a crowd: N worlds with as many slots as the largest world has needed so far."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from arena_core import ABSENT, Crowd, Pedestrians


def no_crowd(worlds: int) -> Crowd:
    """Return a crowd of no one."""
    return Crowd(
        np.zeros(worlds, np.int32),
        np.full((worlds, 0), -1, np.int32),
        np.full((worlds, 0, 2), np.nan),
        np.full((worlds, 0, 2), np.nan),
        np.zeros((worlds, 0)),
        np.full((worlds, 0), ABSENT, np.int8),
    )


def with_worlds(crowd: Crowd, worlds: Mapping[int, Pedestrians]) -> Crowd:
    """Return the crowd with other people in these slots; empty places are parked."""
    places = max([crowd.ids.shape[1], *(len(people.ids) for people in worlds.values())])
    counts = crowd.counts.copy()
    ids, radii, states = (
        grow_array(crowd.ids, places, -1),
        grow_array(crowd.radii, places, 0.0),
        grow_array(crowd.states, places, ABSENT),
    )
    positions, velocities = grow_array(crowd.positions, places, np.nan), grow_array(crowd.velocities, places, np.nan)
    for slot, people in worlds.items():
        n = len(people.ids)
        counts[slot] = n
        ids[slot, :n], radii[slot, :n], states[slot, :n] = people.ids, people.radii, people.states
        positions[slot, :n], velocities[slot, :n] = people.positions, people.velocities
        ids[slot, n:], radii[slot, n:], states[slot, n:] = -1, 0.0, ABSENT
        positions[slot, n:], velocities[slot, n:] = np.nan, np.nan
    return Crowd(counts, ids, positions, velocities, radii, states)


def grow_array(array: NDArray[Any], places: int, fill: Any, axis: int = 1) -> NDArray[Any]:
    """Return a copy of an array with at least so many places along an axis, the new ones filled."""
    missing = max(places - array.shape[axis], 0)
    shape = (*array.shape[:axis], missing, *array.shape[axis + 1 :])
    return np.concatenate((array, np.full(shape, fill, array.dtype)), axis=axis)
