"""Where furniture can stand so that one still gets around it and through every door."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from arena_core import OCCUPIED
from arena_worlds.generators.floor_plan import Door, Room

TRIES = 10  # places that are tried for a piece before it is left out


class Furnisher:
    """Puts pieces into ``cells`` (H, W) and keeps ``gap`` cells free around each, but towards a
    wall that it stands against.
    """

    def __init__(self, cells: NDArray[np.int8], doors: list[Door], gap: int) -> None:
        self._cells, self._gap = cells, gap
        self._kept_free = np.zeros(cells.shape, bool)  # before the doors
        for door in doors:
            x, y = (gap, 0) if door.along_x else (0, gap)
            self._kept_free[max(door.bottom - y, 0) : door.top + y, max(door.left - x, 0) : door.right + x] = True

    def place(self, rooms: list[Room], width: int, height: int, random: np.random.Generator) -> None:
        """Put one piece of ``width`` by ``height`` cells into a room, larger rooms more likely;
        leave it out when none has room.
        """
        areas = np.array([room.area for room in rooms], np.float64)
        for room, draw in zip(
            random.choice(len(rooms), TRIES, p=areas / areas.sum()), random.random((TRIES, 4)).tolist(), strict=True
        ):
            left, space_left, space_right = self._draw_side(
                rooms[room].left, rooms[room].right, width, draw[0], draw[1]
            )
            bottom, space_below, space_above = self._draw_side(
                rooms[room].bottom, rooms[room].top, height, draw[2], draw[3]
            )
            right, top = left + width, bottom + height
            around = self._cells[
                max(bottom - space_below, 0) : top + space_above, max(left - space_left, 0) : right + space_right
            ]
            inside = min(bottom - space_below, left - space_left) >= 0
            if inside and not around.any() and not self._kept_free[bottom:top, left:right].any():
                self._cells[bottom:top, left:right] = OCCUPIED
                return

    def _draw_side(self, low: int, high: int, length: int, choice: float, place: float) -> tuple[int, int, int]:
        """Return where a piece begins along one side of a room and the space it needs before and
        behind: a third each at a wall.
        """
        if choice < 1 / 3:
            return low, 0, self._gap
        if choice < 2 / 3:
            return high - length, self._gap, 0
        return low + int(place * (high - low - length)), self._gap, self._gap
