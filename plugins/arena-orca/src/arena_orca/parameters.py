"""What a robot and its YAML tell the planner: checked groups of parameters, and the plain
numbers that the kernels take.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, NamedTuple

from arena_core.parameters import Bounds, NonNegative, Positive, PositiveInt

OMNIDIRECTIONAL, DIFFERENTIAL, ACKERMANN = 0, 1, 2


@dataclass(frozen=True, slots=True)
class Speeds:
    """The speeds to plan with; what is None is the robot's own limit."""

    vx_min: Annotated[float, Bounds(high=0.0)] | None  # m/s
    vx_max: Positive | None  # m/s
    vy_max: NonNegative | None  # m/s
    wz_max: Positive | None  # rad/s


@dataclass(frozen=True, slots=True)
class People:
    """How tracks become half-planes."""

    horizon: Positive  # s
    reciprocity: Annotated[float, Bounds(low=0.5, high=1.0)]  # -
    margin: NonNegative  # m
    overlap_time: Positive  # s
    greatest_number: PositiveInt  # -
    erase_margin: NonNegative  # m


@dataclass(frozen=True, slots=True)
class Statics:
    """How lethal cells become half-planes, and how near the footprint may come to one."""

    horizon: Positive  # s
    margin: NonNegative  # m
    padding: NonNegative  # m


@dataclass(frozen=True, slots=True)
class Driving:
    """How the path becomes a preferred velocity, and a velocity of the effective centre a command."""

    centre_ahead: Positive  # m
    reach_time: Positive  # s
    lookahead: Positive  # m
    turn_time: Positive  # s
    goal_time: Positive  # s
    patience: Positive | None  # s
    escape_time: Positive  # s


class Body(NamedTuple):
    """What moves: its kinematics, the effective centre's place ahead of ``base_link``, and radii of discs about that
    centre, m.

    ``whole`` holds the footprint, ``front`` that part of it which lies not behind ``base_link``.
    """

    kinematics: int
    ahead: float
    whole: float
    front: float


class Limits(NamedTuple):
    """Speeds (m/s, rad/s), accelerations (m/s^2, rad/s^2) and the least turning radius (m, 0 unless Ackermann)."""

    vx_min: float
    vx_max: float
    vy_max: float
    wz_max: float
    ax_max: float
    ay_max: float
    alpha_max: float
    turn_radius: float


class PersonRules(NamedTuple):
    """Numbers of ``People``."""

    horizon: float
    reciprocity: float
    margin: float
    overlap_time: float
    greatest_number: int


class StaticRules(NamedTuple):
    """Numbers of ``Statics``, and the time in which a gap that is missing is made, s."""

    horizon: float
    margin: float
    padding: float
    overlap_time: float


class DriveRules(NamedTuple):
    """Numbers of ``Driving``, and the control period, s."""

    reach_time: float
    lookahead: float
    turn_time: float
    goal_time: float
    period: float


class Settings(NamedTuple):
    """All that does not change from step to step."""

    body: Body
    limits: Limits
    people: PersonRules
    statics: StaticRules
    drive: DriveRules
