"""How finely a record's arrays are kept."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

# binary places that are kept, finer than what any simulator or sensor means by its digits; the rest is noise that does
# not pack
GRAIN = {
    "pose": 22,
    "twist": 22,
    "estimate": 20,
    "waypoint": 16,
    "path_poses": 16,
    "team_pose": 16,
    "clearance": 16,
    "clearance_people": 16,
    "scan_min": 16,
    "pedestrian_positions": 12,
    "pedestrian_velocities": 11,
}
TIME_GRAIN = 20  # binary places of everything in timing/, s


def round_arrays(arrays: Mapping[str, NDArray[Any]]) -> dict[str, NDArray[Any]]:
    """Return a record's arrays rounded to their grain, so that metrics are of what the file holds."""
    return {**arrays, **{name: to_grain(arrays[name], places) for name, places in GRAIN.items() if name in arrays}}


def to_grain(array: NDArray[Any], places: int) -> NDArray[Any]:
    """Round to so many binary places, exactly; what is no number or infinite stays, and there is no negative zero."""
    rounded: NDArray[Any] = np.ldexp(np.rint(np.ldexp(array, places)), -places) + array.dtype.type(0.0)
    return rounded
