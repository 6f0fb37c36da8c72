"""A world without people."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from arena_core import Branches, Crowd, PedestrianModel, RobotBatch, Scenario
from arena_crowds.slots import no_crowd


class Nobody(PedestrianModel):
    """Leaves every world empty, whoever is in the scenario."""

    meets_teams = True

    def reset(self, slots: NDArray[np.int64], scenarios: Sequence[Scenario], total: int) -> Crowd:
        """Return ``total`` worlds without people."""
        return no_crowd(total)

    def step(self, crowd: Crowd, robots: RobotBatch, ticks: NDArray[np.int64], dt: float) -> Crowd:
        """Return the crowd as it is."""
        return crowd

    def fork(self, branches: Branches) -> Nobody:
        """Return a model of no one."""
        return Nobody()
