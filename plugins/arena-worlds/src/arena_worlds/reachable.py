"""Fill what a robot cannot get to, so that all places where it fits are one."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from arena_kernels.distance import distance_field

ROUNDS = 20  # each can fill or open something
SQUARE = np.ones((3, 3), bool)


def keep_reachable(free: NDArray[np.bool_], resolution: float, radius: float) -> NDArray[np.bool_]:
    """Return which cells stay free (H, W), so that the centre of a disc of ``radius`` m has one connected place to be
    in.

    The largest place is kept with all that the disc covers there; what only other places reach is filled, and so are
    free cells that are not connected with it. Where nothing can be filled, a place is a few cells off the largest, and
    the way there is opened. Outside the grid nothing is free. Nothing at all stays free where the disc does not fit.
    """
    # from a cell's centre to that of the nearest blocked one: half of that cell is blocked
    reach = radius + 0.5 * resolution
    for _ in range(ROUNDS):
        room = free_places(free, resolution, radius)
        labels, count = ndimage.label(room)
        if count == 0:
            break
        main = _largest_region(labels, count)
        if count == 1:
            return _connected_part(free, main)
        others = room & ~main
        beyond = free & (distance_field(main, resolution) >= reach)
        if (beyond & others).any():
            free = free & ~_parts_with(beyond, others)
        else:
            free = free | (distance_field(ndimage.binary_dilation(others, SQUARE), resolution) < reach)
    return np.zeros_like(free)


def free_places(free: NDArray[np.bool_], resolution: float, radius: float) -> NDArray[np.bool_]:
    """Return in which cells (H, W) the centre of a disc of ``radius`` m can be."""
    blocked = np.pad(~free, 1, constant_values=True)
    return np.asarray(distance_field(blocked, resolution)[1:-1, 1:-1] >= radius + 0.5 * resolution)


def _largest_region(labels: NDArray[np.int32], count: int) -> NDArray[np.bool_]:
    if count == 1:
        return np.asarray(labels > 0)
    sizes = np.bincount(labels.ravel())
    sizes[0] = 0
    return np.asarray(labels == sizes.argmax())


def _parts_with(area: NDArray[np.bool_], marks: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return the connected parts of ``area`` that hold a mark."""
    labels, count = ndimage.label(area)
    marked = np.zeros(count + 1, bool)
    marked[labels[marks]] = True
    marked[0] = False
    return np.asarray(marked[labels])


def _connected_part(free: NDArray[np.bool_], main: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return the connected free cells that ``main`` is part of."""
    labels, _ = ndimage.label(free)
    return np.asarray(labels == labels[np.unravel_index(main.argmax(), main.shape)])
