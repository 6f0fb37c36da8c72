"""A generator of corridors: nodes at random places, each joined to the nearest by an L-shaped corridor."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from arena_core import ConfigurationError, OccupancyGrid, Positive, PositiveInt, World, WorldSource, generator
from arena_worlds.canvas import Canvas


class Indoor(WorldSource):
    """Corridors of ``corridor_width`` m grown in ``iterations`` steps; one world a seed, or one a scenario if ``per_episode``.

    More iterations open more of the building, narrower corridors make it harder. All free space is connected.
    """

    def __init__(
        self,
        width: Positive,
        height: Positive,
        resolution: Positive,
        corridor_width: Positive,
        iterations: PositiveInt,
        per_episode: bool,
        known: bool,
    ) -> None:
        if not 2 * resolution <= corridor_width <= min(width, height):
            raise ConfigurationError(
                f"world.corridor_width is {corridor_width:g}; allowed: two cells to the smaller side, "
                f"{2 * resolution:g} .. {min(width, height):g} m"
            )
        self._plan = (width, height, resolution, corridor_width, iterations)
        self._per_episode = per_episode
        self._known = known

    def world(self, seed: int, index: int) -> World:
        """Return the building of this seed, or of this scenario."""
        return World("indoor", _building(*self._plan, seed, index if self._per_episode else 0), self._known)


@lru_cache(maxsize=16)
def _building(
    width: float, height: float, resolution: float, corridor_width: float, iterations: int, seed: int, number: int
) -> OccupancyGrid:
    random = generator(seed, f"world/{number}", "world")
    canvas = Canvas(width, height, resolution, filled=True)
    half = corridor_width / 2
    nodes = np.array([(width / 2, height / 2)])
    for drawn in random.uniform((half, half, 0.0), (width - half, height - half, 1.0), (iterations, 3)):
        node = drawn[:2]
        nearest = nodes[np.abs(nodes - node).sum(axis=1).argmin()]
        _corridor(canvas, node, nearest, half, along_x_first=bool(drawn[2] < 0.5))
        nodes = np.vstack((nodes, node))
    return canvas.grid()


def _corridor(canvas: Canvas, start: np.ndarray, end: np.ndarray, half: float, along_x_first: bool) -> None:
    bend = (end[0], start[1]) if along_x_first else (start[0], end[1])
    for leg in (start, end):
        (x_min, x_max), (y_min, y_max) = sorted((leg[0], bend[0])), sorted((leg[1], bend[1]))
        canvas.clear(x_min - half, y_min - half, x_max + half, y_max + half)
