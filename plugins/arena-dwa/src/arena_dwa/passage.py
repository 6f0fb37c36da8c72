"""How much room a path leaves the robot, so that the padding gives way in a passage that is narrower than it."""

from __future__ import annotations

import math

from arena_dwa.settings import Body, FloatArray
from arena_kernels.compiled import borrowing, compiled
from arena_kernels.paths import nearest_index
from arena_kernels.window import Outline, Window, clearance

KEPT = 0.7  # share of the room that is kept: the rest is what the robot may be beside its path


@compiled
def padding_along(window: Window, body: Body, path: FloatArray, x: float, y: float, ahead: float, least: float) -> float:
    """Return the padding, m, with which a robot at (x, y) can drive the next ``ahead`` m of ``path`` (M, 3): from ``least`` to the body's.

    A path that leads through an obstacle asks for all of it.
    """
    room = room_along(window, body.outline, path, x, y, ahead, body.padding)
    return body.padding if room <= 0.0 else min(max(least, KEPT * room), body.padding)


@borrowing
def room_along(window: Window, outline: Outline, path: FloatArray, x: float, y: float, ahead: float, enough: float) -> float:
    """Return the least gap, m, of a robot that heads along a path, from its own length behind (x, y) to ``ahead`` m of way beyond it.

    Beyond ``enough`` m a lower bound will do.
    """
    place = nearest_index(path, x, y)
    first, behind = place, 0.0
    while first > 0 and behind < outline.radius:
        behind += math.hypot(path[first, 0] - path[first - 1, 0], path[first, 1] - path[first - 1, 1])
        first -= 1
    room, way = math.inf, -behind
    for i in range(first, len(path)):
        room = min(room, clearance(window, outline, path[i, 0], path[i, 1], math.cos(path[i, 2]), math.sin(path[i, 2]), enough))
        if i + 1 < len(path):
            way += math.hypot(path[i + 1, 0] - path[i, 0], path[i + 1, 1] - path[i, 1])
        if way > ahead:
            break
    return room
