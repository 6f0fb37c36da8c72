"""How wide a map's ways are: figures of its largest free region, whatever drives there."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from arena_kernels.distance import distance_field

BESIDE_WALLS = 1.0  # m; what lies nearer to an obstacle than this is tight
LEAST_RIDGE = 0.2  # m of clearance; below it a ridge is a cell's corner
RIDGE_WINDOW = 0.5  # m; a ridge cell has the most clearance within a square of this side


class Widths(NamedTuple):
    """The largest free region: its area, m2, the widths of its ways, m, and which share of it is tight, 0 .. 1."""

    free: float
    low: float
    middle: float
    high: float
    tight: float


def widths_of(free: NDArray[np.bool_], resolution: float) -> Widths:
    """Measure the free cells (H, W), which blocked ones surround.

    A way is as wide as twice the clearance along the ridge of the distance field; ``low``, ``middle`` and ``high`` are
    the percentiles 10, 50 and 90 over the ridge's cells, NaN where nothing is wide enough for a ridge.
    """
    region = largest_part(free)
    clearance = distance_field(~region, resolution)
    window = int(max(3, RIDGE_WINDOW / resolution)) | 1
    ridge = region & (clearance > LEAST_RIDGE) & (clearance >= ndimage.maximum_filter(clearance, size=window) - 1e-6)
    low, middle, high = np.percentile(2.0 * clearance[ridge], [10, 50, 90]).tolist() if ridge.any() else [np.nan] * 3
    tight = float((clearance[region] < BESIDE_WALLS).mean()) if region.any() else np.nan
    return Widths(float(region.sum()) * resolution**2, low, middle, high, tight)


def largest_part(area: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return the largest connected part of ``area``, over the 4 neighbours."""
    labels, _ = ndimage.label(area)
    sizes = np.bincount(labels.ravel())
    sizes[0] = 0
    return np.asarray((labels == sizes.argmax()) & area)
