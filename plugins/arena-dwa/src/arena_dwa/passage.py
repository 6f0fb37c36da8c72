"""The padding gives way where the path leads through a passage that leaves less room."""

from __future__ import annotations

from arena_dwa.columns import Y
from arena_dwa.settings import BodyOnWindow, FloatArray
from arena_kernels.compiled import borrowing, compiled
from arena_kernels.costmap_window import Outline
from arena_kernels.passage import KEPT, reduced_gap, room_along


@compiled
def padding_along(
    ground: BodyOnWindow, path: FloatArray, place: tuple[float, float], ahead: float, least: float
) -> float:
    """Return the padding, m, with which a robot at (x, y) can drive the next ``ahead`` m of
    ``path`` (M, 3), at least ``least``.
    """
    x, y = place
    room = room_along(ground.window, ground.body.outline, path, (x, y), ahead) - side_excess(ground.body.outline)
    return reduced_gap(ground.body.padding, room, KEPT, least)


@borrowing
def side_excess(outline: Outline) -> float:
    """Return how much farther, m, a robot's sides are than the circle inside its outline: a
    car's lies about its rear axle.
    """
    most = 0.0
    for i in range(len(outline.points_xy)):
        most = max(most, abs(outline.points_xy[i, Y]) - outline.inscribed_radius)
    return most
