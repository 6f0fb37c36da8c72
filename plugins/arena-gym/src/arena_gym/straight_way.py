"""What a recipe's rewards pay a robot that drives straight to its goal: one that pays nothing teaches nothing."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from arena_core import ConfigurationError, Reward, Robot, Transition
from arena_core.hosting import Situation

Floats = NDArray[np.float64]

WAY = 16.0  # m, from wall to wall of the suite's middle-sized worlds
CLEAR = 5.0  # m to all things: nothing is near


@dataclass(frozen=True, slots=True)
class StraightWay:
    """What ``WAY`` m of free straight way at full speed pay, in all and with later rewards discounted, and what
    standing for as long pays; the ``time`` it takes (s), and how far ahead (m) what comes counts by more than 1/e.
    """

    time: float
    pays: float
    discounted: float
    standing: float
    sight: float

    def describe(self) -> str:
        """Return a sentence on it."""
        return (
            f"a straight way of {WAY:g} m at full speed takes {self.time:.1f} s and pays {self.pays:.2f} "
            f"({self.discounted:.2f} discounted), standing for as long {self.standing:.2f}; "
            f"rewards {self.sight:.1f} m ahead count by 1/e"
        )

    def check(self) -> None:
        """Raise ConfigurationError where a robot earns no more by driving than by standing."""
        if self.pays <= self.standing:
            raise ConfigurationError(
                f"reward: {self.describe()}; allowed: rewards that pay for driving, such as more progress"
            )


def straight_way(reward: Reward, robot: Robot, gamma: float, every: int = 1) -> StraightWay:
    """Judge the way and the stand; a decision holds for ``every`` control steps, by which ``gamma`` discounts."""
    speed, period = robot.limits.vx_max, robot.control_period
    steps = math.ceil(WAY / (speed * period) - 1e-9)
    driven = np.minimum(np.arange(steps + 1) * speed * period, WAY)
    paid = reward.reward(_transition(driven, speed, period, arrived=True))
    stood = reward.reward(_transition(np.zeros(steps + 1), 0.0, period, arrived=False))
    discounted = paid * gamma ** (np.arange(steps) // every)
    sight = speed * period * every / -math.log(gamma) if 0.0 < gamma < 1.0 else (math.inf if gamma else 0.0)
    return StraightWay(steps * period, float(paid.sum()), float(discounted.sum()), float(stood.sum()), sight)


def _transition(driven: Floats, speed: float, period: float, *, arrived: bool) -> Transition:
    """Return the steps of one episode as those of so many robots, each a step further on."""
    steps = len(driven) - 1
    commands = np.tile((speed, 0.0, 0.0), (steps, 1))
    last, no = np.vstack([np.zeros((1, 3)), commands[1:]]), np.zeros(steps, bool)
    ended = np.arange(steps) == steps - 1
    before, after = (_situation(driven, speed, period, k) for k in (0, 1))
    return Transition(before, after, commands, last, ended & arrived, no, ended & (not arrived), period)


def _situation(driven: Floats, speed: float, period: float, first: int) -> Situation:
    """Return where the robot is before (0) or after (1) each step."""
    x = driven[first : len(driven) - 1 + first]
    nothing = np.zeros_like(x)
    poses, twists = np.column_stack([x, nothing, nothing]), np.column_stack([nothing + speed, nothing, nothing])
    standing: Floats = np.arange(first, len(x) + first, dtype=np.float64) * (0.0 if speed else period)
    clear, far = nothing + CLEAR, nothing + math.inf
    return Situation(poses, twists, WAY - x, WAY - x, nothing, clear, far, clear, standing)
