"""Where the state that goes with a scan tells how the robot moved."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from arena_core import ObservationField

AXES = ("vx", "vy", "wz")
Columns = NDArray[np.int64]


def motion_columns(state: Sequence[ObservationField]) -> tuple[Columns, Columns]:
    """Return the columns of measured speeds and of the last command in a state of these fields."""
    starts = np.cumsum([0, *(field.size for field in state)])
    at = {field.name: start for field, start in zip(state, starts.tolist(), strict=False)}
    return tuple(np.array([at[name] for name in names if name in at]) for names in (AXES, [f"last_{axis}" for axis in AXES]))  # type: ignore[return-value]
