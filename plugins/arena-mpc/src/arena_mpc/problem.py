"""The optimal control problem in symbols: direct multiple shooting, every number a parameter, so that one
build serves all episodes.
"""

from __future__ import annotations

from dataclasses import dataclass
from inspect import unwrap
from typing import NamedTuple

import casadi as ca
import numpy as np

from arena_mpc import objective
from arena_mpc.arrays import FloatArray
from arena_mpc.columns import (
    HEADING,
    MOVER,
    MOVER_RADIUS,
    MOVER_VX,
    MOVER_VY,
    MOVER_X,
    MOVER_Y,
    PLANE,
    PLANE_OFFSET,
    PLANE_X,
    PLANE_Y,
    STAGE_HEAD,
    THETA,
    VELOCITIES,
    X,
    Y,
)
from arena_mpc.models import VELOCITY_COUNTS
from arena_mpc.objective import WEIGHTS
from arena_mpc.parameters import Form, ModelName
from arena_mpc.symbols import DYNAMICS, Symbol
from arena_mpc.terms import SMOOTH

# the objective as Python: called with symbols it gives a symbol
interval_objective, stage_objective = unwrap(objective.interval_objective), unwrap(objective.stage_objective)
add_regulation, end_objective = unwrap(objective.add_regulation), unwrap(objective.end_objective)
add_slack, squared_distance = unwrap(objective.add_slack), unwrap(objective.squared_distance)


@dataclass(frozen=True, slots=True)
class Shape:
    """What a problem is built for: N intervals, C discs of the footprint, K obstacles a disc and stage, M moving
    obstacles.

    ``cells``: the obstacles of a stage are cells, else half-planes; ``hard``: without slack; ``fixed_end``: it ends at
    the goal.
    """

    model: ModelName
    form: Form
    stages: int
    circles: int
    planes: int
    movers: int
    cells: bool
    hard: bool
    fixed_end: bool

    @property
    def slacks(self) -> int:
        """Return how many slacks a stage has."""
        return 0 if self.hard else 1

    @property
    def velocities(self) -> int:
        """Return how many velocities a state has."""
        return VELOCITY_COUNTS[self.model]

    @property
    def pose_and_velocities(self) -> int:
        """Return the length of a state without the interval's length."""
        return VELOCITIES + self.velocities

    @property
    def states(self) -> int:
        """Return the length of a state; in minimum-time form the length of the intervals is its last entry."""
        return self.pose_and_velocities + (self.form == "minimum_time")

    @property
    def stage_row(self) -> int:
        """Return how many parameters a stage has."""
        return STAGE_HEAD + PLANE * self.circles * self.planes + MOVER * self.movers


class Head(NamedTuple):
    """The parameters that all stages share, in their order; symbols or numbers."""

    initial: Symbol
    goal: Symbol
    goal_heading: Symbol
    step: Symbol
    wheelbase: Symbol
    growth: Symbol
    speed_distance: Symbol
    weights: Symbol
    circles_xy: Symbol


class Problem(NamedTuple):
    """A nonlinear program and what its solver and its user need beside it.

    ``equality`` marks the rows of g that are equations; ``lower`` and ``upper`` bound g, a car's turn by +-1 (scaled).
    """

    nlp: dict[str, Symbol]
    equality: list[bool]
    lower: FloatArray
    upper: FloatArray


def formulate_problem(shape: Shape) -> Problem:
    """Write the problem down: states and controls in turn, the gap of each interval before its stage's constraints."""
    head, rows = _make_parameters(shape)
    variables, constraints = [], _Constraints()
    state, price, weights = ca.SX.sym("x0", shape.states), ca.SX(0), ca.vertsplit(head.weights)
    for k in range(shape.stages + 1):
        last = k == shape.stages
        control = ca.SX.sym(f"u{k}", shape.slacks + (0 if last else shape.velocities))
        slack = ca.SX(0) if shape.hard else control[-1]
        variables += [state, control]
        step = state[-1] if shape.form == "minimum_time" else head.step
        if not last:
            following = ca.SX.sym(f"x{k + 1}", shape.states)
            constraints.add_equality(following - _next_state(shape, state, control, step, head))
            linear, angular = ca.sumsqr(control[: shape.velocities - 1]), control[shape.velocities - 1] ** 2
            price += interval_objective(weights, shape.form == "minimum_time", head.step, step, linear, angular)
        price = add_slack(weights, price, slack)
        if k == 0:
            constraints.add_equality(state[: shape.pose_and_velocities] - head.initial)
        else:
            constraints.add_nonnegative(_stage_distances(shape, state, rows[k], head, k * step) + slack)
            price += _stage_cost(shape, state, rows[k], head, step)
        if shape.model == "bicycle" and k > 0:
            constraints.add_unit_range(state[VELOCITIES] * ca.tan(state[VELOCITIES + 1]) / head.wheelbase)
        if last and shape.fixed_end:
            constraints.add_equality(state[:VELOCITIES] - head.goal)
        if not last:
            state = following
    price += end_objective(weights, squared_distance(state, head.goal), _off_goal(state, head))
    nlp = {
        "x": ca.vertcat(*variables),
        "f": price,
        "g": ca.vertcat(*constraints.rows),
        "p": ca.vertcat(*head, *rows),
    }
    return Problem(nlp, constraints.equality, np.array(constraints.lower), np.array(constraints.upper))


class _Constraints:
    """Collects the rows of g."""

    def __init__(self) -> None:
        self.rows: list[Symbol] = []
        self.equality: list[bool] = []
        self.lower: list[float] = []
        self.upper: list[float] = []

    def add_equality(self, rows: Symbol) -> None:
        self._add_rows(rows, True, 0.0, 0.0)

    def add_nonnegative(self, rows: Symbol) -> None:
        self._add_rows(rows, False, 0.0, np.inf)

    def add_unit_range(self, rows: Symbol) -> None:
        self._add_rows(rows, False, -1.0, 1.0)

    def _add_rows(self, rows: Symbol, equality: bool, lower: float, upper: float) -> None:
        count = rows.numel()
        self.rows.append(rows)
        self.equality += [equality] * count
        self.lower += [lower] * count
        self.upper += [upper] * count


def _make_parameters(shape: Shape) -> tuple[Head, list[Symbol]]:
    head = Head(
        ca.SX.sym("initial", shape.pose_and_velocities),
        ca.SX.sym("goal", 3),
        ca.SX.sym("goal_heading"),
        ca.SX.sym("step"),
        ca.SX.sym("wheelbase"),
        ca.SX.sym("growth"),
        ca.SX.sym("speed_distance"),
        ca.SX.sym("weights", len(WEIGHTS)),
        ca.SX.sym("circles", 2 * shape.circles),
    )
    return head, [ca.SX.sym(f"row{k}", shape.stage_row) for k in range(shape.stages + 1)]


def _next_state(shape: Shape, state: Symbol, control: Symbol, step: Symbol, head: Head) -> Symbol:
    moved = DYNAMICS[shape.model](state, control, step, head.wheelbase)
    return ca.vertcat(moved, step) if shape.form == "minimum_time" else moved


def _stage_cost(shape: Shape, state: Symbol, row: Symbol, head: Head, step: Symbol) -> Symbol:
    """Return what a stage costs, as the compiled terms do."""
    weights, listed = ca.vertsplit(head.weights), [*ca.vertsplit(state[: shape.pose_and_velocities]), step]
    cost = stage_objective(weights, head.step, listed, row, angle_error(state[THETA], row[HEADING]))
    if shape.form == "minimum_time":
        return cost
    return add_regulation(weights, cost, listed, squared_distance(state, head.goal), _off_goal(state, head))


def _off_goal(state: Symbol, head: Head) -> Symbol:
    return head.goal_heading * angle_error(state[THETA], head.goal[THETA])


def angle_error(angle: Symbol, wanted: Symbol) -> Symbol:
    """Return the squared chord between two headings on the unit circle: their squared
    difference, but smooth all round.
    """
    return 2.0 * (1.0 - ca.cos(angle - wanted))


def _stage_distances(shape: Shape, state: Symbol, row: Symbol, head: Head, time: Symbol) -> Symbol:
    """Return how far each disc of the footprint is from its half-planes and from each moving obstacle ``time`` s ahead.

    What the robot's speed asks for beyond the constant gap is taken off.
    """
    c, s = ca.cos(state[THETA]), ca.sin(state[THETA])
    end = STAGE_HEAD + PLANE * shape.circles * shape.planes
    planes: Symbol = ca.reshape(row[STAGE_HEAD:end], PLANE, shape.circles * shape.planes)
    movers: Symbol = ca.reshape(row[end:], MOVER, shape.movers)
    distances = []
    for i in range(shape.circles):
        ahead, left = head.circles_xy[2 * i], head.circles_xy[2 * i + 1]
        x, y = state[X] + c * ahead - s * left, state[Y] + s * ahead + c * left
        own = range(i * shape.planes, (i + 1) * shape.planes)
        distances += [_obstacle_distance(shape, planes[:, j], x, y) for j in own]
        for m in range(shape.movers):
            dx, dy = (
                x - movers[MOVER_X, m] - time * movers[MOVER_VX, m],
                y - movers[MOVER_Y, m] - time * movers[MOVER_VY, m],
            )
            distances.append(ca.sqrt(dx**2 + dy**2 + SMOOTH) - movers[MOVER_RADIUS, m] - time * head.growth)
    speed = ca.sqrt(ca.sumsqr(state[VELOCITIES : shape.pose_and_velocities - 1]) + SMOOTH)
    return ca.vertcat(*distances) - head.speed_distance * speed


def _obstacle_distance(shape: Shape, obstacle: Symbol, x: Symbol, y: Symbol) -> Symbol:
    """Return how far (x, y) is inside a half-plane, or from a cell beyond the distance to keep from it."""
    if shape.cells:
        return ca.sqrt((x - obstacle[PLANE_X]) ** 2 + (y - obstacle[PLANE_Y]) ** 2 + SMOOTH) - obstacle[PLANE_OFFSET]
    return obstacle[PLANE_X] * x + obstacle[PLANE_Y] * y - obstacle[PLANE_OFFSET]
