"""What a control step is worth: the reward that the values of CADRL and SARL are sums of."""

from __future__ import annotations

from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from arena_core import Reward, Robot, Transition
from arena_core.parameters import Bounds, NonNegative, Positive


class CadrlReward(Reward):
    """The goal is worth 1, and so is driving at full speed for ever; a contact costs, and so does coming too near to
    people.

    Without a contact or a person about, a robot that drives along its path at its greatest speed earns (1 - discount) a
    second, which with the goal's 1 gives it a value of 1 everywhere: what is less is owed to people, walls and detours.
    """

    def __init__(
        self,
        robot: Robot,
        speed: Positive | None,
        discount: Annotated[float, Bounds(low=0.01, high=0.999)],
        collision: NonNegative,
        discomfort: NonNegative,
        comfort: Positive,
    ) -> None:
        self._speed = min(speed or robot.limits.vx_max, robot.limits.vx_max)
        self._discount, self._collision = discount, collision
        self._discomfort, self._comfort = discomfort, comfort

    def reward(self, transition: Transition) -> NDArray[np.float64]:
        """Return the reward of each robot (N,)."""
        before, after, period = transition.before, transition.after, transition.period
        progress = (before.path_lengths_left - after.path_lengths_left) / (self._speed * period)
        missing = np.clip(1.0 - after.clearances_people / self._comfort, 0.0, 1.0)
        earned = (1.0 - self._discount**period) * (np.clip(progress, -2.0, 2.0) - self._discomfort * missing)
        earned = np.where(transition.arrived, 1.0, earned)
        return np.asarray(np.where(transition.collided, -self._collision, earned))
