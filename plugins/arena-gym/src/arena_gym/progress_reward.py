"""A dense reward of progress along the path, with few terms."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from arena_core import Reward, Robot, Transition
from arena_core.parameters import NonNegative, Positive

Floats = NDArray[np.float64]


class ProgressReward(Reward):
    """Progress along the path, less what clearance, time, sudden changes of the command and a collision cost; times
    ``scale``.

    Progress is a difference of potentials, so that driving to and fro earns nothing (Ng, Harada and Russell 1999); each
    metre driven costs ``way``, so that a robot waits for people rather than circle.
    """

    def __init__(
        self,
        robot: Robot,
        scale: Positive,
        goal: NonNegative,
        collision: NonNegative,
        progress: NonNegative,
        beside: NonNegative,
        safe_distance: Positive,
        near: NonNegative,
        people_distance: Positive,
        near_people: NonNegative,
        time: NonNegative,
        change_of_speed: NonNegative,
        change_of_turning: NonNegative,
        way: NonNegative,
    ) -> None:
        limits = robot.limits
        self._scale, self._goal, self._collision = scale, goal, collision
        self._progress, self._beside, self._way = progress, beside, way
        self._safe, self._near, self._time = (safe_distance - 1.0) * robot.footprint.radius, near, time
        self._people_distance, self._near_people = people_distance, near_people
        forward = max(limits.vx_max, -limits.vx_min)
        sideways = change_of_speed / limits.vy_max**2 if robot.holonomic else 0.0
        self._changes = np.array((change_of_speed / forward**2, sideways, change_of_turning / limits.wz_max**2))

    def reward(self, transition: Transition) -> Floats:
        """Return the sum of the terms (N,)."""
        before, after = transition.before, transition.after
        total = self._progress * (before.path_lengths_left - after.path_lengths_left)
        total += self._beside * (before.path_distances - after.path_distances)
        total -= self._way * np.hypot(*(after.poses - before.poses)[:, :2].T)
        total -= self._near * (after.clearances < self._safe) + self._time
        missing = 1.0 - after.clearances_people / self._people_distance
        total -= self._near_people * np.maximum(missing, 0.0)
        change = transition.commands - transition.last_commands
        jumps = change * change * self._changes
        total -= jumps[:, 0] + jumps[:, 1] + jumps[:, 2]
        total += self._goal * transition.arrived - self._collision * transition.collided
        return np.asarray(self._scale * total)
