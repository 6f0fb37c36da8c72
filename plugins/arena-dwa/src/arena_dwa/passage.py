"""The padding gives way where the path leads through a passage that leaves less room."""

from __future__ import annotations

from arena_dwa.settings import BodyOnWindow, FloatArray
from arena_kernels.compiled import compiled
from arena_kernels.passage import KEPT, reduced_gap, room_along


@compiled
def padding_along(
    ground: BodyOnWindow, path: FloatArray, place: tuple[float, float], ahead: float, least: float
) -> float:
    """Return the padding, m, with which a robot at (x, y) can drive the next ``ahead`` m of
    ``path`` (M, 3), at least ``least``.
    """
    x, y = place
    room = room_along(ground.window, ground.body.outline, path, (x, y), ahead)
    return reduced_gap(ground.body.padding, room, KEPT, least)
