"""The reward of AIO's rule_07, which counts progress otherwise among people."""

from __future__ import annotations

from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from arena_core import Reward, Robot, Transition
from arena_core.parameters import Flat, NonNegative
from arena_gym.release_reward import weigh_gain
from arena_gym.reward_terms import AmongPeople, Ending, GoalProgress, Nearness

Floats = NDArray[np.float64]


class SwitchReward(Reward):
    """Goal and collision; near people safety, and progress alone; elsewhere progress, regress
    and standing (Kaestner et al. 2021).
    """

    def __init__(
        self,
        robot: Robot,
        ending: Annotated[Ending, Flat()],
        among: Annotated[AmongPeople, Flat()],
        nearness: Annotated[Nearness, Flat()],
        gain: Annotated[GoalProgress, Flat()],
        standing: NonNegative,
    ) -> None:
        radius = robot.footprint.radius
        self._ending, self._among, self._gain, self._standing = ending, among, gain, standing
        self._people_gap, self._safe = among.people_distance - radius, nearness.safe_distance * radius
        self._near = nearness.near

    def reward(self, transition: Transition) -> Floats:
        """Return the sum of the terms (N,)."""
        after = transition.after
        among = after.clearances_people < self._people_gap
        gain = transition.before.goal_distances - after.goal_distances
        near_people = weigh_gain(gain, self._among.progress_near_people, self._among.regress_near_people)
        total = np.where(among, near_people, weigh_gain(gain, self._gain.progress, self._gain.regress))
        total -= np.where(
            among, self._near * (after.nearest_ranges < self._safe), self._standing * (after.standing_times > 0.0)
        )
        return np.asarray(total + self._ending.goal * transition.arrived - self._ending.collision * transition.collided)
