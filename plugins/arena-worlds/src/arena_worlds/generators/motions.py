"""Motions as DynaBARN's: along polynomials across a square field, from border to border, with
uneven speed (Nair et al. 2022).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from arena_core.parameters import Bounds, NonNegative, Positive
from arena_worlds.formats.animation import Animation

Floats = NDArray[np.float64]
Count = Annotated[int, Bounds(low=1, high=200)]  # as many plugins as were published for a level
Order = Annotated[int, Bounds(low=1, high=8)]  # beyond, a polynomial through whole metres hardly crosses the field

FINE = 0.001  # m in x, between the points of a polynomial that is searched for the border
LEAST = 1e-6  # of a leading coefficient, below which a polynomial is of lower order


@dataclass(frozen=True, slots=True)
class Level:
    """What a level's worlds are drawn from: how many obstacles, of which order their polynomials are, and how fast they
    go.

    A motion has a mean speed, m/s, and a standard deviation ``std`` of the speed from one key frame to the next, m/s;
    no speed lies beyond ``speed_min`` .. ``speed_max``.
    """

    obstacles_min: Count
    obstacles_max: Count
    order_min: Order
    order_max: Order
    speed_min: Positive
    speed_max: Positive
    std_min: NonNegative
    std_max: NonNegative


@dataclass(frozen=True, slots=True)
class Square:
    """A square from -``half`` to ``half`` m; motions cross at least ``least_way`` m of it, with key frames
    ``spacing`` m apart or less.
    """

    half: float
    least_way: float
    spacing: float


def draw_animation(random: np.random.Generator, level: Level, square: Square) -> Animation:
    """Draw one obstacle's motion, rounded to centimetres and hundredths of a second as the sources of plugins are."""
    order = int(random.integers(level.order_min, level.order_max + 1))
    way = draw_path(random, order, square)
    if random.random() < 0.5:
        way = way[::-1]
    pieces = np.hypot(*np.diff(way, axis=0).T)
    mean, std = random.uniform(level.speed_min, level.speed_max), random.uniform(level.std_min, level.std_max)
    speeds = np.clip(random.normal(mean, std, len(pieces)), level.speed_min, level.speed_max)
    stamps = np.asarray(np.concatenate(((0.0,), np.cumsum(pieces / speeds))), np.float64)
    return Animation(np.round(stamps, 2), way)


def draw_path(random: np.random.Generator, order: int, square: Square) -> Floats:
    """Return key places (K, 2), m, evenly along a polynomial y(x) of this order
    through drawn places on whole metres.
    """
    while True:
        xs = random.choice(np.arange(-square.half, square.half + 1.0), order + 1, replace=False)
        ys = random.integers(int(-square.half), int(square.half) + 1, order + 1).astype(np.float64)
        factors = np.asarray(np.linalg.solve(np.vander(xs), ys), np.float64)
        if abs(factors[0]) < LEAST:
            continue
        way = _longest_within(factors, square.half)
        lengths = np.concatenate(((0.0,), np.cumsum(np.hypot(*np.diff(way, axis=0).T))))
        if lengths[-1] >= square.least_way:
            return np.round(_resample_path(way, lengths, square.spacing), 2)


def _longest_within(factors: Floats, half: float) -> Floats:
    """Return the longest piece (M, 2) of a polynomial within the square, from border to border."""
    xs = np.linspace(-half, half, round(2.0 * half / FINE) + 1)
    ys = np.asarray(np.polyval(factors, xs), np.float64)
    inside = np.abs(ys) <= half
    ends = np.flatnonzero(np.diff(np.concatenate(((False,), inside, (False,))).astype(np.int8)))
    pieces = [_to_border(xs, ys, first, last, half) for first, last in ends.reshape(-1, 2).tolist()]
    return max(pieces, key=lambda piece: float(np.hypot(*np.diff(piece, axis=0).T).sum()))


def _to_border(xs: Floats, ys: Floats, first: int, last: int, half: float) -> Floats:
    """Return points ``first`` to ``last`` - 1, drawn out to where the polynomial crosses the upper or lower border."""
    points = np.stack((xs[first:last], ys[first:last]), axis=1)
    before = [_border_crossing(xs, ys, first - 1, first, half)] if first > 0 else []
    after = [_border_crossing(xs, ys, last, last - 1, half)] if last < len(xs) else []
    return np.vstack((*before, points, *after))


def _border_crossing(xs: Floats, ys: Floats, outside: int, inside: int, half: float) -> Floats:
    border = half if ys[outside] > 0.0 else -half
    share = (border - ys[inside]) / (ys[outside] - ys[inside])
    return np.array((xs[inside] + share * (xs[outside] - xs[inside]), border))


def _resample_path(way: Floats, lengths: Floats, spacing: float) -> Floats:
    marks = np.linspace(0.0, lengths[-1], int(np.ceil(lengths[-1] / spacing)) + 1)
    return np.stack([np.interp(marks, lengths, way[:, axis]) for axis in (0, 1)], axis=1)
