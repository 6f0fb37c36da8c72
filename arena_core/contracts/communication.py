"""The interface of what carries messages between the robots of a team."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence

import numpy as np

from arena_core.values.geometry import FloatArray
from arena_core.values.messages import Message


class Communication(ABC):
    """Carries what the robots of a team tell each other.

    Life cycle: built once in each process of a run; for every episode ``reset`` once, then at each control step
    ``heard``, before anyone decides, and ``tell``, once all have decided. What is told is heard at the next control
    step at the earliest. Where messages get lost or late by chance, draw as many numbers at each ``tell`` whoever
    tells, so that the luck of a scenario is the same for all planners.

    ```python
    class Shouting(Communication):
        def reset(self, robots: int, random: np.random.Generator) -> None:
            self.told: list[Message] = []

        def tell(self, messages: Sequence[Message | None], positions: FloatArray) -> None:
            self.told = [message for message in messages if message is not None]

        def heard(self, robot: int, stamp: float) -> Sequence[Message]:
            return [message for message in self.told if message.sender != robot]
    ```
    """

    @abstractmethod
    def reset(self, robots: int, random: np.random.Generator) -> None:
        """Begin an episode of so many robots, M; ``random`` is the generator of this episode."""

    @abstractmethod
    def tell(self, messages: Sequence[Message | None], positions: FloatArray) -> None:
        """Take what each of the M robots tells now, None of one whose episode is over; ``positions`` (M, 2) m in
        ``map`` are where they truly are.
        """

    @abstractmethod
    def heard(self, robot: int, stamp: float) -> Sequence[Message]:
        """Return what a robot knows of others at ``stamp`` (s): of each the newest message that counts."""
