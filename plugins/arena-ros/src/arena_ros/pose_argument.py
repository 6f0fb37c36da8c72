"""Places on a command line."""

from __future__ import annotations

import numpy as np

from arena_core import ConfigurationError, Pose
from arena_core.commands import Words


def read_pose(words: Words, key: str) -> Pose | None:
    """Return the place that a key names, None where it is not given; raise ConfigurationError."""
    text = words.keys.get(key)
    if text is None:
        return None
    try:
        numbers = [float(part) for part in text.split(",")]
    except ValueError:
        numbers = []
    if len(numbers) not in (2, 3) or not np.isfinite(numbers).all():
        raise ConfigurationError(f"{key} is {text}; allowed: X,Y or X,Y,THETA in m and rad")
    return Pose(*numbers)
