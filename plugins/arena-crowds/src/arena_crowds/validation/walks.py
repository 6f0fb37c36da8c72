"""Let any crowd model walk, as a simulator without a robot would."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from arena_core import Crowd, PedestrianModel, RobotBatch, Scenario

Floats = NDArray[np.float64]
Lead = Callable[[Crowd, float], Crowd]

STEP = 0.05  # s


def simulate_walks(
    model: PedestrianModel, scenarios: Sequence[Scenario], seconds: float, rate: float, lead: Lead | None = None
) -> Floats:
    """Return positions (T, N, P, 2) m, ``rate`` times a second from the start on, in worlds that begin together.

    ``lead(crowd, time)`` may put people elsewhere before each step.
    """
    worlds = len(scenarios)
    crowd = model.reset(np.arange(worlds), scenarios, worlds)
    nobody = RobotBatch(np.full((worlds, 3), -1000.0), np.zeros((worlds, 2)), 0.2)
    every = round(1.0 / (rate * STEP))
    rows = []
    for tick in range(round(seconds / STEP) + 1):
        crowd = lead(crowd, tick * STEP) if lead else crowd
        if tick % every == 0:
            rows.append(crowd.positions.copy())
        crowd = model.step(crowd, nobody, np.full(worlds, tick, np.int64), STEP)
    return np.array(rows)
