"""What generated worlds have in common: a hall, one difficulty, room for the robot, and when a new one is drawn."""

# annotations are not postponed here: the registry reads those of a subclass's constructor in the subclass's module
from abc import abstractmethod
from dataclasses import dataclass, field, replace
from functools import lru_cache
from typing import Annotated, ClassVar, Self

import numpy as np
from numpy.typing import NDArray

from arena_core import FREE, OCCUPIED, ConfigurationError, OccupancyGrid, World, WorldSource, random_generator
from arena_core.parameters import Bounds, Fraction, NonNegative, NonNegativeInt, Positive, PositiveInt
from arena_worlds.generators.canvas import Canvas
from arena_worlds.generators.similarity import MapSimilarity
from arena_worlds.reachable import keep_reachable
from arena_worlds.widths import widths_of

# of things in a world: a slip of the pen is an error, not an endless wait
Count = Annotated[int, Bounds(low=0, high=10_000)]
SomeCount = Annotated[int, Bounds(low=1, high=10_000)]


class UnsuitableWorld(ConfigurationError):
    """A world was drawn that is not as it has to be; the next one may be."""


@dataclass(frozen=True, slots=True)
class Span:
    """A parameter at difficulty 0 and at difficulty 1, straight between."""

    easy: NonNegative
    hard: NonNegative

    def at(self, difficulty: float) -> float:
        """Return the parameter at a difficulty."""
        return self.easy + (self.hard - self.easy) * difficulty


@dataclass(frozen=True)
class Generated(WorldSource):
    """Draws worlds of ``width`` by ``height`` m: one for each seed, or a new one every ``regenerate`` scenarios.

    All places of a robot of ``robot_radius`` m are connected, at least ``least_share`` of the hall is free, and the
    world is ``like`` a given one where that is asked for; a world that fails this is drawn again, up to ``draws``
    times.
    """

    width: Positive
    height: Positive
    resolution: Positive
    difficulty: Fraction
    robot_radius: NonNegative
    least_share: Fraction
    draws: PositiveInt
    like: MapSimilarity | None
    regenerate: NonNegativeInt | None = field(compare=False)
    known: bool = field(compare=False)

    kind: ClassVar[str]

    def __post_init__(self) -> None:
        self.check()
        _draw_world(self, 0, 0)  # what is impossible is said before anything runs, whatever the seed

    @abstractmethod
    def check(self) -> None:
        """Raise ConfigurationError for parameters that no world can have."""

    @abstractmethod
    def draw(self, random: np.random.Generator) -> Canvas:
        """Return one hall, not all of it need be connected; raise Misdrawn where this is none."""

    def world(self, seed: int, index: int) -> World:
        """Return the world of this seed and scenario."""
        number = index // self.regenerate if self.regenerate else 0
        return World(self.kind, _draw_world(self, seed, number), self.known)

    def at(self, difficulty: float) -> Self:
        """Return the same source at another difficulty, 0 .. 1; a parameter with a value of its own keeps it."""
        if not 0.0 <= difficulty <= 1.0:
            raise ConfigurationError(f"difficulty is {difficulty:g}; allowed: 0 .. 1")
        return replace(self, difficulty=difficulty)

    def per_area(self, density: Span) -> int:
        """Return how many of something there are, by its density at this difficulty, per 100 m2."""
        return round(density.at(self.difficulty) * self.width * self.height / 100.0)

    def check_passage(self, key: str, given: float | None, width: float) -> None:
        """Raise ConfigurationError where a passage of ``width`` m, given or by difficulty, does
        not let the robot through.
        """
        least = 2.0 * (self.robot_radius + self.resolution)  # a passage loses up to two cells to rounding
        if width < least - 1e-9:
            origin = f"world.{key} is {given:g}" if given is not None else f"world.by_difficulty.{key} gives {width:g}"
            raise ConfigurationError(
                f"{origin}: no free space for the robot; allowed: from {least:g} m on with robot_radius "
                f"{self.robot_radius:g}"
            )


@lru_cache(maxsize=32)
def _draw_world(source: Generated, seed: int, number: int) -> OccupancyGrid:
    random = random_generator(seed, f"world/{number}", "world")
    for _ in range(source.draws - 1):
        try:
            return _draw_grid(source, random)
        except UnsuitableWorld:
            continue
    return _draw_grid(source, random)


def _draw_grid(source: Generated, random: np.random.Generator) -> OccupancyGrid:
    """Return the next world; raise Misdrawn where the robot has too little room."""
    canvas = source.draw(random)
    free = keep_reachable(canvas.inside == FREE, source.resolution, source.robot_radius)
    if not free.any() or free.mean() < source.least_share:
        raise UnsuitableWorld(
            f"world {source.kind}: no free space for the robot (robot_radius {source.robot_radius:g} m, "
            f"difficulty {source.difficulty:g}: "
            f"{free.mean():.0%} of the hall); allowed: least_share, {source.least_share:.0%}, or more"
        )
    if source.like is not None:
        _check_similarity(source.like, free, source)
    canvas.inside = np.where(free, np.int8(FREE), np.int8(OCCUPIED))
    return canvas.grid()


def _check_similarity(like: MapSimilarity, free: NDArray[np.bool_], source: Generated) -> None:
    """Raise Misdrawn where the free cells (H, W) are not like the map that ``like`` was measured on."""
    unlike = like.differences(widths_of(np.pad(free, 1), source.resolution))
    if unlike:
        raise UnsuitableWorld(
            f"world {source.kind}: {source.draws} draws, none like world.like (the last: {unlike}); allowed: "
            "more draws, or a wider within"
        )
