"""What a recipe's rewards pay a robot that drives straight to its goal: one that pays nobody teaches nothing."""

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
class Worth:
    """What a course of rewards is worth ``in_all``, and ``discounted`` to where it begins."""

    in_all: float
    discounted: float

    def __str__(self) -> str:
        return f"{self.in_all:.2f} ({self.discounted:.2f} discounted)"


@dataclass(frozen=True, slots=True)
class StraightWay:
    """What ``WAY`` m of free straight way at full speed pay, and each ``decision`` on them; what standing pays for as
    long, or for as long as the recipe lets a robot stand, and what a ``collision`` at once.

    The way takes ``time`` s, standing lasts ``stood`` s; what comes within ``sight`` m counts by more than 1/e.
    ``arriving`` is what the last step pays, ``driving_on`` the discounted worth of a way without an end: where that is
    more, a robot that finds ways round learns to arrive late.
    """

    time: float
    decision: float
    driving: Worth
    stood: float
    standing: Worth
    collision: float
    arriving: float
    driving_on: float
    sight: float

    def describe(self) -> str:
        """Return a sentence on it."""
        return (
            f"a straight way of {WAY:g} m at full speed takes {self.time:.1f} s and pays {self.driving}, "
            f"{self.decision:.3f} a decision, standing for {self.stood:.1f} s {self.standing}, a collision at once "
            f"{self.collision:.2f}, arriving {self.arriving:.2f}, driving on for ever {self.driving_on:.2f}; "
            f"rewards {self.sight:.1f} m ahead count by 1/e"
        )

    def refusal(self) -> str | None:
        """Return a sentence on why a robot earns no more by driving than by standing or by colliding; None where it
        does.
        """
        others = {
            "standing": self.driving.in_all <= self.standing.in_all,
            "standing, discounted": self.driving.discounted <= self.standing.discounted,
            "a collision": self.driving.discounted <= self.collision,
        }
        better = [name for name, is_better in others.items() if is_better]
        if not better:
            return None
        return (
            f"reward pays nobody: driving earns no more than {better[0]} ({self.describe()}); allowed: rewards that "
            "pay for driving, such as reward=normalized_progress or more progress, or allow_unpaid=true"
        )

    def check(self) -> None:
        """Raise ConfigurationError where there is a refusal."""
        if (refusal := self.refusal()) is not None:
            raise ConfigurationError(refusal)


@dataclass(frozen=True, slots=True)
class Decisions:
    """How a robot decides in training: for ``every`` control steps, ``gamma`` being the discount from one decision to
    the next; it may stand for ``standing_to_end`` s, any time where None.
    """

    gamma: float
    every: int = 1
    standing_to_end: float | None = None


def straight_way(reward: Reward, robot: Robot, decisions: Decisions) -> StraightWay:
    """Judge the way, a stand and a collision in a free place."""
    speed, period, every, gamma = robot.limits.vx_max, robot.control_period, decisions.every, decisions.gamma
    steps = math.ceil(WAY / (speed * period) - 1e-9)
    standing = steps
    if decisions.standing_to_end is not None:
        standing = min(steps, math.ceil(decisions.standing_to_end / period - 1e-9))
    driven = np.minimum(np.arange(steps + 1) * speed * period, WAY)
    paid = reward.reward(_transition(driven, speed, period, end="arrived"))
    stood = reward.reward(_transition(np.zeros(standing + 1), 0.0, period, end="timed_out"))
    hit = reward.reward(_transition(driven[:2], speed, period, end="collided"))
    sight = speed * period * every / -math.log(gamma) if 0.0 < gamma < 1.0 else (math.inf if gamma else 0.0)
    decision = float(paid[min(1, steps - 1)]) * every
    return StraightWay(
        steps * period,
        decision,
        _worth(paid, decisions),
        standing * period,
        _worth(stood, decisions),
        float(hit[0]),
        float(paid[-1]),
        decision / (1.0 - gamma) if gamma < 1.0 else math.copysign(math.inf, decision),
        sight,
    )


def _worth(rewards: Floats, decisions: Decisions) -> Worth:
    discounts = decisions.gamma ** (np.arange(len(rewards)) // decisions.every)
    return Worth(float(rewards.sum()), float((rewards * discounts).sum()))


def _transition(driven: Floats, speed: float, period: float, *, end: str) -> Transition:
    """Return the steps of one episode as those of so many robots, each a step further on; ``end`` is how it ends."""
    steps = len(driven) - 1
    commands = np.tile((speed, 0.0, 0.0), (steps, 1))
    last, ended = np.vstack([np.zeros((1, 3)), commands[1:]]), np.arange(steps) == steps - 1
    ends = {name: ended & (end == name) for name in ("arrived", "collided", "timed_out")}
    before, after = (_situation(driven, speed, period, k) for k in (0, 1))
    return Transition(before, after, commands, last, period=period, **ends)


def _situation(driven: Floats, speed: float, period: float, first: int) -> Situation:
    """Return where the robot is before (0) or after (1) each step."""
    x = driven[first : len(driven) - 1 + first]
    nothing = np.zeros_like(x)
    poses, twists = np.column_stack([x, nothing, nothing]), np.column_stack([nothing + speed, nothing, nothing])
    standing: Floats = np.arange(first, len(x) + first, dtype=np.float64) * (0.0 if speed else period)
    clear, far = nothing + CLEAR, nothing + math.inf
    return Situation(poses, twists, WAY - x, WAY - x, nothing, clear, far, clear, standing)
