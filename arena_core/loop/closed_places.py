"""Places where a robot did not get on: paths keep off them for a while, longer each time that it fails there again."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from arena_core.values.geometry import FloatArray
from arena_core.values.world import Obstacle


@dataclass(slots=True)
class _Closed:
    place: Obstacle
    until: float
    lasts: float


class ClosedPlaces:
    """Remembers the discs that were closed in an episode; a place that is closed again stays closed twice as long."""

    def __init__(self) -> None:
        self._all: list[_Closed] = []

    def close(self, center_xy: FloatArray, radius: float, stamp: float, time: float) -> float:
        """Close a disc about ``center_xy`` (1, 2), m, from ``stamp`` on and return for how long, s: ``time``
        where it was open so far.
        """
        for known in self._all:
            if np.hypot(*(known.place.vertices_xy - center_xy)[0]) <= radius:
                known.lasts *= 2.0
                known.until = stamp + known.lasts
                return known.lasts
        self._all.append(_Closed(Obstacle(center_xy, radius), stamp + time, time))
        return time

    def at(self, stamp: float) -> list[Obstacle]:
        """Return the discs that are closed at ``stamp``."""
        return [known.place for known in self._all if known.until > stamp]
