"""A reward of progress in units of the robot's own speed and of time: as worth having for a slow robot as for a fast
one.
"""

from __future__ import annotations

from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from arena_core import Reward, Robot, Transition
from arena_core.parameters import Flat
from arena_gym.reward_terms import ChangeOfCommand, ClearanceCosts, Pace

Floats = NDArray[np.float64]


class NormalizedProgressReward(Reward):
    """Progress along the path by the robot's greatest speed, less time, missing clearance, sudden changes of the
    command and collisions.

    Terms that last are rates, 1/s, so that neither the control period nor how long a decision holds changes what a
    drive is worth. Progress is a difference of potentials (Ng, Harada and Russell 1999).
    """

    def __init__(
        self,
        robot: Robot,
        pace: Annotated[Pace, Flat()],
        space: Annotated[ClearanceCosts, Flat()],
        smoothness: Annotated[ChangeOfCommand, Flat()],
    ) -> None:
        limits = robot.limits
        self._pace, self._space = pace, space
        forward = max(limits.vx_max, -limits.vx_min)
        self._progress, self._safe = pace.progress / forward, (space.safe_distance - 1.0) * robot.footprint.radius
        speed, turning = smoothness.change_of_speed, smoothness.change_of_turning
        sideways = speed / limits.vy_max**2 if robot.holonomic else 0.0
        self._changes = np.array((speed / forward**2, sideways, turning / limits.wz_max**2))

    def reward(self, transition: Transition) -> Floats:
        """Return the sum of the terms (N,)."""
        before, after = transition.before, transition.after
        missing = np.maximum(1.0 - after.clearances_people / self._space.people_distance, 0.0)
        rates = self._pace.time + self._space.near * (after.clearances < self._safe) + self._space.near_people * missing
        total = self._progress * (before.path_lengths_left - after.path_lengths_left) - rates * transition.period
        change = transition.commands - transition.last_commands
        jumps = change * change * self._changes
        total -= jumps[:, 0] + jumps[:, 1] + jumps[:, 2]
        total += self._pace.goal * transition.arrived - self._pace.collision * transition.collided
        return np.asarray(self._pace.scale * total)
