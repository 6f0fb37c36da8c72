"""What the navigator's parts took, by the clock on the wall and by that of the processor: the only figures that differ
between equal runs.

Local map and tracker are computed when first asked for, by the navigator or by the planner, and count apart from both.
In records that were written before that, ``planner_seconds`` includes what the planner had asked for, and their own
arrays are not there. Steps that waited for a compiler are NaN, and left out.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from arena_core import EpisodeRecord


def mean_time(record: EpisodeRecord, part: str) -> float:
    """Return the mean time of a part over the control steps, ms; NaN where it was not timed."""
    seconds = _known_times(record, part)
    return 1e3 * float(seconds.mean()) if len(seconds) else math.nan


def total_time(record: EpisodeRecord, part: str) -> float:
    """Return the time of a part in the whole episode, s; NaN where it was not timed."""
    seconds = record.timing.get(f"{part}_seconds", np.empty(0))
    return float(seconds.sum()) if len(seconds) else math.nan


def time_percentile(record: EpisodeRecord, part: str, percent: float) -> float:
    """Return a percentile of a part's time over the control steps, ms; NaN where it was not timed."""
    seconds = _known_times(record, part)
    return 1e3 * float(np.percentile(seconds, percent)) if len(seconds) else math.nan


def _known_times(record: EpisodeRecord, part: str) -> NDArray[np.float64]:
    seconds = record.timing.get(f"{part}_seconds", np.empty(0))
    return seconds[np.isfinite(seconds)]
