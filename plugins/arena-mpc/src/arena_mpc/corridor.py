"""What stands still, as half-planes: round each stage of a plan the nearest obstacle cells cut
a convex piece of free ground.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from arena_kernels.compiled import compiled, inner
from arena_kernels.costmap_window import LETHAL, CostmapWindow, distance_at
from arena_mpc.arrays import FloatArray
from arena_mpc.columns import PLANE_OFFSET, PLANE_X, PLANE_Y, X, Y

AWAY = 2  # column of near cells behind X and Y: squared distance, m^2
FREE = -1e3  # offset of a half-plane that holds everything, m
NO_DIRECTION = 1e-6  # m
FACING = 0.3  # cosine between the normals of half-planes, below which they may bound a passage
BESIDE = 0.3  # cosine between a half-plane's normal and the way across a passage, above which it bounds that
# share of half the way across that is free about its middle: at most 0.71 in a corner, from 0.8 in a passage
BETWEEN = 0.75
TOLERANCE = 0.04  # m, by which a passage is left wider than its middle


@compiled
def boundary_cells(costs: NDArray[np.uint8], resolution: float, origin_x: float, origin_y: float) -> FloatArray:
    """Return the centres (P, 2) of the lethal cells that have a free neighbour: no other cell is ever the nearest."""
    rows, columns = costs.shape
    found = np.empty((rows * columns, 2))
    count = 0
    for row in range(rows):
        for column in range(columns):
            if costs[row, column] < LETHAL:
                continue
            if (
                (row > 0 and costs[row - 1, column] < LETHAL)
                or (row < rows - 1 and costs[row + 1, column] < LETHAL)
                or (column > 0 and costs[row, column - 1] < LETHAL)
                or (column < columns - 1 and costs[row, column + 1] < LETHAL)
            ):
                found[count, X] = origin_x + (column + 0.5) * resolution
                found[count, Y] = origin_y + (row + 0.5) * resolution
                count += 1
    return found[:count].copy()


@compiled
def half_planes(
    window: CostmapWindow,
    cells: FloatArray,
    centres: FloatArray,
    radius: float,
    wanted: float,
    cutoff: float,
    count: int,
) -> FloatArray:
    """Return (Q, ``count``, 3) half-planes n . p >= b that keep discs at ``centres`` (Q, 2) of ``radius`` m ``wanted``
    m off ``cells``.

    The first is bounded by the nearest cell, the next by the nearest one that the first does not already shut out, and
    so on (after Liu et al., Planning Dynamically Feasible Trajectories for Quadrotors using Safe Flight Corridors,
    2017, with discs for ellipsoids). Cells beyond ``cutoff`` m are left out. From within an obstacle the nearest cell
    of its edge is the way out.
    """
    planes = np.zeros((len(centres), count, 3))
    planes[:, :, PLANE_OFFSET] = FREE
    near = np.empty((len(cells), 3))
    half = 0.5 * window.resolution
    rows, columns = window.costs.shape
    for q in range(len(centres)):
        x, y = centres[q, X], centres[q, Y]
        left = 0
        for i in range(len(cells)):
            dx, dy = x - cells[i, X], y - cells[i, Y]
            away = dx * dx + dy * dy
            if away < cutoff * cutoff:
                near[left, X], near[left, Y], near[left, AWAY] = cells[i, X], cells[i, Y], away
                left += 1
        row, column = (
            math.floor((y - window.origin_y) / window.resolution),
            math.floor((x - window.origin_x) / window.resolution),
        )
        inside = 0 <= row < rows and 0 <= column < columns and window.costs[row, column] >= LETHAL
        for j in range(count):
            if left == 0:
                break
            nearest = 0
            for i in range(1, left):
                if near[i, AWAY] < near[nearest, AWAY]:
                    nearest = i
            ox, oy, away = near[nearest, X], near[nearest, Y], math.sqrt(near[nearest, AWAY])
            if away < NO_DIRECTION:
                break
            sign = -1.0 if inside else 1.0
            nx, ny = sign * (x - ox) / away, sign * (y - oy) / away
            edge = nx * ox + ny * oy + half * (abs(nx) + abs(ny))
            planes[q, j, PLANE_X], planes[q, j, PLANE_Y], planes[q, j, PLANE_OFFSET] = nx, ny, edge + radius + wanted
            if inside:
                break
            kept = 0
            for i in range(left):
                if nx * near[i, X] + ny * near[i, Y] > nx * ox + ny * oy + 1e-9:
                    near[kept, X], near[kept, Y], near[kept, AWAY] = near[i, X], near[i, Y], near[i, AWAY]
                    kept += 1
            left = kept
        ease_passage(window, planes[q], x, y, radius, wanted)
    return planes


@inner
def ease_passage(window: CostmapWindow, planes: FloatArray, x: float, y: float, radius: float, wanted: float) -> None:
    """Where half-planes that face each other leave no room about (x, y), move them apart until its middle lies in both.

    In a passage that is narrower than the ``wanted`` gap on both sides, the gap gives way. The planes become parallel
    to each other: else those round the posts of a door would push a plan back out of it.
    """
    other = facing_plane(window, planes, x, y, radius, wanted)
    if other == 0:
        return
    first, second = planes[0], planes[other]
    left = first[PLANE_X] * x + first[PLANE_Y] * y - first[PLANE_OFFSET]
    right = second[PLANE_X] * x + second[PLANE_Y] * y - second[PLANE_OFFSET]
    lack = min(0.5 * (TOLERANCE - left - right), wanted)
    if lack <= 0.0:
        return
    nx, ny = first[PLANE_X] - second[PLANE_X], first[PLANE_Y] - second[PLANE_Y]
    length = math.hypot(nx, ny)
    nx, ny = nx / length, ny / length
    for plane in planes:
        across = nx * plane[PLANE_X] + ny * plane[PLANE_Y]
        if plane[PLANE_OFFSET] > 0.5 * FREE and abs(across) > BESIDE:
            sign = math.copysign(1.0, across)
            plane[PLANE_X], plane[PLANE_Y] = sign * nx, sign * ny
            plane[PLANE_OFFSET] = plane[PLANE_X] * x + plane[PLANE_Y] * y - lack - (left if sign > 0.0 else right)


@inner
def facing_plane(window: CostmapWindow, planes: FloatArray, x: float, y: float, radius: float, wanted: float) -> int:
    """Return the first half-plane that bounds a passage with the first of all, 0 if none does.

    A disc fits between their cells, and nothing stands nearer to the middle between them than they do, as it does in a
    corner.
    """
    half = 0.5 * window.resolution
    px, py = bounding_point(planes[0], x, y, radius + wanted, half)
    for j in range(1, len(planes)):
        if (
            planes[j, PLANE_OFFSET] > 0.5 * FREE
            and planes[0, PLANE_X] * planes[j, PLANE_X] + planes[0, PLANE_Y] * planes[j, PLANE_Y] < FACING
        ):
            qx, qy = bounding_point(planes[j], x, y, radius + wanted, half)
            free, across = distance_at(window, 0.5 * (px + qx), 0.5 * (py + qy)) + half, math.hypot(px - qx, py - qy)
            if free > max(radius, BETWEEN * 0.5 * across):
                return j
    return 0


@inner
def bounding_point(plane: FloatArray, x: float, y: float, reach: float, half: float) -> tuple[float, float]:
    """Return the centre of the cell that bounds a half-plane made from (x, y); ``half`` is half a cell's side."""
    nx, ny = plane[PLANE_X], plane[PLANE_Y]
    away = nx * x + ny * y - plane[PLANE_OFFSET] + reach + half * (abs(nx) + abs(ny))
    return x - away * nx, y - away * ny


@compiled
def nearest_cells(
    cells: FloatArray,
    centres: FloatArray,
    headings: FloatArray,
    radius: float,
    forced: float,
    cutoff: float,
    count: int,
) -> FloatArray:
    """Return (Q, ``count``, 3) rows x, y, ``radius``: the ``cells`` that ``centres`` (Q, 2) have to keep ``radius`` m
    from.

    Those within ``forced`` m, the nearest first, and within ``cutoff`` m the nearest to the left and to the right of
    ``headings`` (Q,) (after Rösmann et al. 2021 and mpc_local_planner). Rows without a cell stand far away.
    """
    rows = np.zeros((len(centres), count, 3))
    rows[:, :, :2] = -FREE
    near = np.empty(len(cells))
    for q in range(len(centres)):
        nearest = np.full(2, -1)
        ahead_x, ahead_y = math.cos(headings[q]), math.sin(headings[q])
        for i in range(len(cells)):
            dx, dy = cells[i, X] - centres[q, X], cells[i, Y] - centres[q, Y]
            near[i] = dx * dx + dy * dy
            side = 0 if ahead_x * dy - ahead_y * dx > 0.0 else 1
            if near[i] < cutoff * cutoff and (nearest[side] < 0 or near[i] < near[nearest[side]]):
                nearest[side] = i
        filled = 0
        for i in nearest:
            if i >= 0 and filled < count:
                rows[q, filled, PLANE_X], rows[q, filled, PLANE_Y], rows[q, filled, PLANE_OFFSET] = (
                    cells[i, X],
                    cells[i, Y],
                    radius,
                )
                near[i] = math.inf
                filled += 1
        while filled < count and len(cells) > 0:
            i = int(np.argmin(near))
            if near[i] >= forced * forced:
                break
            rows[q, filled, PLANE_X], rows[q, filled, PLANE_Y], rows[q, filled, PLANE_OFFSET] = (
                cells[i, X],
                cells[i, Y],
                radius,
            )
            near[i] = math.inf
            filled += 1
    return rows
