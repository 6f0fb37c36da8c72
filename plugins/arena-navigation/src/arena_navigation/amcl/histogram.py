"""Which bins of (x, y, theta) hold particles: the measure of how spread out they are."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arena_kernels.compiled import borrowing
from arena_kernels.scalars import Integer
from arena_navigation.columns import THETA, X, Y

BIN_SIZE = 0.5  # m (ROS amcl)
BINS_A_TURN = 36  # 10 degrees each (ROS amcl)

_ROW = 1 << 27  # a key is row, column and heading bin packed in one integer
_COLUMN = 1 << 6
_MIDDLE = 1 << 20
_GOLDEN = np.uint64(0x9E3779B97F4A7C15)


class Histogram(NamedTuple):
    """A hash table of bins, numbered as they were added: ``keys`` -1 where empty, ``numbers``;
    ``slots`` is where bin b lies.
    """

    keys: NDArray[np.int64]
    numbers: NDArray[np.int32]
    slots: NDArray[np.int32]


def make_histogram(capacity: int) -> Histogram:
    """Return an empty histogram for up to ``capacity`` bins."""
    size = 1 << max(4, math.ceil(math.log2(2 * capacity)))
    return Histogram(np.full(size, -1, np.int64), np.empty(size, np.int32), np.empty(capacity, np.int32))


@borrowing
def bin_key(x: float, y: float, theta: float) -> Integer:
    """Return the key of the bin that holds a pose with its heading in [-pi, pi]; -pi and pi share one."""
    column = np.int64(np.floor(x / BIN_SIZE)) + _MIDDLE
    row = np.int64(np.floor(y / BIN_SIZE)) + _MIDDLE
    heading = np.int64((theta + np.pi) * (BINS_A_TURN / (2.0 * np.pi)))
    return row * _ROW + column * _COLUMN + (heading if heading < BINS_A_TURN else 0)


@borrowing
def write_keys(poses: NDArray[np.float64], count: Integer, keys: NDArray[np.int64]) -> None:
    """Write the bin's key of each of ``count`` poses (3, P)."""
    for i in range(count):
        keys[i] = bin_key(poses[X, i], poses[Y, i], poses[THETA, i])


@borrowing
def neighbour_key(key: Integer, rows: int, columns: int, headings: int) -> Integer:
    """Return the key of the bin so many rows, columns and headings away."""
    heading = key % _COLUMN
    return key - heading + rows * _ROW + columns * _COLUMN + (heading + headings) % BINS_A_TURN


@borrowing
def _find_slot(bins: Histogram, key: Integer) -> Integer:
    """Return where ``key`` lies, or the empty slot where it would."""
    mask = len(bins.keys) - 1
    slot = np.int64((np.uint64(key) * _GOLDEN) >> np.uint64(40)) & mask
    while bins.keys[slot] != key and bins.keys[slot] != -1:
        slot = (slot + 1) & mask
    return slot


@borrowing
def find_bin(bins: Histogram, key: Integer) -> Integer:
    """Return the number of a bin, -1 when it holds nothing."""
    slot = _find_slot(bins, key)
    return np.int64(bins.numbers[slot]) if bins.keys[slot] == key else -1


@borrowing
def add_bin(bins: Histogram, key: Integer, filled: Integer) -> Integer:
    """Return the number of a bin; a new one gets the number ``filled``."""
    slot = _find_slot(bins, key)
    if bins.keys[slot] != key:
        bins.keys[slot] = key
        bins.numbers[slot] = filled
        bins.slots[filled] = slot
    return np.int64(bins.numbers[slot])


@borrowing
def clear_bins(bins: Histogram, filled: Integer) -> None:
    """Empty the ``filled`` bins."""
    for number in range(filled):
        bins.keys[bins.slots[number]] = -1
