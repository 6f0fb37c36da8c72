"""What a value network is shown and chooses from, as YAML and cards have it, and as kernels take it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, NamedTuple

import numpy as np
from numpy.typing import NDArray

from arena_core.parameters import Bounds, NonNegative, Positive, PositiveInt

Floats = NDArray[np.float64]
Share = Annotated[float, Bounds(low=-1.0, high=1.0)]

DIFFERENTIAL, OMNIDIRECTIONAL = 0, 1
KINEMATICS = {"differential": DIFFERENTIAL, "omnidirectional": OMNIDIRECTIONAL}

GOAL_WAY, TARGET_WAY = 5.0, 2.0  # m that ways to the goal and to the target are told over
PERSON_WAY, PERSON_SPEED, GAP = 4.0, 1.5, 2.0  # m, m/s and m that people's places, speeds and gaps are told over
ROOM = 1.0  # m: walls farther off are none
ROOM_POINTS = 8  # looked at round the robot, besides where it is
OWN, PERSON = 7 + 1 + ROOM_POINTS, 7  # numbers of the robot and of each person


@dataclass(frozen=True, slots=True)
class PerceptionSettings:
    """What is looked at: ``people`` nearest ones, walls ``room_radius`` m round the robot, the path up to ``lookahead``
    m.

    Returns within ``erase_margin`` m of a tracked person are that person's, and no wall.
    """

    people: PositiveInt
    lookahead: Positive
    room_radius: Positive
    erase_margin: NonNegative


@dataclass(frozen=True, slots=True)
class ActionSettings:
    """Which velocities are chosen from, by shares of the greatest: ``speeds`` forwards; ``turns`` and ``backing_turns``
    of robots that cannot go sideways; ``directions`` of those that can. An action is followed for ``horizon`` s.
    """

    speeds: tuple[Positive, ...]
    turns: tuple[Share, ...]
    backing_turns: tuple[Share, ...]
    directions: PositiveInt
    horizon: Positive


@dataclass(frozen=True, slots=True)
class Safety:
    """The layer that keeps clear of what stands: an action is held for ``hold`` s, then braked, with a gap
    of ``padding`` m at least.
    """

    hold: Positive
    padding: NonNegative


@dataclass(frozen=True, slots=True)
class RewardSettings:
    """What a step is worth, in units of having reached the goal (docs/cadrl.md).

    ``discount`` a second; ``collision`` less at a contact with a person; ``discomfort`` less for touching, in
    proportion where less than ``comfort`` m of clearance are left; a goal is reached within ``goal_radius`` m.
    """

    discount: Annotated[float, Bounds(low=0.01, high=0.999)]
    collision: NonNegative
    discomfort: NonNegative
    comfort: Positive
    goal_radius: Positive


class Limits(NamedTuple):
    """Greatest speeds, m/s and rad/s, and accelerations, m/s^2 and rad/s^2."""

    vx_max: float
    wz_max: float
    ax_max: float
    ay_max: float
    alpha_max: float


class Rules(NamedTuple):
    """``PerceptionSettings``, ``ActionSettings``, ``Safety`` and ``RewardSettings`` as kernels take them."""

    kinematics: int
    limits: Limits
    lookahead: float
    room_radius: float
    horizon: float
    hold: float
    padding: float
    discount: float
    collision: float
    discomfort: float
    comfort: float
    goal_radius: float
    margin: float
