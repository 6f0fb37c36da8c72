"""Two rooms with a door between them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Annotated

from arena_core import ConfigurationError, OccupancyGrid, World, WorldSource
from arena_core.parameters import Flat, Positive
from arena_worlds.generators.canvas import Canvas


@dataclass(frozen=True, slots=True)
class DoorPlan:
    """Two rooms, together ``width`` by ``height`` m; a wall of ``wall`` m across the middle of x has a door of ``door``
    m in the middle of y.
    """

    width: Positive
    height: Positive
    door: Positive
    wall: Positive
    resolution: Positive


class Door(WorldSource):
    """The same two rooms for every scenario."""

    def __init__(self, plan: Annotated[DoorPlan, Flat()], *, known: bool) -> None:
        for name, own, side, room in (
            ("door", plan.door, "height", plan.height),
            ("wall", plan.wall, "width", plan.width),
        ):
            if own >= room:
                raise ConfigurationError(f"world.{name} is {own:g}; allowed: below world.{side}, {room:g} m")
        self._world = World("door", _door_grid(plan), known)

    def world(self, seed: int, index: int) -> World:
        """Return the rooms, whatever the scenario."""
        return self._world


@lru_cache(maxsize=16)
def _door_grid(plan: DoorPlan) -> OccupancyGrid:
    canvas = Canvas(plan.width, plan.height, plan.resolution)
    left, low = (plan.width - plan.wall) / 2, (plan.height - plan.door) / 2
    canvas.fill(left, 0.0, left + plan.wall, plan.height)
    canvas.clear(left, low, left + plan.wall, low + plan.door)
    return canvas.grid()
