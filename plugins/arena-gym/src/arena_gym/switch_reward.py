"""The reward of AIO's rule_07, which counts progress otherwise among people."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from arena_core import Reward, Robot, Transition
from arena_core.parameters import NonNegative, Positive
from arena_gym.release_reward import weigh_gain

Floats = NDArray[np.float64]


class SwitchReward(Reward):
    """Goal and collision; near people safety, and progress alone; elsewhere progress, regress
    and standing (Kaestner et al. 2021).
    """

    def __init__(
        self,
        robot: Robot,
        goal: NonNegative,
        collision: NonNegative,
        people_distance: Positive,
        safe_distance: Positive,
        near: NonNegative,
        progress_near_people: NonNegative,
        regress_near_people: NonNegative,
        progress: NonNegative,
        regress: NonNegative,
        standing: NonNegative,
    ) -> None:
        radius = robot.footprint.radius
        self._goal, self._collision = goal, collision
        self._people_gap, self._safe, self._near = people_distance - radius, safe_distance * radius, near
        self._among_people = progress_near_people, regress_near_people
        self._elsewhere = progress, regress
        self._standing = standing

    def reward(self, transition: Transition) -> Floats:
        """Return the sum of the terms (N,)."""
        after = transition.after
        among = after.clearances_people < self._people_gap
        gain = transition.before.goal_distances - after.goal_distances
        total = np.where(among, weigh_gain(gain, *self._among_people), weigh_gain(gain, *self._elsewhere))
        total -= np.where(
            among, self._near * (after.nearest_ranges < self._safe), self._standing * (after.standing_times > 0.0)
        )
        return np.asarray(total + self._goal * transition.arrived - self._collision * transition.collided)
