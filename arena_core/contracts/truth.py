"""What a privileged part of a robot's brain is shown: the truth of its world, now and ahead."""

from __future__ import annotations

from abc import ABC
from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from arena_core.contracts.simulation import Simulator
from arena_core.values.episode import Scenario, WorldState
from arena_core.values.geometry import FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class PeopleAhead:
    """Where people will be if the robot is not there, at H instants; who is absent then is at NaN.

    times (H,) s from now, whole ticks; ids (P,), positions (P, H, 2) m and velocities (P, H, 2) m/s in ``map``, radii
    (P,) m.
    """

    times: FloatArray
    ids: NDArray[np.int32]
    positions: FloatArray
    velocities: FloatArray
    radii: FloatArray


class Truth(Protocol):
    """What is true in the world of one episode; only simulators know it.

    It belongs to the world that the episode is driven in: ``scenario`` is its problem, with map, obstacles and
    furniture.
    """

    @property
    def scenario(self) -> Scenario:
        """Return the problem of this episode."""
        ...

    def state(self) -> WorldState:
        """Return what is true now: the robot's pose and twist, the people."""
        ...

    def people_ahead(self, times: ArrayLike) -> PeopleAhead:
        """Return where people will be at ``times`` (H,), s from now, rising, each rounded to a tick.

        They walk as if the robot were not there. Raises ConfigurationError where the world cannot be forked.
        """
        ...

    def fork(self, streams: Sequence[int] = (0,), *, robots: bool = True) -> Simulator:
        """Return worlds that go on from this one, now, one for each of ``streams`` (0: with its own numbers); with or
        without the robot.
        """
        ...


class BrainPart(ABC):  # noqa: B024 - what its parts do is for the interfaces to say
    """A part of a robot's brain: planner, localiser, tracker, predictor and the like.

    Attributes:

    - ``privileged``: whether it sees the truth. Runs and tables name such a part, submissions and training refuse it,
      and on a real robot there is no truth.
    """

    privileged: ClassVar[bool] = False

    def see(self, truth: Truth) -> None:  # noqa: B027 - most parts see no truth
        """Take the truth of an episode that begins; called before each ``reset``, of ``privileged`` parts alone.

        What it tells is of the moment at which it is asked.
        """
