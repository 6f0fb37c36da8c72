"""What stands in N worlds, packed for the kernels."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arena_kernels.grids import GridStack

Floats = NDArray[np.float64]
Offsets = NDArray[np.int64]


class Obstacles(NamedTuple):
    """Obstacles of N worlds, packed; world k has those from ``*_of[k]`` to ``*_of[k + 1]``.

    Discs: ``centres`` (D, 2), ``radii`` (D,). Polygons: polygon r is ``points[ring_starts[r] : ring_starts[r + 1]]``, closed, inside the
    circle ``bounds[r]`` (x, y, radius). ``edges`` (E, 4) are the polygons' sides x, y, x, y. All in ``map``, m.
    """

    centres: Floats
    radii: Floats
    discs_of: Offsets
    points: Floats
    ring_starts: Offsets
    bounds: Floats
    rings_of: Offsets
    edges: Floats
    edges_of: Offsets


class Scene(NamedTuple):
    """The grids and obstacles of N worlds; world k stands on grid ``grid_of[k]``."""

    stack: GridStack
    grid_of: NDArray[np.int64]
    obstacles: Obstacles
