"""Doors that open and close by a timetable."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from arena_core.base.errors import ConfigurationError
from arena_core.base.frozen import freeze_array
from arena_core.values.geometry import FloatArray
from arena_core.values.obstacles import add_obstacles
from arena_core.values.world import Obstacle, OccupancyGrid

INSTANT = 1e-9  # s; times that differ by less are the same: a tick that is computed falls a rounding beside its own


@dataclass(frozen=True, slots=True, eq=False)
class Door:
    """A door that is away altogether while it is open, as an elevator's; closed it is an obstacle that is on no map.

    A door does not close on anyone: it stays open while a robot or a person stands in it, and closes when it is free.

    ``vertices_xy`` (V, 2) is the outline of the closed door, a simple polygon, m, in ``map``. ``open`` (K, 2) are the
    intervals [from, to) in which it is open, s since the episode began, in their order; the last ``to`` may be inf.
    With a ``period`` (s) they lie within one, and come again in each.
    """

    vertices_xy: FloatArray
    open: FloatArray
    period: float | None = None

    def __post_init__(self) -> None:
        """Raise ConfigurationError where the intervals are none, or have another order."""
        intervals = freeze_array(np.asarray(self.open, np.float64).reshape(-1, 2))
        object.__setattr__(self, "open", intervals)
        object.__setattr__(self, "vertices_xy", freeze_array(np.asarray(self.vertices_xy, np.float64)))
        if self.period is not None and not 0.0 < self.period < math.inf:
            raise ConfigurationError(f"period is {self.period:g}; allowed: a number > 0 (s), or none")
        end = math.inf if self.period is None else self.period
        times = intervals.ravel()
        rising = (np.diff(times) > 0.0)[::2].all() and (np.diff(times) >= 0.0).all()
        if not len(times) or not rising or not times[0] >= 0.0 or not times[-1] <= end:
            within = "" if self.period is None else f" <= period, {end:g}"
            raise ConfigurationError(
                f"open is {intervals.tolist()}; allowed: one or more [from, to] (s) in their order, "
                f"0 <= from < to{within}"
            )


def is_open(door: Door, stamp: float) -> bool:
    """Return whether a door is open at ``stamp`` (s) by its timetable alone, whoever stands in it."""
    time = stamp + INSTANT
    if door.period is not None:
        time -= math.floor(time / door.period) * door.period
    return any(begin <= time < end for begin, end in door.open.tolist())


def close_doors(grid: OccupancyGrid, doors: Sequence[Door], doors_open: Sequence[bool]) -> OccupancyGrid:
    """Return the grid in which those of the doors that are not open are walls."""
    closed = [Obstacle(door.vertices_xy) for door, opened in zip(doors, doors_open, strict=True) if not opened]
    return add_obstacles(grid, closed)


def door_meta(door: Door) -> dict[str, Any]:
    """Return a door as records have it; what has no end ends at None."""
    intervals = [[begin, end if math.isfinite(end) else None] for begin, end in door.open.tolist()]
    return {"vertices_xy": door.vertices_xy.tolist(), "open": intervals, "period": door.period}
