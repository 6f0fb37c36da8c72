"""Doors as the search sees them: discs in the way while a door is closed, absent while it is open."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from arena_core.scenes import Door, is_open
from arena_reference.arrays import Floats, Mask
from arena_reference.body import Walkers

FINEST, COARSEST = 0.1, 0.2  # m, of the sides of the squares by whose discs a door is covered


def with_doors(people: Walkers, doors: Sequence[Door], now_open: Sequence[bool]) -> Walkers:
    """Return people and the discs that cover doors by their timetables, rounded inwards: to those a door is open only
    where it is so at the positions before and after, too.

    ``now_open`` says which are open at the beginning. One that is held open by who stands in it counts as open until
    its timetable opens it, which is for a drive in a fork to confirm.
    """
    positions, radii = [people.positions], [people.radii]
    stamps = people.start + people.period * np.arange(-1.0, len(people.positions) + 1.0)
    for door, opened in zip(doors, now_open, strict=True):
        centres, radius = cover_outline(door.vertices_xy)
        closed = _closed_at(door, stamps, held=bool(opened))
        places = np.where(closed[:, None, None], centres, np.nan)
        positions.append(places)
        radii.append(np.full(len(centres), radius))
    return Walkers(np.concatenate(positions, axis=1), np.concatenate(radii), people.start, people.period)


def _closed_at(door: Door, stamps: Floats, *, held: bool) -> Mask:
    """Return whether a door counts as closed at all of these times (K + 2,) but the first and the last."""
    scheduled = np.array([is_open(door, float(stamp)) for stamp in stamps])
    scheduled[0] |= held  # what was before the beginning does not matter
    if held:
        scheduled[1 : 1 + _first_true(scheduled[1:])] = True
    return np.asarray(~(scheduled[:-2] & scheduled[1:-1] & scheduled[2:]))


def _first_true(values: Mask) -> int:
    return int(np.argmax(values)) if values.any() else len(values)


def cover_outline(vertices_xy: Floats) -> tuple[Floats, float]:
    """Return the centres (N, 2) and the radius, m, of discs that together cover the rectangle about an outline (V, 2)
    along its longest side.
    """
    sides = np.roll(vertices_xy, -1, axis=0) - vertices_xy
    along = sides[np.argmax(np.hypot(*sides.T))]
    along = along / np.hypot(*along)
    axes = np.array((along, (-along[1], along[0])))
    turned = vertices_xy @ axes.T
    low, extent = turned.min(axis=0), np.ptp(turned, axis=0)
    side = min(max(float(extent.min()), FINEST), COARSEST)
    counts = np.maximum(np.ceil(extent / side - 1e-9).astype(int), 1)
    cell = extent / counts
    columns, rows = (low[k] + cell[k] * (np.arange(counts[k]) + 0.5) for k in (0, 1))
    centres = np.stack(np.meshgrid(columns, rows), axis=-1).reshape(-1, 2) @ axes
    return centres, 0.5 * math.hypot(*cell)


def longest_wait(doors: Sequence[Door], stamp: float) -> float:
    """Return how long a robot that does not come at the right time may have to wait for doors from ``stamp`` on, s."""
    total = 0.0
    for door in doors:
        last = max((begin for begin in door.open[:, 0].tolist() if begin > stamp), default=stamp) - stamp
        total += last if door.period is None else door.period
    return total
