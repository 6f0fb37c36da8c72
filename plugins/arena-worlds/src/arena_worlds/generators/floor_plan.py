"""Rooms of a floor and the doors between them, in cells."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from arena_worlds.generators.canvas import WALL_CELLS
from arena_worlds.generators.generated import UnsuitableWorld

LONG = 1.25  # a room this much longer than wide is parted across


@dataclass(frozen=True, slots=True)
class Room:
    """A rectangle of free cells: columns ``left`` ..

    ``right``, rows ``bottom`` .. ``top``, the last ones not among them.
    """

    left: int
    bottom: int
    right: int
    top: int

    @property
    def area(self) -> int:
        """Return how many cells it has."""
        return (self.right - self.left) * (self.top - self.bottom)


@dataclass(frozen=True, slots=True)
class Door(Room):
    """An opening in a wall; one goes through it along x if ``along_x``."""

    along_x: bool


def divide_hall(hall: Room, count: int, least: int, random: np.random.Generator) -> list[Room]:
    """Part a hall into ``count`` rooms, always the largest that can be; fewer where no side
    could be ``least`` cells long.
    """
    rooms = [hall]
    while len(rooms) < count:
        able = [room for room in rooms if max(room.right - room.left, room.top - room.bottom) >= 2 * least + WALL_CELLS]
        if not able:
            break
        largest = max(able, key=lambda room: room.area)
        rooms.remove(largest)
        rooms += _split_room(largest, least, random)
    return rooms


def _split_room(room: Room, least: int, random: np.random.Generator) -> tuple[Room, Room]:
    """Return both parts of a room, with a wall between them somewhere in its middle third."""
    width, height = room.right - room.left, room.top - room.bottom
    across = width >= height if max(width, height) > LONG * min(width, height) else bool(random.random() < 0.5)
    if min(width, height) < 2 * least + WALL_CELLS:
        across = width >= height
    side = width if across else height
    begin = int(np.clip(round(float(random.uniform(1 / 3, 2 / 3)) * side), least, side - least - WALL_CELLS))
    end = begin + WALL_CELLS
    if across:
        return Room(room.left, room.bottom, room.left + begin, room.top), Room(
            room.left + end, room.bottom, room.right, room.top
        )
    return Room(room.left, room.bottom, room.right, room.bottom + begin), Room(
        room.left, room.bottom + end, room.right, room.top
    )


def choose_doors(rooms: list[Room], width: int, loops: float, random: np.random.Generator) -> list[Door]:
    """Return doors of ``width`` cells: a random spanning tree of the rooms, and a share ``loops`` of the doors there
    could be beyond it.

    Raises Misdrawn where the walls between rooms are too short for doors to all of them.
    """
    possible = _possible_doors(rooms, width)
    group = list(range(len(rooms)))
    doors = []
    for k in random.permutation(len(possible)).tolist():
        first, second, door, room_to_move = possible[k]
        joins = group[first] != group[second]
        extra, place = random.random(2).tolist()
        if joins or extra < loops:
            group = [group[first] if g == group[second] else g for g in group]
            doors.append(_shift_door(door, int(place * (room_to_move + 1))))
    if len(set(group)) > 1:
        raise UnsuitableWorld(
            f"world: no doors to all of {len(rooms)} rooms; allowed: fewer rooms, "
            "a smaller door_width or a larger least_side"
        )
    return doors


def _possible_doors(rooms: list[Room], width: int) -> list[tuple[int, int, Door, int]]:
    """Return each pair of rooms with room for a door and its posts, the lowest such door, and
    how many cells it could move.
    """
    found = []
    for i, a in enumerate(rooms):
        for j, b in enumerate(rooms):
            if a.right + WALL_CELLS == b.left:
                low, high = max(a.bottom, b.bottom) + WALL_CELLS, min(a.top, b.top) - WALL_CELLS
                door = Door(a.right, low, b.left, low + width, along_x=True)
            elif a.top + WALL_CELLS == b.bottom:
                low, high = max(a.left, b.left) + WALL_CELLS, min(a.right, b.right) - WALL_CELLS
                door = Door(low, a.top, low + width, b.bottom, along_x=False)
            else:
                continue
            if high - low >= width:
                found.append((i, j, door, high - low - width))
    return found


def _shift_door(door: Door, by: int) -> Door:
    if door.along_x:
        return Door(door.left, door.bottom + by, door.right, door.top + by, True)
    return Door(door.left + by, door.bottom, door.right + by, door.top, False)
