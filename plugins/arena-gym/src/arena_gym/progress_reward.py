"""A dense reward of progress along the path, with few terms."""

from __future__ import annotations

from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from arena_core import Reward, Robot, Transition
from arena_core.parameters import Flat, Positive
from arena_gym.reward_terms import Effort, Ending, Nearness, NearnessToPeople, PathProgress

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
        ending: Annotated[Ending, Flat()],
        path: Annotated[PathProgress, Flat()],
        nearness: Annotated[Nearness, Flat()],
        people: Annotated[NearnessToPeople, Flat()],
        effort: Annotated[Effort, Flat()],
    ) -> None:
        limits = robot.limits
        self._scale, self._ending, self._path, self._people = scale, ending, path, people
        self._safe, self._near = (nearness.safe_distance - 1.0) * robot.footprint.radius, nearness.near
        self._time, change_of_speed = effort.time, effort.change_of_speed
        forward = max(limits.vx_max, -limits.vx_min)
        sideways = change_of_speed / limits.vy_max**2 if robot.holonomic else 0.0
        self._changes = np.array((change_of_speed / forward**2, sideways, effort.change_of_turning / limits.wz_max**2))

    def reward(self, transition: Transition) -> Floats:
        """Return the sum of the terms (N,)."""
        before, after = transition.before, transition.after
        total = self._path.progress * (before.path_lengths_left - after.path_lengths_left)
        total += self._path.beside * (before.path_distances - after.path_distances)
        total -= self._path.way * np.hypot(*(after.poses - before.poses)[:, :2].T)
        total -= self._near * (after.clearances < self._safe) + self._time
        missing = 1.0 - after.clearances_people / self._people.people_distance
        total -= self._people.near_people * np.maximum(missing, 0.0)
        change = transition.commands - transition.last_commands
        jumps = change * change * self._changes
        total -= jumps[:, 0] + jumps[:, 1] + jumps[:, 2]
        total += self._ending.goal * transition.arrived - self._ending.collision * transition.collided
        return np.asarray(self._scale * total)
