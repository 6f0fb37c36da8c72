"""The objective, written down once: the compiled terms call these with numbers, the interior-point method with symbols.

Their derivatives in numbers are in ``terms``; casadi finds its own.
"""

from __future__ import annotations

from dataclasses import fields
from typing import Any

from arena_kernels.compiled import inner
from arena_mpc.columns import (
    HEADING_COUNTS,
    NORMAL_X,
    NORMAL_Y,
    REFERENCE_X,
    REFERENCE_Y,
    VELOCITIES,
    VIA_COUNTS,
    VIA_X,
    VIA_Y,
    X,
    Y,
)
from arena_mpc.parameters import Weights

Scalar = Any  # a number, or casadi's SX, which has no types
Row = Any  # an array of numbers, or a list of symbols

WEIGHTS = tuple(field.name for field in fields(Weights))
TIME, STATE_POSITION, STATE_HEADING = (
    WEIGHTS.index("time"),
    WEIGHTS.index("state_position"),
    WEIGHTS.index("state_heading"),
)
CONTROL_LINEAR, CONTROL_ANGULAR = WEIGHTS.index("control_linear"), WEIGHTS.index("control_angular")
GOAL_POSITION, GOAL_HEADING = WEIGHTS.index("goal_position"), WEIGHTS.index("goal_heading")
PATH, PATH_HEADING, VIA_POINTS = WEIGHTS.index("path"), WEIGHTS.index("path_heading"), WEIGHTS.index("via_points")
LINEAR, ANGULAR = WEIGHTS.index("acceleration_linear"), WEIGHTS.index("acceleration_angular")
SLACK, SLACK_SQUARED = WEIGHTS.index("slack"), WEIGHTS.index("slack_squared")


@inner
def interval_objective(weights: Row, timed: bool, step: Scalar, h: Scalar, linear: Scalar, angular: Scalar) -> Scalar:
    """Return what an interval of ``h`` s costs: its time, and the squares of its accelerations."""
    cost = step * (weights[LINEAR] * linear + weights[ANGULAR] * angular)
    return cost + weights[TIME] * h if timed else cost


@inner
def stage_objective(weights: Row, step: Scalar, state: Row, row: Row, off_path: Scalar) -> Scalar:
    """Return what it costs to be beside the path, off its heading and away from a via point.

    ``off_path`` is the squared chord between the headings.
    """
    aside = (state[X] - row[REFERENCE_X]) * row[NORMAL_X] + (state[Y] - row[REFERENCE_Y]) * row[NORMAL_Y]
    cost = step * (weights[PATH] * aside * aside + weights[PATH_HEADING] * row[HEADING_COUNTS] * off_path)
    away = (state[X] - row[VIA_X]) ** 2 + (state[Y] - row[VIA_Y]) ** 2
    return cost + row[VIA_COUNTS] * weights[VIA_POINTS] * away


@inner
def add_regulation(weights: Row, cost: Scalar, state: Row, away: Scalar, turned: Scalar) -> Scalar:
    """Return ``cost`` with what the quadratic form adds: the squares of what is left to the goal, and of velocities."""
    cost += weights[STATE_POSITION] * away + weights[STATE_HEADING] * turned
    for i in range(VELOCITIES, len(state) - 1):
        cost += weights[CONTROL_ANGULAR if i == len(state) - 2 else CONTROL_LINEAR] * state[i] * state[i]
    return cost


@inner
def end_objective(weights: Row, away: Scalar, turned: Scalar) -> Scalar:
    """Return what missing the local goal costs at the plan's end."""
    return weights[GOAL_POSITION] * away + weights[GOAL_HEADING] * turned


@inner
def add_slack(weights: Row, cost: Scalar, slack: Scalar) -> Scalar:
    """Return ``cost`` with that of coming short of a distance by ``slack`` m."""
    return cost + weights[SLACK] * slack + weights[SLACK_SQUARED] * slack * slack


@inner
def squared_distance(state: Row, goal: Row) -> Scalar:
    """Return the squared distance of a state from the goal, m^2."""
    return (state[X] - goal[X]) ** 2 + (state[Y] - goal[Y]) ** 2
