"""Whom a robot is to keep with, in tasks that need more than a goal."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from arena_core.base.errors import ConfigurationError
from arena_core.values.parameters import Positive

Manner = Literal["follow", "accompany", "lead"]


@dataclass(frozen=True, slots=True)
class Company:
    """A person whom a robot follows, accompanies side by side, or leads to its goal.

    ``person`` is the person's id. Robot and person are together while their centres are ``nearest`` .. ``farthest`` m
    apart. A robot that follows or accompanies is to be half-way between the two, behind or beside the person; one that
    leads goes to the scenario's goal, and waits while the person is farther off.
    """

    manner: Manner
    person: int
    nearest: Positive
    farthest: Positive

    def __post_init__(self) -> None:
        """Raise ConfigurationError where nearest is above farthest."""
        if self.nearest > self.farthest:
            raise ConfigurationError(f"nearest is {self.nearest:g}; allowed: up to farthest, {self.farthest:g} m")

    @property
    def distance(self) -> float:
        """Return how far from the person the robot is to be, m."""
        return 0.5 * (self.nearest + self.farthest)
