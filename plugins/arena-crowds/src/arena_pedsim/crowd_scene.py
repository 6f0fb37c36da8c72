"""What the people of one world walk in, and the time that they walk for."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from arena_kernels.crowds import Bodies, Robots
from arena_kernels.ground import Ground


class CrowdScene(NamedTuple):
    """The people of one world, as bodies and as rows of what they remember, the ground, and the robots."""

    bodies: Bodies
    people: NDArray[np.void]
    ground: Ground
    robots: Robots


class Step(NamedTuple):
    """How long a step is, s, and the row of parameters that holds in it."""

    dt: float
    parameters: Any


class KnownWay(NamedTuple):
    """The corners of a person's route (C, 2), and the ground it leads over."""

    corners: NDArray[np.float64]
    ground: Ground
