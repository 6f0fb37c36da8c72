"""Narrow passages: the gaps that are wanted give way there to the room that the path leaves."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from arena_kernels.compiled import compiled
from arena_kernels.costmap_window import CostmapWindow, Outline
from arena_kernels.passage import reduced_gap, room_along
from arena_mppi.parameters import Doubles
from arena_mppi.settings import Static

AHEAD = 1.0  # m of path that a passage may be ahead
KEPT, NEAR = 0.5, 0.9  # shares of its room that the robot keeps, and below which a wall is near


@compiled
def room_ahead(window: CostmapWindow, outline: Outline, path: Doubles, x: float, y: float, enough: float) -> float:
    """Return the room, m, that ``path`` (M, 3) leaves a robot at (x, y) over the next AHEAD m,
    inf if that is ``enough``.
    """
    room = room_along(window, outline, path, (x, y), AHEAD)
    return room if room < enough else math.inf


def eased_static(static: Static, room: float) -> Static:
    """Return the critic of walls as it is where the path leaves ``room`` m on either side."""
    if not (static.eased and 0.0 < room < np.inf):
        return static
    share = min(1.0, room / static.near_collision_gap) ** 2
    near, least = (
        reduced_gap(static.near_collision_gap, room, NEAR, 1e-3),
        reduced_gap(static.collision_gap, room, KEPT, 0.0),
    )
    weight, time = share * static.weight, share * static.reaction_time
    return replace(static, weight=weight, reaction_time=time, near_collision_gap=near, collision_gap=least)
