"""Cells marked by scan hits, and cleared where a later beam passes through: an array (H, W) of when each was last hit,
s, or NEVER.

Cell (r, c) covers [column0 + c, column0 + c + 1) x [row0 + r, row0 + r + 1) times the resolution, in ``map``: whichever
part of the plane an array covers, cells are the same.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arena_core import LaserScan, Pose
from arena_kernels.compiled import borrowing
from arena_navigation.columns import THETA, X, Y

NEVER = np.float32(-np.inf)
HIT_NOW = np.float32(-1.0)  # while a scan is taken in: stamps are never below 0


class MarkingRange(NamedTuple):
    """How far beams count, m: hits up to ``marking``, free space up to ``clearing``; and what is forgotten.

    Hits within ``body`` of the robot's centre are its own and do not count. Marks that were not hit again for
    ``forget_after`` s go.
    """

    marking: float
    clearing: float
    body: float
    forget_after: float


class PlacedScan(NamedTuple):
    """A scan in ``map``: the sensor's and the robot's pose (x, y, heading), and the scan's own figures."""

    ranges: NDArray[np.float32]
    angle_min: float
    angle_increment: float
    range_min: float
    range_max: float
    stamp: float
    sensor: tuple[float, float, float]
    robot: tuple[float, float]

    @staticmethod
    def of(scan: LaserScan, pose: Pose) -> PlacedScan:
        """Place a scan that was taken from ``pose`` (base_link in ``map``)."""
        sensor = pose.compose(scan.mount)
        return PlacedScan(
            np.ascontiguousarray(scan.ranges, np.float32),
            float(scan.angle_min),
            float(scan.angle_increment),
            float(scan.range_min),
            float(scan.range_max),
            float(scan.stamp),
            (float(sensor.x), float(sensor.y), float(sensor.theta)),
            (float(pose.x), float(pose.y)),
        )


class MarkedCells(NamedTuple):
    """When each cell (H, W) was last hit, and which cells these are: the first row and column, and a cell's side, m."""

    hit_at: NDArray[np.float32]
    row0: int
    column0: int
    resolution: float


@borrowing
def update_marks(cells: MarkedCells, beams: PlacedScan, reach: MarkingRange) -> None:
    """Forget, clear and mark: what is hit now stays.

    So it is marked first, as below 0, and need not be looked at to be cleared.
    """
    oldest = np.float32(beams.stamp - reach.forget_after)
    now = np.float32(beams.stamp)
    _mark_cells(cells, beams, reach, HIT_NOW)
    _clear_marks(cells, beams, reach, oldest)
    hits = cells.hit_at.reshape(-1)
    for i in range(len(hits)):
        kept = NEVER if hits[i] < oldest else hits[i]
        hits[i] = now if hits[i] == HIT_NOW else kept


@borrowing
def _clear_marks(cells: MarkedCells, beams: PlacedScan, reach: MarkingRange, oldest: np.float32) -> None:
    """Clear marks under the robot, and those that a beam passes; not those that are too old to stay anyway.

    Instead of following every beam through all its cells, look up for each marked cell, of which there are few, the
    beams that cross the disc inside it: the marks that ray tracing clears, without those whose corner is merely grazed.
    """
    first_row = max(math.floor((beams.sensor[Y] - reach.clearing) / cells.resolution) - cells.row0, 0)
    last_row = min(
        math.floor((beams.sensor[Y] + reach.clearing) / cells.resolution) - cells.row0, cells.hit_at.shape[0] - 1
    )
    first_column = max(math.floor((beams.sensor[X] - reach.clearing) / cells.resolution) - cells.column0, 0)
    last_column = min(
        math.floor((beams.sensor[X] + reach.clearing) / cells.resolution) - cells.column0, cells.hit_at.shape[1] - 1
    )
    for row in range(first_row, last_row + 1):
        y = (cells.row0 + row + 0.5) * cells.resolution
        for column in range(first_column, last_column + 1):
            hit = cells.hit_at[row, column]
            if hit < 0.0 or hit < oldest:
                continue
            x = (cells.column0 + column + 0.5) * cells.resolution
            beneath = math.hypot(x - beams.robot[X], y - beams.robot[Y]) < reach.body
            if beneath or seen_through(
                x - beams.sensor[X], y - beams.sensor[Y], 0.5 * cells.resolution, beams, reach.clearing
            ):
                cells.hit_at[row, column] = NEVER


@borrowing
def seen_through(dx: float, dy: float, radius: float, beams: PlacedScan, clearing: float) -> bool:
    """Return whether a beam crosses the disc of ``radius`` at (dx, dy) from the sensor and ends behind it."""
    away = math.hypot(dx, dy)
    if away <= radius or away + radius > min(clearing, beams.range_max):
        return False
    turn = 2.0 * math.pi
    bearing = (math.atan2(dy, dx) - beams.sensor[THETA] - beams.angle_min) % turn
    half_width = math.asin(radius / away)
    for centre in (bearing, bearing - turn):  # the disc may lie astride the first beam
        first = max(math.ceil((centre - half_width) / beams.angle_increment), 0)
        last = min(math.floor((centre + half_width) / beams.angle_increment), len(beams.ranges) - 1)
        for beam in range(first, last + 1):
            if beams.ranges[beam] >= away + radius:
                return True
    return False


@borrowing
def mark_hits(cells: MarkedCells, beams: PlacedScan, reach: MarkingRange) -> None:
    """Note the stamp in the cell behind every beam's end."""
    _mark_cells(cells, beams, reach, np.float32(beams.stamp))


@borrowing
def _mark_cells(cells: MarkedCells, beams: PlacedScan, reach: MarkingRange, note: np.float32) -> None:
    """Write a note to the cell behind every beam's end.

    A beam ends on a surface, which often is the very edge of a cell: half a cell farther lies what it belongs to.
    """
    farthest = min(reach.marking, beams.range_max)
    for beam in range(len(beams.ranges)):
        distance = beams.ranges[beam]
        if not beams.range_min <= distance <= farthest:
            continue
        angle = beams.sensor[THETA] + beams.angle_min + beam * beams.angle_increment
        c, s = math.cos(angle), math.sin(angle)
        if (
            math.hypot(beams.sensor[X] + distance * c - beams.robot[X], beams.sensor[Y] + distance * s - beams.robot[Y])
            < reach.body
        ):
            continue
        x = beams.sensor[X] + (distance + 0.5 * cells.resolution) * c
        y = beams.sensor[Y] + (distance + 0.5 * cells.resolution) * s
        row, column = math.floor(y / cells.resolution) - cells.row0, math.floor(x / cells.resolution) - cells.column0
        if 0 <= row < cells.hit_at.shape[0] and 0 <= column < cells.hit_at.shape[1]:
            cells.hit_at[row, column] = note
