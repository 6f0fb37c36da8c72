"""A rectangular room with nothing in it."""

from __future__ import annotations

from functools import lru_cache

from arena_core import OccupancyGrid, World, WorldSource
from arena_core.parameters import Positive
from arena_worlds.generators.canvas import Canvas


class EmptyRoom(WorldSource):
    """The same room for every scenario; ``width`` and ``height`` m are its inner size."""

    def __init__(self, width: Positive, height: Positive, resolution: Positive, *, known: bool) -> None:
        self._world = World("empty", _room_grid(width, height, resolution), known)

    def world(self, seed: int, index: int) -> World:
        """Return the room, whatever the scenario."""
        return self._world


@lru_cache(maxsize=16)
def _room_grid(width: float, height: float, resolution: float) -> OccupancyGrid:
    return Canvas(width, height, resolution).grid()
