"""A reward of progress in units of the robot's own speed and of time: as worth having for a slow robot as for a fast
one.
"""

from __future__ import annotations

from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from arena_core import Reward, Robot, Transition
from arena_core.parameters import Flat, Positive
from arena_gym.reward_terms import ChangeOfCommand, Ending, Nearness, NearnessToPeople, TimedProgress

Floats = NDArray[np.float64]


class NormalizedProgressReward(Reward):
    """Progress along the path by the robot's greatest speed, less time, missing clearance, sudden changes of the
    command and collisions; times ``scale``.

    Terms that last are rates, 1/s, so that neither the control period nor how long a decision holds changes what a
    drive is worth. Progress is a difference of potentials (Ng, Harada and Russell 1999).
    """

    def __init__(
        self,
        robot: Robot,
        scale: Positive,
        ending: Annotated[Ending, Flat()],
        pace: Annotated[TimedProgress, Flat()],
        nearness: Annotated[Nearness, Flat()],
        people: Annotated[NearnessToPeople, Flat()],
        smoothness: Annotated[ChangeOfCommand, Flat()],
    ) -> None:
        limits = robot.limits
        self._scale, self._ending, self._people = scale, ending, people
        forward = max(limits.vx_max, -limits.vx_min)
        self._progress, self._time = pace.progress / forward, pace.time
        self._safe, self._near = (nearness.safe_distance - 1.0) * robot.footprint.radius, nearness.near
        speed, turning = smoothness.change_of_speed, smoothness.change_of_turning
        sideways = speed / limits.vy_max**2 if robot.holonomic else 0.0
        self._changes = np.array((speed / forward**2, sideways, turning / limits.wz_max**2))

    def reward(self, transition: Transition) -> Floats:
        """Return the sum of the terms (N,)."""
        before, after = transition.before, transition.after
        missing = np.maximum(1.0 - after.clearances_people / self._people.people_distance, 0.0)
        rates = self._time + self._near * (after.clearances < self._safe) + self._people.near_people * missing
        total = self._progress * (before.path_lengths_left - after.path_lengths_left) - rates * transition.period
        change = transition.commands - transition.last_commands
        jumps = change * change * self._changes
        total -= jumps[:, 0] + jumps[:, 1] + jumps[:, 2]
        total += self._ending.goal * transition.arrived - self._ending.collision * transition.collided
        return np.asarray(self._scale * total)
