"""The rewards of the release, rule_00 to rule_05."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from arena_core import Reward, Robot, Transition
from arena_core.parameters import NonNegative, Positive

Floats = NDArray[np.float64]


class ReleaseReward(Reward):
    """The terms that the release's rules choose from; a term whose weights are 0 is not there.

    Reaching the goal takes the place of all terms before it; being near, colliding and progress count at that step too.
    A collision is a true contact; in the release it was a range below the radius.
    """

    def __init__(
        self,
        robot: Robot,
        goal: NonNegative,
        collision: NonNegative,
        safe_distance: Positive,
        near: NonNegative,
        progress: NonNegative,
        regress: NonNegative,
        consumption: NonNegative,
        consumption_of_turning: NonNegative,
        following: NonNegative,
        following_within: Positive,
        nearer_to_path: NonNegative,
        farther_from_path: NonNegative,
        smooth_beyond: NonNegative,
        change_of_vx: NonNegative,
        change_of_vy: NonNegative,
        change_of_wz: NonNegative,
        reverse: NonNegative,
    ) -> None:
        self._goal, self._collision, self._near = goal, collision, near
        self._safe = safe_distance * robot.footprint.radius
        self._progress, self._regress = progress, regress
        self._consumption = consumption * np.array((1.0, 0.0, consumption_of_turning))
        self._following, self._following_within = following, following_within
        self._nearer, self._farther = nearer_to_path, farther_from_path
        self._smooth_beyond = self._safe + smooth_beyond
        self._changes = np.array((change_of_vx, change_of_vy if robot.holonomic else 0.0, change_of_wz))
        self._reverse = reverse

    def reward(self, transition: Transition) -> Floats:
        """Return the sum of the rule's terms (N,)."""
        total = self._driving_cost(transition) + self._path_reward(transition) + self._smoothness_cost(transition)
        total[transition.arrived] = self._goal
        total -= self._near * (transition.after.nearest_ranges < self._safe)
        total -= self._collision * transition.collided
        gain = transition.before.goal_distances - transition.after.goal_distances
        return np.asarray(total + weigh_gain(gain, self._progress, self._regress))

    def _driving_cost(self, transition: Transition) -> Floats:
        commands, weights = transition.commands, self._consumption
        return np.asarray(-(commands[:, 0] * weights[0] + commands[:, 2] * weights[2]))

    def _path_reward(self, transition: Transition) -> Floats:
        """Reward driving on the path, and coming nearer to it where nothing is near."""
        before, after = transition.before, transition.after
        on_path = after.path_distances <= self._following_within
        free = (before.nearest_ranges > self._smooth_beyond) & (after.nearest_ranges > self._smooth_beyond)
        nearer = weigh_gain(before.path_distances - after.path_distances, self._nearer, self._farther)
        return np.asarray(self._following * on_path * transition.commands[:, 0] + free * nearer)

    def _smoothness_cost(self, transition: Transition) -> Floats:
        """Punish sudden changes of the command and driving backwards, where nothing is near."""
        free = transition.after.nearest_ranges > self._smooth_beyond
        change = transition.commands - transition.last_commands
        squared = change * change
        jumps = squared * squared / 100.0 * self._changes
        return np.asarray(
            -1.0 * free * (jumps[:, 0] + jumps[:, 1] + jumps[:, 2] + self._reverse * (transition.commands[:, 0] < 0.0))
        )


def weigh_gain(gain: Floats, if_positive: float, if_negative: float) -> Floats:
    """Return ``gain`` times the one weight or the other."""
    return np.where(gain > 0.0, if_positive, if_negative) * gain
