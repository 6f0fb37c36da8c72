"""What the model remembers of each person beside the crowd's own arrays: constants, the way being walked, clocks."""

from __future__ import annotations

from typing import Any

import numpy as np

from arena_core import ConfigurationError, PedestrianSpec
from arena_pedsim.parameters import ForceFactors

NOTHING, NEXT_WAYPOINT, NEW_ROUTE = 0, 1, 2  # what a person wishes of the route planner
MAX_CORNERS = 24  # of one route; a longer one is planned again on arrival at the last of them

PERSON = np.dtype(
    [
        ("max_speed", np.float64),
        ("factor_desired", np.float64),
        ("factor_social", np.float64),
        ("factor_obstacle", np.float64),
        ("factor_robot", np.float64),
        ("goal_x", np.float64),  # where the present waypoint can be reached
        ("goal_y", np.float64),
        ("look_clock", np.float64),  # s since the way ahead was looked at
        ("stuck_clock", np.float64),  # s since the person was at (anchor_x, anchor_y)
        ("anchor_x", np.float64),
        ("anchor_y", np.float64),
        ("waypoint", np.int32),  # index of the present waypoint
        ("waypoints", np.int32),  # number of them
        ("corner", np.int32),  # index of the next corner of the route; ``corners`` of them, then comes the goal
        ("corners", np.int32),
        ("wish", np.int32),
        ("lost", np.int32),  # 1: there is no way to the waypoint, so the person walks straight at it
    ],
    align=True,
)


def remember(spec: PedestrianSpec, factors: ForceFactors) -> np.void:
    """Return the memory of somebody who is about to start; raise ConfigurationError for an impossible force factor."""
    person: np.void = np.zeros(1, PERSON)[0]
    person["max_speed"] = spec.max_speed
    share = 1.0 if factors.reference_speed is None else spec.max_speed / factors.reference_speed
    person["factor_desired"] = _factor(spec, "force_factor_desired", factors.desired)
    person["factor_social"] = share * _factor(spec, "force_factor_social", factors.social)
    person["factor_obstacle"] = share * _factor(spec, "force_factor_obstacle", factors.obstacle)
    person["factor_robot"] = share * _factor(spec, "force_factor_robot", factors.robot)
    person["goal_x"], person["goal_y"] = person["anchor_x"], person["anchor_y"] = spec.position_xy
    person["waypoints"] = len(spec.waypoints_xy)
    person["waypoint"] = -1
    person["wish"] = NEXT_WAYPOINT if len(spec.waypoints_xy) else NOTHING
    return person


def _factor(spec: PedestrianSpec, key: str, default: float) -> float:
    value: Any = spec.behaviour.get(key, default)
    try:
        factor = float(value)
    except (TypeError, ValueError):
        factor = np.nan
    if not (np.isfinite(factor) and factor >= 0.0):
        raise ConfigurationError(f"person {spec.id}: {key} is {value!r}; allowed: a number >= 0")
    return factor
