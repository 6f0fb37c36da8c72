"""Ways round what blocks a path, to its left and to its right: where an optimisation begins
decides which side its plan passes.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from arena_kernels.compiled import borrowing, inner
from arena_kernels.costmap_window import CostmapWindow, distance_at
from arena_kernels.foreseen import Foreseen, leg_at
from arena_mpc.arrays import FloatArray
from arena_mpc.columns import THETA, X, Y
from arena_mpc.scene import Scene

SPACING = 0.1  # m, between two places beside the path that are tried
SLOPE = 1.0  # m aside for each metre along the path, on the way out and back


def path_detours(
    path: FloatArray, scene: Scene, radius: float, gap: float, speed: float, most: float
) -> Iterator[FloatArray]:
    """Yield ``path`` (M, 3) led round what blocks it by at most ``most`` m, the shorter way first; nothing where it is
    free.

    A disc of ``radius`` m must not touch what stands, nor come nearer than ``gap`` m to what moves as it is when it
    comes by at ``speed`` m/s.
    """
    along = np.append(0.0, np.cumsum(np.hypot(*np.diff(path[:, :2], axis=0).T)))
    moving = scene.foreseen, scene.radii + radius + gap
    ways = []
    for side in (1.0, -1.0):
        aside = np.zeros(len(path))
        lead_aside(path, along, side, scene.window, *moving, radius, speed, most, np.zeros(len(path)), aside)
        ways.append((float(aside.max()), side, aside))
    for least, side, aside in sorted(ways, key=lambda way: way[0]):
        if 0.0 < least <= most:
            shift = side * aside
            yield np.column_stack(
                (
                    path[:, X] - shift * np.sin(path[:, THETA]),
                    path[:, Y] + shift * np.cos(path[:, THETA]),
                    path[:, THETA],
                )
            )


@borrowing
def lead_aside(
    path: FloatArray,
    along: FloatArray,
    side: float,
    window: CostmapWindow,
    foreseen: Foreseen,
    reaches: FloatArray,
    radius: float,
    speed: float,
    most: float,
    needed: FloatArray,
    aside: FloatArray,
) -> None:
    """Write to ``needed`` (M,) how far beside a path its poses are free, m, and to ``aside`` (M,) that spread along it
    at SLOPE.

    Both begin as zeros; more than ``most`` where a pose is nowhere free.
    """
    for i in range(len(path)):
        nx, ny, time = -side * math.sin(path[i, THETA]), side * math.cos(path[i, THETA]), along[i] / speed
        while needed[i] <= most and _is_blocked(
            path[i, X] + needed[i] * nx, path[i, Y] + needed[i] * ny, time, window, foreseen, reaches, radius
        ):
            needed[i] += SPACING
    for i in range(len(path)):
        for j in range(len(path)):
            aside[i] = max(aside[i], needed[j] - SLOPE * abs(along[i] - along[j]))


@inner
def _is_blocked(
    x: float, y: float, time: float, window: CostmapWindow, foreseen: Foreseen, reaches: FloatArray, radius: float
) -> bool:
    """Return whether a disc of ``radius`` m at (x, y) touches what stands, or one that moves is within its ``reaches``
    (P,) in ``time`` s.
    """
    if distance_at(window, x, y) < radius:
        return True
    leg = leg_at(foreseen, time)
    since = time - foreseen.times[leg]
    for m in range(len(reaches)):
        dx, dy = (
            x - foreseen.places[m, leg, X] - since * foreseen.velocities[m, leg, X],
            y - foreseen.places[m, leg, Y] - since * foreseen.velocities[m, leg, Y],
        )
        if dx * dx + dy * dy < reaches[m] * reaches[m]:
            return True
    return False
