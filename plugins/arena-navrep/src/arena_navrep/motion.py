"""Where the state that goes with a scan tells how the robot moved."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from arena_core import ObservationField
from arena_policies.encoding import field_columns

AXES = ("vx", "vy", "wz")
Columns = NDArray[np.int64]


def motion_columns(state: Sequence[ObservationField]) -> tuple[Columns, Columns]:
    """Return the columns of measured speeds and of the last command in a state of these fields."""
    there = {field.name for field in state}
    measured, commanded = (
        np.r_[tuple(field_columns(state, name) for name in names if name in there)]
        for names in (AXES, [f"last_{axis}" for axis in AXES])
    )
    return measured, commanded
