"""A generator of open ground: a border, and square obstacles at random places."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from scipy import ndimage

from arena_core import FREE, OCCUPIED, ConfigurationError, NonNegativeInt, OccupancyGrid, Positive, World, WorldSource, generator
from arena_worlds.canvas import Canvas


class Outdoor(WorldSource):
    """``obstacles`` squares of ``obstacle_size`` m at random places; one world a seed, or one a scenario if ``per_episode``.

    More and larger obstacles are harder. What the obstacles cut off from the largest open place is filled in.
    """

    def __init__(
        self,
        width: Positive,
        height: Positive,
        resolution: Positive,
        obstacles: NonNegativeInt,
        obstacle_size: Positive,
        per_episode: bool,
        known: bool,
    ) -> None:
        if obstacle_size > min(width, height) / 2:
            raise ConfigurationError(
                f"world.obstacle_size is {obstacle_size:g}; allowed: up to half the smaller side, {min(width, height) / 2:g} m"
            )
        self._plan = (width, height, resolution, obstacles, obstacle_size)
        self._per_episode = per_episode
        self._known = known

    def world(self, seed: int, index: int) -> World:
        """Return the ground of this seed, or of this scenario."""
        return World("outdoor", _ground(*self._plan, seed, index if self._per_episode else 0), self._known)


@lru_cache(maxsize=16)
def _ground(width: float, height: float, resolution: float, obstacles: int, size: float, seed: int, number: int) -> OccupancyGrid:
    random = generator(seed, f"world/{number}", "world")
    canvas = Canvas(width, height, resolution)
    half = size / 2
    for x, y in random.uniform((0.0, 0.0), (width, height), (obstacles, 2)).tolist():
        canvas.fill(x - half, y - half, x + half, y + half)
    _fill_pockets(canvas)
    return canvas.grid()


def _fill_pockets(canvas: Canvas) -> None:
    places, count = ndimage.label(canvas.inside == FREE)
    if count == 0:
        raise ConfigurationError("world.obstacles leave no free cell; allowed: fewer or smaller ones")
    sizes = np.bincount(places.ravel())
    sizes[0] = 0
    canvas.inside[places != sizes.argmax()] = OCCUPIED
