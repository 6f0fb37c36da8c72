"""Half-planes of static obstacles: the convex free space round the effective centre.

The nearest lethal cell gives a half-plane, what lies behind it is dropped, and so on (Deits and Tedrake 2015; Liu et
al. 2017).
"""

from __future__ import annotations

import math

from arena_kernels.compiled import borrowing
from arena_kernels.costmap_window import LETHAL, CostmapWindow, Outline
from arena_kernels.half_planes import FloatArray, put_bound
from arena_orca.columns import AWAY, X, Y
from arena_orca.parameters import OMNIDIRECTIONAL, Body, StaticRules

MOST_WALLS = 12  # half-planes, of which a convex region of a few metres hardly needs more
MOST_CELLS = 4096


@borrowing
def near_cells(
    window: CostmapWindow, x: float, y: float, cosine: float, sine: float, reach: float, cells: FloatArray
) -> int:
    """Write the lethal cells within ``reach`` m of (x, y) as rows (x, y, distance), seen from
    there; return how many there are.
    """
    rows, columns = window.costs.shape
    u, v, span = (
        (x - window.origin_x) / window.resolution - 0.5,
        (y - window.origin_y) / window.resolution - 0.5,
        reach / window.resolution,
    )
    count = 0
    for row in range(max(0, math.ceil(v - span)), min(rows - 1, math.floor(v + span)) + 1):
        for column in range(max(0, math.ceil(u - span)), min(columns - 1, math.floor(u + span)) + 1):
            squared = (row - v) ** 2 + (column - u) ** 2
            if window.costs[row, column] >= LETHAL and squared <= span * span and count < len(cells):
                dx, dy = (column - u) * window.resolution, (row - v) * window.resolution
                cells[count, X], cells[count, Y] = cosine * dx + sine * dy, cosine * dy - sine * dx
                cells[count, AWAY] = math.sqrt(squared) * window.resolution
                count += 1
    return count


@borrowing
def radius_towards(body: Body, outline: Outline, nx: float, ny: float) -> float:
    """Return how far the robot reaches from its effective centre in direction (nx, ny), m, its
    front half however it turns.
    """
    if body.kinematics == OMNIDIRECTIONAL:
        return body.whole
    if len(outline.points_xy) == 0:
        return max(body.front, outline.radius - body.ahead * nx)
    reach = body.front
    for i in range(len(outline.points_xy)):
        reach = max(reach, (outline.points_xy[i, X] - body.ahead) * nx + outline.points_xy[i, Y] * ny)
    return reach


@borrowing
def put_walls(
    lines: FloatArray,
    row: int,
    window: CostmapWindow,
    outline: Outline,
    body: Body,
    rules: StaticRules,
    centre: tuple[float, float, float, float],
    speed: float,
    cells: FloatArray,
) -> int:
    """Write the half-planes of what stands round the effective centre ``centre`` (x, y, cosine, sine); return the next
    row.

    A gap may close within ``rules.horizon`` s at the earliest; a gap that is missing is made within
    ``rules.overlap_time`` s.
    """
    reach = body.whole + rules.margin + speed * rules.horizon
    count = near_cells(window, centre[0], centre[1], centre[2], centre[3], reach, cells)
    for _ in range(MOST_WALLS):
        nearest = -1
        for i in range(count):
            if nearest < 0 or cells[i, AWAY] < cells[nearest, AWAY]:
                nearest = i
        if nearest < 0:
            break
        away = cells[nearest, AWAY]
        nx, ny = (cells[nearest, X] / away, cells[nearest, Y] / away) if away > 1e-9 else (1.0, 0.0)
        gap = away - 0.5 * window.resolution - radius_towards(body, outline, nx, ny) - rules.margin
        put_bound(lines, row, nx, ny, gap / (rules.horizon if gap > 0.0 else rules.overlap_time))
        row += 1
        left = 0
        for i in range(count):
            if cells[i, X] * nx + cells[i, Y] * ny < away - 1e-6:
                cells[left, X], cells[left, Y], cells[left, AWAY] = cells[i, X], cells[i, Y], cells[i, AWAY]
                left += 1
        count = left
    return row
