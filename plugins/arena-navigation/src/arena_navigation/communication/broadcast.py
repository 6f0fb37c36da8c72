"""Robots that tell all teammates in reach where they are, over a radio that is late and loses messages."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from arena_core.parameters import Fraction, NonNegative, Positive
from arena_core.tasks import Communication, Message

LATE = 1e-9  # s that a stamp may be off by rounding


@dataclass(frozen=True, slots=True, eq=False)
class UnderWay:
    """A message that the robots in ``reach`` (M,) hear from ``due`` (s) on."""

    due: float
    message: Message
    reach: NDArray[np.bool_]


class Broadcast(Communication):
    """Each robot tells of itself at each control step; those within ``range`` m hear it ``delay`` s later.

    Walls do not matter. Of each pair a message gets lost with the probability ``loss``, each by itself. The newest one
    of a teammate counts for ``memory`` s after it was told.
    """

    def __init__(self, range: Positive, delay: NonNegative, loss: Fraction, memory: Positive) -> None:
        self._range, self._delay, self._loss, self._memory = range, delay, loss, memory

    def reset(self, robots: int, random: np.random.Generator) -> None:
        """Begin an episode in which nobody knows of anybody."""
        self._random = random
        self._under_way: deque[UnderWay] = deque()
        self._newest: list[dict[int, Message]] = [{} for _ in range(robots)]

    def tell(self, messages: Sequence[Message | None], positions: NDArray[np.float64]) -> None:
        """Send what is told to those in reach; a number is drawn for each pair, whoever tells."""
        apart = np.hypot(*(positions[:, None] - positions).transpose(2, 0, 1))
        reach = (apart <= self._range) & (self._random.random(apart.shape) >= self._loss)
        np.fill_diagonal(reach, val=False)
        for sender, message in enumerate(messages):
            if message is not None:
                self._under_way.append(UnderWay(message.stamp + self._delay, message, reach[sender]))

    def heard(self, robot: int, stamp: float) -> Sequence[Message]:
        """Return the newest message of each teammate that has come through and is not too old."""
        while self._under_way and self._under_way[0].due <= stamp + LATE:
            came = self._under_way.popleft()
            for receiver in np.flatnonzero(came.reach).tolist():
                self._newest[receiver][came.message.sender] = came.message
        known = self._newest[robot]
        return [known[m] for m in sorted(known) if stamp - known[m].stamp <= self._memory + LATE]
