"""Cosines and sines of many headings at once: in this form the compiler computes eight in one go, which
calls to the library prevent.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arena_kernels.compiled import borrowing
from arena_kernels.scalars import Integer
from arena_navigation.columns import COSINE, SINE

# a quarter turn in two parts (Cody and Waite), so that what is left of an angle is exact
_QUARTER_HIGH = 1.5707963267341256
_QUARTER_LOW = 6.077100506506192e-11


class PlacedParticles(NamedTuple):
    """Placed particles: the first ``number`` columns of ``poses`` (3, P), and the cosines and sines of their
    headings (2, P).
    """

    poses: NDArray[np.float64]
    directions: NDArray[np.float64]
    number: Integer


@borrowing
def write_directions(angles: NDArray[np.float64], count: Integer, directions: NDArray[np.float64]) -> None:
    """Write the cosine and sine of ``count`` angles to ``directions`` (2, P), to 2e-16 for angles of a few turns.

    Minimax polynomials on an eighth of a turn (Ng, fdlibm, kernel functions of sine and cosine).
    """
    for i in range(count):
        quarters = np.floor(angles[i] * (2.0 / np.pi) + 0.5)
        r = (angles[i] - quarters * _QUARTER_HIGH) - quarters * _QUARTER_LOW
        z = r * r
        tail = 2.75573137070700676789e-06 + z * (-2.50507602534068634195e-08 + z * 1.58969099521155010221e-10)
        s = r + r * z * (
            -0.166666666666666324348 + z * (8.33333333332248946124e-03 + z * (-1.98412698298579493134e-04 + z * tail))
        )
        tail = -2.75573143513906633035e-07 + z * (2.08757232129817482790e-09 + z * -1.13596475577881948265e-11)
        c = 1.0 - 0.5 * z
        c += (
            z
            * z
            * (
                4.16666666666666019037e-02
                + z * (-1.38888888888741095749e-03 + z * (2.48015872894767294178e-05 + z * tail))
            )
        )
        quadrant = np.int64(quarters)
        cosine, sine = (s, c) if quadrant & 1 else (c, s)
        directions[COSINE, i] = -cosine if (quadrant + 1) & 2 else cosine
        directions[SINE, i] = -sine if quadrant & 2 else sine


@borrowing
def wrap_angle(angle: float) -> float:
    """Wrap an angle to [-pi, pi]; several times as fast as the remainder of a division."""
    turns: float = np.floor((angle + np.pi) / (2.0 * np.pi))
    return angle - 2.0 * np.pi * turns
