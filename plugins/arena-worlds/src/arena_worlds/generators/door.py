"""Two rooms with a door between them."""

from __future__ import annotations

from functools import lru_cache

from arena_core import ConfigurationError, OccupancyGrid, World, WorldSource
from arena_core.parameters import Positive
from arena_worlds.generators.canvas import Canvas


class Door(WorldSource):
    """The same two rooms for every scenario, together ``width`` by ``height`` m; a wall of ``wall`` m across the middle
    of x has a door of ``door`` m in the middle of y.
    """

    def __init__(
        self, width: Positive, height: Positive, door: Positive, wall: Positive, resolution: Positive, *, known: bool
    ) -> None:
        if door >= height:
            raise ConfigurationError(f"world.door is {door:g}; allowed: below world.height, {height:g} m")
        if wall >= width:
            raise ConfigurationError(f"world.wall is {wall:g}; allowed: below world.width, {width:g} m")
        self._world = World("door", _door_grid((width, height), (wall, door), resolution), known)

    def world(self, seed: int, index: int) -> World:
        """Return the rooms, whatever the scenario."""
        return self._world


@lru_cache(maxsize=16)
def _door_grid(size: tuple[float, float], opening: tuple[float, float], resolution: float) -> OccupancyGrid:
    (width, height), (wall, door) = size, opening
    canvas, left, low = Canvas(width, height, resolution), (width - wall) / 2, (height - door) / 2
    canvas.fill(left, 0.0, left + wall, height)
    canvas.clear(left, low, left + wall, low + door)
    return canvas.grid()
