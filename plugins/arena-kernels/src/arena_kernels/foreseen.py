"""Where moving discs will be: each on straight legs from time to time, the last for good."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arena_kernels.compiled import inner

FloatArray = NDArray[np.float64]


class Foreseen(NamedTuple):
    """K discs that begin leg s at ``times[s]`` s, rising from 0, at ``places[k, s]`` m, with ``velocities[k, s]`` m/s;
    (S,), (K, S, 2), (K, S, 2).
    """

    times: FloatArray
    places: FloatArray
    velocities: FloatArray

    @classmethod
    def of(cls, times: FloatArray, places: FloatArray, velocities: FloatArray) -> Foreseen:
        """Return them as kernels want them."""
        return cls(*(np.ascontiguousarray(each, np.float64) for each in (times, places, velocities)))

    @classmethod
    def straight(cls, positions: FloatArray, velocities: FloatArray) -> Foreseen:
        """Return discs (K, 2) that keep their velocities (K, 2)."""
        return cls.of(np.zeros(1), positions[:, None], velocities[:, None])


@inner
def leg_at(foreseen: Foreseen, time: float) -> int:
    """Return on which leg discs are at a time."""
    leg = 0
    while leg + 1 < len(foreseen.times) and foreseen.times[leg + 1] <= time:
        leg += 1
    return leg


@inner
def place_on(foreseen: Foreseen, disc: int, leg: int, time: float) -> tuple[float, float]:
    """Return where a disc is at a time that is on a leg."""
    since = time - foreseen.times[leg]
    return (
        foreseen.places[disc, leg, 0] + since * foreseen.velocities[disc, leg, 0],
        foreseen.places[disc, leg, 1] + since * foreseen.velocities[disc, leg, 1],
    )
