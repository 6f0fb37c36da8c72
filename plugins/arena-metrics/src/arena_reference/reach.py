"""Where a disc can be, step by step, as bits of a grid: the earliest instant at which it can be at a goal.

A step reaches the cells of ``arena_reference.values.SPANS``, whose convex hull holds the disc of ``STRIDE`` cells.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from arena_kernels.compiled import compiled
from arena_reference.arrays import Floats, Mask
from arena_reference.body import Moving, place_of
from arena_reference.values import LOOKS, SPANS, WIDEST

Bits = NDArray[np.uint64]  # (H, words): bit i of word w is the cell in column 64 w + i
ONE, FULL = np.uint64(1), np.uint64(0xFFFFFFFFFFFFFFFF)


@compiled
def pack(mask: Mask) -> Bits:
    """Return a mask (H, W) as bits."""
    rows, columns = mask.shape
    bits = np.zeros((rows, (columns + 63) // 64), np.uint64)
    for row in range(rows):
        for column in range(columns):
            if mask[row, column]:
                bits[row, column >> 6] |= ONE << np.uint64(column & 63)
    return bits


@compiled
def earliest_step(free: Bits, goal: Bits, start: tuple[int, int], instants: Floats, moving: Moving) -> int:
    """Return the first step at which the cells that can be reached from ``start`` (row, column) hold one of the goal;
    -1 if that is none of the ``instants`` (s).
    """
    row, column = start
    rows, words = free.shape
    now, after = np.zeros((rows, words), np.uint64), np.zeros((rows, words), np.uint64)
    now[row, column >> 6] = ONE << np.uint64(column & 63)
    low, high, reach = row, row + 1, len(SPANS) - 1  # rows that hold a bit
    strips = np.zeros((2 * reach + 1, WIDEST + 1, words), np.uint64)
    for step in range(len(instants)):
        for r in range(low, high):
            for w in range(words):
                if now[r, w] & goal[r, w]:
                    return step
        if step == len(instants) - 1:
            break
        _clear_people(now, moving, instants, step, 1)
        _spread_bits(now, after, free, (low, high), strips)
        low, high = max(low - reach, 0), min(high + reach, rows)
        _clear_people(after, moving, instants, step + 1, -1)
        now, after = after, now
    return -1


@compiled
def _spread_bits(now: Bits, after: Bits, free: Bits, span: tuple[int, int], strips: Bits) -> None:
    """Write the cells that a step reaches from ``now``, which has bits in a span of rows, to ``after``."""
    low, high = span
    rows, words = now.shape
    reach = len(SPANS) - 1
    ring = 2 * reach + 1
    for row in range(low - 3 * reach, high + reach):
        ahead = row + reach
        into = strips[ahead % ring]
        if low <= ahead < high:
            _widen_bits(now[ahead], into)
        else:
            into[:] = np.uint64(0)
        if not (low - reach <= row and 0 <= row < rows):
            continue
        for w in range(words):
            after[row, w] = np.uint64(0)
        for dy in range(-reach, reach + 1):
            strip = strips[(row + dy) % ring, SPANS[abs(dy)]]
            for w in range(words):
                after[row, w] |= strip[w]
        for w in range(words):
            after[row, w] &= free[row, w]


@compiled
def _widen_bits(row: Bits, strips: Bits) -> None:
    """Write the bits within 0 .. WIDEST columns of those of a row, (WIDEST + 1, words)."""
    words = len(row)
    for w in range(words):
        strips[0, w] = row[w]
    for width in range(1, len(strips)):
        by, back = np.uint64(width), np.uint64(64 - width)
        for w in range(words):
            strips[width, w] = strips[width - 1, w] | (row[w] << by) | (row[w] >> by)
        for w in range(1, words):
            strips[width, w] |= row[w - 1] >> back
        for w in range(words - 1):
            strips[width, w] |= row[w + 1] << back


@compiled
def _clear_people(bits: Bits, moving: Moving, instants: Floats, step: int, way: int) -> None:
    """Take away the cells in which a person is met at an instant, or within half the step ahead (``way`` 1) or behind
    (-1).
    """
    half = 0.5 * abs(instants[step + way] - instants[step])
    for look in range(LOOKS + 1):
        away = half * look / LOOKS
        _clear_discs(bits, moving, instants[step] + way * away, moving.speed * away)


@compiled
def _clear_discs(bits: Bits, moving: Moving, t: float, less: float) -> None:
    rows, columns = len(bits), 64 * bits.shape[1]
    for p in range(len(moving.radii)):
        radius = moving.radii[p] - less
        x, y = place_of(moving.people, p, t)
        if not (radius > 0.0 and abs(x) < 1e6 and abs(y) < 1e6):
            continue  # absent, or no danger
        for row in range(max(0, int(y - radius)), min(rows, int(y + radius) + 1)):
            half = radius * radius - (row + 0.5 - y) ** 2
            if half > 0.0:
                half = math.sqrt(half)
                first = max(0, math.ceil(x - half - 0.5))
                _clear_span(bits[row], first, min(columns, math.floor(x + half - 0.5) + 1))


@compiled
def _clear_span(row: Bits, first: int, last: int) -> None:
    """Clear the bits of the columns first .. last - 1."""
    while first < last:
        word, begin = first >> 6, first & 63
        end = min(last - (word << 6), 64)
        ones = FULL >> np.uint64(64 - (end - begin))
        row[word] &= ~(ones << np.uint64(begin))
        first = (word + 1) << 6
