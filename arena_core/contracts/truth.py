"""What a privileged part of a robot's brain is shown: the truth of its world, now and ahead."""

from __future__ import annotations

from abc import ABC
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from arena_core.contracts.simulation import Simulator
from arena_core.values.episode import Scenario, WorldState
from arena_core.values.geometry import FloatArray
from arena_core.values.robot import Robot


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

    @property
    def team(self) -> Sequence[TeamTruth]:
        """Return the truth of each robot of the team, in their order; empty where the robot is alone."""
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
        without the robot, and its teammates.
        """
        ...


class TeamTruth(Truth, Protocol):
    """What is true of one robot of a team: ``scenario`` has its own start and goal, ``state`` its own pose.

    A fork holds the whole team, and takes a command for each robot.
    """

    @property
    def robot(self) -> Robot:
        """Return the type of this robot."""
        ...

    @property
    def shared(self) -> dict[str, Any]:
        """Return what privileged parts of all robots of the team tell each other in this episode."""
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
