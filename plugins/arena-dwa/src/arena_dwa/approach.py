"""The approach critic: what comes nearer between successive local maps is expected to go on doing so."""

from __future__ import annotations

from collections import deque

import numpy as np

from arena_dwa.columns import X, Y
from arena_dwa.settings import Approach, BodyOnWindow, FieldArray
from arena_dwa.trajectory import PlanarPose, compose_poses, pose_after_arc
from arena_kernels.compiled import TypedDispatch, borrowing, compiled
from arena_kernels.costmap_window import CostmapWindow, outline_clearance

STEPS = 10  # that an arc is looked at, evenly over the critic's time


@compiled
def closing_speed(
    before: FieldArray,
    now: FieldArray,
    resolution: float,
    down: int,
    left: int,
    lapse: float,
    least: float,
    greatest: float,
) -> FieldArray:
    """Return how fast the nearest obstacle comes nearer to each place of the window, m/s, (H, W).

    ``before`` is the distance field ``lapse`` s ago, whose corner lies (down, left) cells away from now's;
    ``resolution`` in m. Speeds below ``least`` are noise and count as 0, as does an obstacle where the window did not
    reach before: a wall that comes into the window does not come at the robot. Speeds above ``greatest`` are what has
    just come into view.
    """
    rows, columns = now.shape
    last_row, last_column = before.shape[0] - 1, before.shape[1] - 1
    speeds = np.zeros((rows, columns), np.float32)
    first, end = max(0, -left), min(columns, before.shape[1] - left)
    for row in range(max(0, -down), min(rows, before.shape[0] - down)):
        r = row + down
        to_row_edge, was, is_now, out = (
            min(r, last_row - r),
            before[r, first + left :],
            now[row, first:end],
            speeds[row, first:],
        )
        for k in range(len(is_now)):  # without a branch: in vector registers
            c = first + k + left
            # to the nearest cell beyond the window
            outside = (min(to_row_edge, min(c, last_column - c)) + 1) * resolution
            speed = (was[k] - is_now[k]) / lapse
            out[k] = min(speed, greatest) if (least <= speed) & (is_now[k] < outside) else 0.0
    return speeds


@borrowing
def approach_cost(
    ground: BodyOnWindow, speeds: FieldArray, approach: Approach, start: PlanarPose, sample: tuple[float, float, float]
) -> float:
    """Return the mean over ``approach.time`` of how much more an arc lacks clearance once what approaches has come
    nearer.

    Lack is the square of the share of ``approach.margin`` that is missing; clearance at time t is expected to be the
    present one less closing speed times t, which no steadily moving obstacle undercuts.
    """
    vx, vy, wz = sample
    lapse = approach.time / STEPS
    step = pose_after_arc(vx, vy, wz, lapse)
    stand, total = start, 0.0
    for k in range(1, STEPS + 1):
        stand = compose_poses(stand, step)
        row, column = (
            int((stand[Y] - ground.window.origin_y) / ground.window.resolution),
            int((stand[X] - ground.window.origin_x) / ground.window.resolution),
        )
        if not (0 <= row < speeds.shape[0] and 0 <= column < speeds.shape[1]):
            break
        if speeds[row, column] > 0.0:
            nearer = speeds[row, column] * lapse * k
            gap = outline_clearance(ground.window, ground.body.outline, stand, approach.margin + nearer)
            total += clearance_shortfall(gap - nearer, approach.margin) - clearance_shortfall(gap, approach.margin)
    return total / STEPS


@borrowing
def clearance_shortfall(gap: float, margin: float) -> float:
    """Return the square of the share of ``margin`` that ``gap`` falls short of it."""
    return max(0.0, 1.0 - gap / margin) ** 2


class ClosingSpeeds:
    """Remembers the windows of the last ``lapse`` s, to compare the newest with the oldest."""

    def __init__(self, lapse: float, least: float, greatest: float) -> None:
        self._fields: deque[tuple[float, CostmapWindow]] = deque()
        self._closing_speed = TypedDispatch(closing_speed)
        self._lapse = lapse
        self._least = least
        self._greatest = greatest

    def clear(self) -> None:
        """Forget all."""
        self._fields.clear()

    def update(self, stamp: float, window: CostmapWindow) -> FieldArray:
        """Take in the window at ``stamp`` (s) and return the closing speed at each of its cells."""
        self._fields.append((stamp, window))
        while stamp - self._fields[0][0] > self._lapse + 1e-9:
            self._fields.popleft()
        began, before = self._fields[0]
        if stamp - began <= 0.0 or before.resolution != window.resolution:
            return np.zeros(window.distance.shape, np.float32)
        left = round((window.origin_x - before.origin_x) / window.resolution)
        down = round((window.origin_y - before.origin_y) / window.resolution)
        lapse, fields = stamp - began, (before.distance, window.distance)
        return self._closing_speed(*fields, window.resolution, down, left, lapse, self._least, self._greatest)
