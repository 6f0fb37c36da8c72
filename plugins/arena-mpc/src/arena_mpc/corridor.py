"""What stands still, as half-planes: round each stage of a plan the nearest obstacle cells cut a convex piece of free ground."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from arena_kernels.compiled import compiled
from arena_kernels.window import LETHAL, Window
from arena_mpc.arrays import FloatArray

FREE = -1e3  # offset of a half-plane that holds everything, m
NO_DIRECTION = 1e-6  # m


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
                found[count, 0] = origin_x + (column + 0.5) * resolution
                found[count, 1] = origin_y + (row + 0.5) * resolution
                count += 1
    return found[:count].copy()


@compiled
def half_planes(window: Window, cells: FloatArray, centres: FloatArray, radius: float, cutoff: float, count: int) -> FloatArray:
    """Return (Q, ``count``, 3) half-planes n . p >= b that keep discs of ``radius`` m, now at ``centres`` (Q, 2), off the ``cells``.

    The first is bounded by the nearest cell, the next by the nearest one that the first does not already shut out, and so on (after
    Liu et al., Planning Dynamically Feasible Trajectories for Quadrotors using Safe Flight Corridors, 2017, with discs for ellipsoids).
    Cells beyond ``cutoff`` m are left out. From within an obstacle the nearest cell of its edge is the way out.
    """
    planes = np.zeros((len(centres), count, 3))
    planes[:, :, 2] = FREE
    near = np.empty((len(cells), 3))
    half = 0.5 * window.resolution
    rows, columns = window.costs.shape
    for q in range(len(centres)):
        x, y = centres[q, 0], centres[q, 1]
        left = 0
        for i in range(len(cells)):
            dx, dy = x - cells[i, 0], y - cells[i, 1]
            away = dx * dx + dy * dy
            if away < cutoff * cutoff:
                near[left, 0], near[left, 1], near[left, 2] = cells[i, 0], cells[i, 1], away
                left += 1
        row, column = math.floor((y - window.origin_y) / window.resolution), math.floor((x - window.origin_x) / window.resolution)
        inside = 0 <= row < rows and 0 <= column < columns and window.costs[row, column] >= LETHAL
        for j in range(count):
            if left == 0:
                break
            nearest = 0
            for i in range(1, left):
                if near[i, 2] < near[nearest, 2]:
                    nearest = i
            ox, oy, away = near[nearest, 0], near[nearest, 1], math.sqrt(near[nearest, 2])
            if away < NO_DIRECTION:
                break
            sign = -1.0 if inside else 1.0
            nx, ny = sign * (x - ox) / away, sign * (y - oy) / away
            edge = nx * ox + ny * oy + half * (abs(nx) + abs(ny))
            planes[q, j, 0], planes[q, j, 1], planes[q, j, 2] = nx, ny, edge + radius
            if inside:
                break
            kept = 0
            for i in range(left):
                if nx * near[i, 0] + ny * near[i, 1] > nx * ox + ny * oy + 1e-9:
                    near[kept, 0], near[kept, 1], near[kept, 2] = near[i, 0], near[i, 1], near[i, 2]
                    kept += 1
            left = kept
    return planes


@compiled
def nearest_cells(
    cells: FloatArray, centres: FloatArray, headings: FloatArray, radius: float, forced: float, cutoff: float, count: int
) -> FloatArray:
    """Return (Q, ``count``, 3) rows x, y, ``radius``: the ``cells`` that ``centres`` (Q, 2) have to keep ``radius`` m from.

    Those within ``forced`` m, the nearest first, and within ``cutoff`` m the nearest to the left and to the right of ``headings`` (Q,)
    (after Rösmann et al. 2021 and mpc_local_planner). Rows without a cell stand far away.
    """
    rows = np.zeros((len(centres), count, 3))
    rows[:, :, :2] = -FREE
    near = np.empty(len(cells))
    for q in range(len(centres)):
        nearest = np.full(2, -1)
        ahead_x, ahead_y = math.cos(headings[q]), math.sin(headings[q])
        for i in range(len(cells)):
            dx, dy = cells[i, 0] - centres[q, 0], cells[i, 1] - centres[q, 1]
            near[i] = dx * dx + dy * dy
            side = 0 if ahead_x * dy - ahead_y * dx > 0.0 else 1
            if near[i] < cutoff * cutoff and (nearest[side] < 0 or near[i] < near[nearest[side]]):
                nearest[side] = i
        filled = 0
        for i in nearest:
            if i >= 0 and filled < count:
                rows[q, filled, 0], rows[q, filled, 1], rows[q, filled, 2] = cells[i, 0], cells[i, 1], radius
                near[i] = math.inf
                filled += 1
        while filled < count and len(cells) > 0:
            i = int(np.argmin(near))
            if near[i] >= forced * forced:
                break
            rows[q, filled, 0], rows[q, filled, 1], rows[q, filled, 2] = cells[i, 0], cells[i, 1], radius
            near[i] = math.inf
            filled += 1
    return rows
