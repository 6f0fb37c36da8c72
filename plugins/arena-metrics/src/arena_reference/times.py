"""Times left to go as a search goes through them: all at once, or, where that is too much, those of a few instants.

The others are computed again, a block of instants at a time, when the search comes to them.
"""

from __future__ import annotations

import math
from mmap import mmap
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arena_kernels.compiled import borrowing, compiled
from arena_reference.arrays import Values
from arena_reference.values import Course, keep_every, times_to_go

MOST = 48 << 20  # bytes of layers that are held all at once


class TimesLeft(NamedTuple):
    """``layers`` (2 B + 2, H, W) hold those of instants from number ``first[0]`` on, two blocks of B and the one after
    them, and at their end what is left when everybody is gone; ``kept`` (K, H, W) are the first ones of the blocks.

    Where all instants are held ``kept`` is empty.
    """

    layers: Values
    first: NDArray[np.int64]
    kept: Values
    course: Course


def times_left(course: Course, last: Values, reach: int) -> TimesLeft:
    """Return the times left to go, from the first instant on; ``last`` (H, W) are those of the last one.

    A search looks ``reach`` instants ahead at most.
    """
    count, first = len(course.instants), np.zeros(1, np.int64)
    if count * last.nbytes <= MOST:
        layers = _room_for(count, last)
        layers[-1] = last
        times_to_go(layers, course, 0)
        return TimesLeft(layers, first, layers[:0], course)
    block = max(reach, math.ceil(math.sqrt(count / 2)))
    kept = _room_for(math.ceil(count / block), last)
    keep_every(kept, block, last, course)
    found = TimesLeft(_room_for(2 * block + 2, last), first, kept, course)
    found.layers[-1] = last
    show_block(found, 0, 0)
    show_block(found, 1, block)
    return found


def _room_for(count: int, layer: Values) -> Values:
    """Return layers (N, H, W) that go back to the system when nobody needs them any more: what an allocator keeps, it
    does not lend to the next problem, whose layers are of another size.
    """
    room = mmap(-1, count * layer.nbytes)
    return np.frombuffer(room, np.uint16).reshape(count, *layer.shape)


@borrowing
def layer_number(times: TimesLeft, step: float) -> int:
    """Return which of the layers is that of the instant at or after a time, in steps."""
    last = len(times.course.instants) - 1
    return len(times.layers) - 1 if step >= last else max(math.ceil(step), 0) - times.first[0]


@compiled
def show_until(times: TimesLeft, step: float) -> None:
    """Hold the instants up to a time, in steps, which is later than those of the calls before."""
    if len(times.kept) == 0:
        return
    block, asked = len(times.layers) // 2 - 1, min(math.ceil(step), len(times.course.instants) - 2)
    while asked >= times.first[0] + 2 * block:
        for i in range(block):
            times.layers[i] = times.layers[block + i]
        times.first[0] += block
        show_block(times, times.first[0] // block + 1, block)


@compiled
def show_block(times: TimesLeft, number: int, at: int) -> None:
    """Compute the layers of a block of instants, by the first one of the next block, from layer ``at`` on."""
    block, final = len(times.layers) // 2 - 1, len(times.course.instants) - 1
    begin, end = number * block, min((number + 1) * block, final)
    if begin >= end:
        return
    layers = times.layers[at : at + end - begin + 1]
    layers[-1] = times.layers[-1] if end == final else times.kept[number + 1]
    times_to_go(layers, times.course, begin)
