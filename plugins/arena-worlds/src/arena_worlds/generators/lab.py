"""A laboratory hall of our own making: benches along the walls, and what stands in the room."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import lru_cache

from arena_core import ConfigurationError, OccupancyGrid, World, WorldSource
from arena_core.parameters import Positive
from arena_worlds.generators.canvas import Canvas


class Lab(WorldSource):
    """The same hall of ``width`` by ``height`` m for all scenarios and seeds; ``fixtures``: rectangles
    [x_min, y_min, x_max, y_max], m.
    """

    def __init__(
        self,
        width: Positive,
        height: Positive,
        resolution: Positive,
        fixtures: Mapping[str, Sequence[float]],
        *,
        known: bool,
    ) -> None:
        for name, sides in fixtures.items():
            _check_fixture(name, sides, width, height)
        self._world = World("lab", _lab_grid(width, height, resolution, tuple(map(tuple, fixtures.values()))), known)

    def world(self, seed: int, index: int) -> World:
        """Return the hall, whatever the scenario."""
        return self._world


@lru_cache(maxsize=16)
def _lab_grid(width: float, height: float, resolution: float, fixtures: tuple[tuple[float, ...], ...]) -> OccupancyGrid:
    canvas = Canvas(width, height, resolution)
    for x_min, y_min, x_max, y_max in fixtures:
        canvas.fill(x_min, y_min, x_max, y_max)
    return canvas.grid()


def _check_fixture(name: str, sides: Sequence[float], width: float, height: float) -> None:
    """Raise ConfigurationError for a fixture that is no rectangle within the hall."""
    if len(sides) != 4 or not (0.0 <= sides[0] < sides[2] <= width and 0.0 <= sides[1] < sides[3] <= height):
        raise ConfigurationError(
            f"world.fixtures.{name} is {list(sides)}; allowed: [x_min, y_min, x_max, "
            f"y_max] within {width:g} x {height:g} m"
        )
