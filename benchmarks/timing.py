"""Timing of peers in turn, in one process."""

from __future__ import annotations

import resource
from collections.abc import Callable


def user_seconds() -> float:
    """Return the user CPU time of this process so far."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_utime


def interleave(functions: dict[str, Callable[[], None]], repeats: int) -> dict[str, list[float]]:
    """Call each function once to warm up, then all in turn ``repeats`` times; return user CPU seconds per call."""
    for function in functions.values():
        function()
    times: dict[str, list[float]] = {name: [] for name in functions}
    for _ in range(repeats):
        for name, function in functions.items():
            began = user_seconds()
            function()
            times[name].append(user_seconds() - began)
    return times
