"""The rewards of the release, rule_00 to rule_05."""

from __future__ import annotations

from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from arena_core import Reward, Robot, Transition
from arena_core.parameters import Flat
from arena_gym.reward_terms import Consumption, Ending, Following, GoalProgress, Nearness, Smoothness

Floats = NDArray[np.float64]


class ReleaseReward(Reward):
    """The terms that the release's rules choose from; a term whose weights are 0 is not there.

    Reaching the goal takes the place of all terms before it; being near, colliding and progress count at that step too.
    A collision is a true contact; in the release it was a range below the radius.
    """

    def __init__(
        self,
        robot: Robot,
        ending: Annotated[Ending, Flat()],
        nearness: Annotated[Nearness, Flat()],
        gain: Annotated[GoalProgress, Flat()],
        effort: Annotated[Consumption, Flat()],
        following: Annotated[Following, Flat()],
        smoothness: Annotated[Smoothness, Flat()],
    ) -> None:
        self._ending, self._near = ending, nearness.near
        self._safe = nearness.safe_distance * robot.footprint.radius
        self._gain, self._path = gain, following
        self._consumption = effort.consumption * np.array((1.0, 0.0, effort.consumption_of_turning))
        self._smooth_beyond = self._safe + smoothness.smooth_beyond
        sideways = smoothness.change_of_vy if robot.holonomic else 0.0
        self._changes = np.array((smoothness.change_of_vx, sideways, smoothness.change_of_wz))
        self._reverse = smoothness.reverse

    def reward(self, transition: Transition) -> Floats:
        """Return the sum of the rule's terms (N,)."""
        total = self._driving_cost(transition) + self._path_reward(transition) + self._smoothness_cost(transition)
        total[transition.arrived] = self._ending.goal
        total -= self._near * (transition.after.nearest_ranges < self._safe)
        total -= self._ending.collision * transition.collided
        gain = transition.before.goal_distances - transition.after.goal_distances
        return np.asarray(total + weigh_gain(gain, self._gain.progress, self._gain.regress))

    def _driving_cost(self, transition: Transition) -> Floats:
        commands, weights = transition.commands, self._consumption
        return np.asarray(-(commands[:, 0] * weights[0] + commands[:, 2] * weights[2]))

    def _path_reward(self, transition: Transition) -> Floats:
        """Reward driving on the path, and coming nearer to it where nothing is near."""
        before, after = transition.before, transition.after
        on_path = after.path_distances <= self._path.following_within
        free = (before.nearest_ranges > self._smooth_beyond) & (after.nearest_ranges > self._smooth_beyond)
        gain, path = before.path_distances - after.path_distances, self._path
        nearer = weigh_gain(gain, path.nearer_to_path, path.farther_from_path)
        return np.asarray(self._path.following * on_path * transition.commands[:, 0] + free * nearer)

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
