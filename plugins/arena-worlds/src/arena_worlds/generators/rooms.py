"""A generator of rooms: a hall parted into rooms by walls with doors, and furniture in the rooms."""

# annotations are not postponed, as in generated.py
from dataclasses import dataclass

import numpy as np

from arena_core import FREE, ConfigurationError
from arena_core.parameters import Fraction, Positive
from arena_worlds.generators.canvas import WALL_CELLS, Canvas
from arena_worlds.generators.floor_plan import Room, choose_doors, divide_hall
from arena_worlds.generators.furniture import Furnisher
from arena_worlds.generators.generated import Count, Generated, SomeCount, Span, UnsuitableWorld


@dataclass(frozen=True, slots=True)
class RoomsByDifficulty:
    """What difficulty decides: ``rooms`` and pieces of ``furniture`` per 100 m2, ``door_width`` and
    ``furniture_size`` m, ``loops``.
    """

    rooms: Span
    door_width: Span
    loops: Span
    furniture: Span
    furniture_size: Span


@dataclass(frozen=True)
class Rooms(Generated):
    """A binary space partition into ``rooms``, no side shorter than ``least_side`` m, joined by doors of ``door_width``
    m.

    The doors are a random spanning tree of the neighbours and a share ``loops`` of all others. Pieces of ``furniture``
    of up to ``furniture_size`` m stand along walls or free, and leave passages as wide as the doors.
    """

    least_side: Positive
    rooms: SomeCount | None
    door_width: Positive | None
    loops: Fraction | None
    furniture: Count | None
    furniture_size: Positive | None
    by_difficulty: RoomsByDifficulty

    kind = "rooms"

    def check(self) -> None:
        """Raise ConfigurationError for doors too narrow for the robot or too wide for the rooms."""
        width = self._door_width()
        self.check_passage("door_width", self.door_width, width)
        least = width + 2 * WALL_CELLS * self.resolution
        if self.least_side < least - 1e-9:
            raise ConfigurationError(
                f"world.least_side is {self.least_side:g}; allowed: from a door and its posts on, {least:g} m"
            )

    def draw(self, random: np.random.Generator) -> Canvas:
        """Part the hall, open the doors, furnish the rooms."""
        canvas = Canvas(self.width, self.height, self.resolution, filled=True)
        cells, door_width = self._cell_count, self._cell_count(self._door_width())
        rows, columns = canvas.inside.shape
        rooms = divide_hall(Room(0, 0, columns, rows), self._room_count(), cells(self.least_side), random)
        if self.rooms is not None and len(rooms) < self.rooms:
            raise UnsuitableWorld(
                f"world.rooms is {self.rooms}; allowed: as many as fit with least_side {self.least_side:g} m, "
                f"here {len(rooms)}"
            )
        doors = choose_doors(rooms, door_width, self._loop_share(), random)
        for space in (*rooms, *doors):
            canvas.inside[space.bottom : space.top, space.left : space.right] = FREE
        furnisher = Furnisher(canvas.inside, doors, gap=door_width)
        for size in random.uniform(0.4, 1.0, (self._furniture_count(), 2)) * self._furniture_size():
            furnisher.place(rooms, cells(float(size[0])), cells(float(size[1])), random)
        return canvas

    def _cell_count(self, metres: float) -> int:
        return max(round(metres / self.resolution), 1)

    def _room_count(self) -> int:
        return self.rooms or max(self.per_area(self.by_difficulty.rooms), 1)

    def _door_width(self) -> float:
        return self.door_width or self.by_difficulty.door_width.at(self.difficulty)

    def _furniture_count(self) -> int:
        return self.per_area(self.by_difficulty.furniture) if self.furniture is None else self.furniture

    def _furniture_size(self) -> float:
        return self.furniture_size or self.by_difficulty.furniture_size.at(self.difficulty)

    def _loop_share(self) -> float:
        return self.by_difficulty.loops.at(self.difficulty) if self.loops is None else self.loops
