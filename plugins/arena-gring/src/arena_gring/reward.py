"""The reward of GRING, which makes a robot stop for people."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from arena_core import Reward, Robot, Transition
from arena_core.parameters import NonNegative, Positive

Floats = NDArray[np.float64]


class GringReward(Reward):
    """Waypoints approached and reached, less what walls, standing, and people cost that the robot has not stopped for;
    times ``scale``.

    After Guldenring et al. 2020, rule 2_1. Waypoints are approached along the path, where the release measured
    straight; one that is left behind again is lost again. With ``straight_to_goal`` the way left is no shorter than
    straight to the goal. A person costs once, when it comes near: that ends no episode here; ``too_near`` makes it cost
    on, in proportion to the clearance that is missing from ``too_near_distance``.
    """

    def __init__(
        self,
        robot: Robot,
        scale: Positive,
        goal: NonNegative,
        collision: NonNegative,
        nearer: NonNegative,
        farther: NonNegative,
        straight_to_goal: bool,
        waypoint: NonNegative,
        spacing: Positive,
        wall_distance: NonNegative,
        people: NonNegative,
        people_distance: Positive,
        stopped_for: NonNegative,
        too_near: NonNegative,
        too_near_distance: Positive,
        standing: NonNegative,
        turning: NonNegative,
        turning_from: NonNegative,
    ) -> None:
        self._scale, self._goal, self._collision = scale, goal, collision
        self._nearer, self._farther, self._straight = nearer, farther, straight_to_goal
        self._waypoint, self._spacing = waypoint, spacing
        self._wall_distance = wall_distance
        self._people, self._people_gap, self._stopped_for = (
            people,
            people_distance - robot.footprint.radius,
            stopped_for,
        )
        self._too_near, self._too_near_distance = too_near, too_near_distance
        self._standing, self._turning, self._turning_from = standing, turning, turning_from

    def reward(self, transition: Transition) -> Floats:
        """Return the sum of the terms (N,)."""
        total = self._waypoint_reward(transition) - self._standing_cost(transition)
        total -= np.maximum(self._people * self._disturbs_people(transition), self._collision * transition.collided)
        missing = 1.0 - transition.after.clearances_people / self._too_near_distance
        total -= self._too_near * np.maximum(missing, 0.0)
        return np.asarray(self._scale * (total + self._goal * transition.arrived))

    def _waypoint_reward(self, transition: Transition) -> Floats:
        """Reward the way to the goal, and the waypoints passed on the path; nothing so near a wall."""
        before, after = transition.before.path_lengths_left, transition.after.path_lengths_left
        passed = np.floor(before / self._spacing) - np.floor(after / self._spacing)
        if self._straight:
            before, after = (
                np.maximum(before, transition.before.goal_distances),
                np.maximum(after, transition.after.goal_distances),
            )
        gain = before - after
        near_wall = (transition.after.clearances < self._wall_distance) & (
            transition.after.clearances < transition.after.clearances_people
        )
        earned = np.where(gain > 0.0, self._nearer, self._farther) * gain + self._waypoint * passed
        return np.where(near_wall, 0.0, earned)

    def _standing_cost(self, transition: Transition) -> Floats:
        """Return what standing costs, more where the robot turns on the spot."""
        stands = transition.after.standing_times > 0.0
        turns = np.abs(transition.after.twists[:, 2]) > self._turning_from
        return np.where(stands, np.where(turns, self._turning, self._standing), 0.0)

    def _disturbs_people(self, transition: Transition) -> NDArray[np.bool_]:
        """Tell who is now too near to people without having stopped for them, and was not before."""
        before, after = (
            (seen.clearances_people < self._people_gap) & (seen.standing_times < self._stopped_for)
            for seen in (transition.before, transition.after)
        )
        return after & ~before
