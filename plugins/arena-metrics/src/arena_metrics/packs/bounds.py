"""Between what the values of metrics lie, so that the interval of a mean says nothing that cannot be."""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from dataclasses import replace

from arena_core import Metric

SHARE = (0.0, 1.0)
POSITIVE = (0.0, math.inf)  # or zero


def with_bounds(metrics: Sequence[Metric], shares: Collection[str] = (), signed: Collection[str] = ()) -> list[Metric]:
    """Return metrics with their bounds: 0 to 1 for ``shares``, none for ``signed`` ones, zero and above for others."""
    return [
        metric
        if metric.name in signed or metric.unit == "text"
        else replace(metric, bounds=SHARE if metric.name in shares or metric.unit == "0/1" else POSITIVE)
        for metric in metrics
    ]
