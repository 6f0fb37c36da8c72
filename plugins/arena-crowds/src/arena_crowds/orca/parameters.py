"""The ORCA crowd's numbers as the configuration gives them, and as the kernels read them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

from arena_core.parameters import Fraction, NonNegative, Positive


@dataclass(frozen=True, slots=True)
class RobotRules:
    """What people do for a robot that they see: ``share`` of the avoiding, and a ``margin`` (m)."""

    share: Fraction
    margin: NonNegative


@dataclass(frozen=True, slots=True)
class Wayfinding:
    """How people follow their waypoints: distances in m, periods in s, ``stuck_speed`` as a
    fraction of a person's own maximum.
    """

    cell: Positive
    waypoint_radius: Positive
    corner_radius: Positive
    look_period: Positive
    stuck_period: Positive
    door_wait: Positive
    stuck_speed: Fraction


class RouteRules(NamedTuple):
    """Numbers of ``Wayfinding``."""

    waypoint_radius: float
    corner_radius: float
    look_period: float
    stuck_period: float
    door_wait: float
    stuck_speed: float


class OrcaRules(NamedTuple):
    """All that does not change from step to step."""

    yields: bool
    horizon: float
    wall_horizon: float
    overlap_time: float
    range: float
    neighbours: int
    side: float
    robot_share: float
    robot_margin: float
    way: RouteRules
