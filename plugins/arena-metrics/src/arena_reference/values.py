"""When a disc can be at the goal: earliest times over a grid, among people whose future is known.

A step of the grid lasts as long as the disc needs for ``STRIDE`` cells; in a step it reaches every cell of ``SPANS``,
whose convex hull holds the disc of that radius: so nothing that keeps to the speed gets farther.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from arena_kernels.compiled import compiled
from arena_reference.arrays import Floats, Mask, Values
from arena_reference.body import Moving, place_of

SPANS = np.array((5, 5, 4, 4, 3, 1))  # half widths of the rows 0 .. 5 of the cells within sqrt(26)
STRIDE = 4.919  # cells: the greatest disc within their convex hull
FINE = 16  # parts of a step, in which times are counted
NEVER = np.uint16(65535)
WIDEST = 5  # the greatest of SPANS
LOOKS = 2  # within half a step, before and after an instant


@compiled
def spread(later: Values, now: Values) -> None:
    """Write the least of each cell's reach a step later, plus a step, to ``now`` (H, W)."""
    rows, columns = later.shape
    reach = len(SPANS) - 1
    strips = np.full((2 * reach + 1, WIDEST + 1, columns), NEVER, np.uint16)  # a ring of rows, for each half width
    for row in range(-reach, rows):
        into = (row + reach) % (2 * reach + 1)
        if row + reach < rows:
            _widen_row(later[row + reach], strips[into])
        else:
            strips[into] = NEVER
        if row < 0:
            continue
        target = now[row]
        target[:] = NEVER
        for dy in range(-reach, reach + 1):
            if 0 <= row + dy < rows:
                _lower(target, strips[(row + dy) % (2 * reach + 1), SPANS[abs(dy)]])
        for column in range(columns):
            value = target[column]
            target[column] = value + np.uint16(FINE) if value < NEVER - np.uint16(FINE) else NEVER


@compiled
def _widen_row(row: Values, strips: Values) -> None:
    """Write the least within 0 .. 5 cells to either side of each cell of a row."""
    columns = len(row)
    strips[0] = row
    for width in range(1, len(strips)):
        strips[width] = strips[width - 1]
        _lower(strips[width, width:], row[: columns - width])
        _lower(strips[width, : columns - width], row[width:])


@compiled
def _lower(target: Values, values: Values) -> None:
    for i in range(len(target)):
        target[i] = min(target[i], values[i])


@compiled
def mark_people(blocked: Mask, moving: Moving, instants: Floats, i: int) -> None:
    """Mark the cells (H, W) in which a disc cannot be at instant ``i``: a person is met there and then, or within half
    a step.
    """
    before = instants[i] - instants[max(i - 1, 0)]
    after = instants[min(i + 1, len(instants) - 1)] - instants[i]
    for look in range(-LOOKS, LOOKS + 1):
        away = 0.5 * look / LOOKS * (before if look < 0 else after)
        if look == 0 or away != 0.0:
            _mark_discs(blocked, moving, instants[i] + away, moving.speed * abs(away))


@compiled
def _mark_discs(blocked: Mask, moving: Moving, t: float, less: float) -> None:
    rows, columns = blocked.shape
    for p in range(len(moving.radii)):
        radius = moving.radii[p] - less
        x, y = place_of(moving.people, p, t)
        if not (radius > 0.0 and abs(x) < 1e6 and abs(y) < 1e6):
            continue  # absent, or no danger
        for row in range(max(0, int(y - radius)), min(rows, int(y + radius) + 1)):
            half = radius * radius - (row + 0.5 - y) ** 2
            if half <= 0.0:
                continue
            half = math.sqrt(half)
            first, last = max(0, math.ceil(x - half - 0.5)), min(columns, math.floor(x + half - 0.5) + 1)
            if last > first:
                blocked[row, first:last] = True


@compiled
def goal_values(rows: int, columns: int, x: float, y: float, radius: float) -> Values:
    """Return what is left to do from each cell (H, W) without any step: NEVER outside the goal, ``FINE`` at its rim,
    less inside.

    All lengths in cells. A way that enters the goal in the midst of a step goes on towards its middle, and so counts
    the part of the step that it needed.
    """
    values = np.full((rows, columns), NEVER, np.uint16)
    for row in range(max(0, int(y - radius - 2)), min(rows, int(y + radius + 3))):
        for column in range(max(0, int(x - radius - 2)), min(columns, int(x + radius + 3))):
            away = math.sqrt((column + 0.5 - x) ** 2 + (row + 0.5 - y) ** 2) - radius
            if away <= 0.0:
                values[row, column] = np.uint16(FINE * max(0.0, 1.0 + away / STRIDE))
    return values


@compiled
def static_times(free: Mask, goal: Values) -> Values:
    """Return the time to the goal from each cell (H, W) among things that stand, in parts of a step, FINE at the
    goal's rim; NEVER where no way leads.
    """
    now, later, changed = np.empty_like(goal), goal.copy(), True
    while changed:
        spread(later, now)
        changed = False
        for i in range(free.shape[0]):
            for j in range(free.shape[1]):
                value = min(goal[i, j], now[i, j] if free[i, j] else NEVER)
                changed |= value != later[i, j]
                now[i, j] = value
        now, later = later, now
    return later


class Course(NamedTuple):
    """What times left to go follow from: where a disc may be (H, W), the ``goal`` (H, W), and people at ``instants``
    (N,) s.
    """

    free: Mask
    goal: Values
    instants: Floats
    moving: Moving


@compiled
def times_to_go(layers: Values, course: Course, first: int) -> None:
    """Fill ``layers`` (L, H, W) with the time to the goal from each cell at L instants from number ``first`` on, in
    parts of a step, FINE at the goal's rim.

    The last layer is given: what is left to do from then on.
    """
    blocked = np.empty(course.free.shape, np.bool_)
    for i in range(len(layers) - 2, -1, -1):
        _layer_before(layers[i + 1], layers[i], course, first + i, blocked)


@compiled
def keep_every(kept: Values, every: int, last: Values, course: Course) -> None:
    """Fill ``kept`` (K, H, W) with each ``every``-th of the layers of ``times_to_go``, whose ``last`` one is given."""
    pair = np.empty((2, *last.shape), np.uint16)
    blocked, final = np.empty(last.shape, np.bool_), len(course.instants) - 1
    pair[final % 2] = last
    for i in range(final, -1, -1):
        if i < final:
            _layer_before(pair[(i + 1) % 2], pair[i % 2], course, i, blocked)
        if i % every == 0:
            kept[i // every] = pair[i % 2]


@compiled
def _layer_before(later: Values, now: Values, course: Course, i: int, blocked: Mask) -> None:
    """Write the layer of an instant, whose next one is given; ``blocked`` is room to work in."""
    spread(later, now)
    for row in range(len(now)):
        for column in range(now.shape[1]):
            blocked[row, column] = not course.free[row, column]
    mark_people(blocked, course.moving, course.instants, i)
    for row in range(len(now)):
        _close_row(now[row], blocked[row], course.goal[row])


@compiled
def _close_row(values: Values, blocked: Mask, goal: Values) -> None:
    for column in range(len(values)):
        value = NEVER if blocked[column] else values[column]
        values[column] = min(value, goal[column])
