"""The optimal control problem in symbols: direct multiple shooting, every number a parameter, so that one
build serves all episodes.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import casadi as ca
import numpy as np

from arena_mpc.arrays import FloatArray
from arena_mpc.models import VELOCITIES
from arena_mpc.parameters import Form, ModelName
from arena_mpc.symbols import DYNAMICS, Symbol
from arena_mpc.terms import MOVER, PLANE, SMOOTH, STAGE_HEAD, WEIGHTS


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
        return VELOCITIES[self.model]

    @property
    def pose_and_velocities(self) -> int:
        """Return the length of a state without the interval's length."""
        return 3 + self.velocities

    @property
    def states(self) -> int:
        """Return the length of a state; in minimum-time form the length of the intervals is its last entry."""
        return self.pose_and_velocities + (self.form == "minimum_time")

    @property
    def stage_row(self) -> int:
        """Return how many parameters a stage has."""
        return STAGE_HEAD + PLANE * self.circles * self.planes


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
    movers: Symbol


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
    state, objective = ca.SX.sym("x0", shape.states), ca.SX(0)
    for k in range(shape.stages + 1):
        last = k == shape.stages
        control = ca.SX.sym(f"u{k}", shape.slacks + (0 if last else shape.velocities))
        slack = ca.SX(0) if shape.hard else control[-1]
        variables += [state, control]
        step = state[-1] if shape.form == "minimum_time" else head.step
        if not last:
            following = ca.SX.sym(f"x{k + 1}", shape.states)
            constraints.add_equality(following - _next_state(shape, state, control, step, head))
            objective += _interval_cost(shape, state, control, step, head)
        objective += _weight_symbol(head, "slack") * slack + _weight_symbol(head, "slack_squared") * slack**2
        if k == 0:
            constraints.add_equality(state[: shape.pose_and_velocities] - head.initial)
        else:
            constraints.add_nonnegative(_stage_distances(shape, state, rows[k], head, k * step) + slack)
            objective += _stage_cost(shape, state, rows[k], head)
        if shape.model == "bicycle" and k > 0:
            constraints.add_unit_range(state[3] * ca.tan(state[4]) / head.wheelbase)
        if last and shape.fixed_end:
            constraints.add_equality(state[:3] - head.goal)
        if not last:
            state = following
    objective += _terminal_cost(state, head)
    nlp = {
        "x": ca.vertcat(*variables),
        "f": objective,
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
        ca.SX.sym("movers", MOVER * shape.movers),
    )
    return head, [ca.SX.sym(f"row{k}", shape.stage_row) for k in range(shape.stages + 1)]


def _next_state(shape: Shape, state: Symbol, control: Symbol, step: Symbol, head: Head) -> Symbol:
    moved = DYNAMICS[shape.model](state, control, step, head.wheelbase)
    return ca.vertcat(moved, step) if shape.form == "minimum_time" else moved


def _weight_symbol(head: Head, name: str) -> Symbol:
    return head.weights[WEIGHTS.index(name)]


def _interval_cost(shape: Shape, state: Symbol, control: Symbol, step: Symbol, head: Head) -> Symbol:
    """Return what an interval costs: its time, or the squares of controls; and the effort of accelerating."""
    linear, angular = ca.sumsqr(control[: shape.velocities - 1]), control[shape.velocities - 1] ** 2
    cost = head.step * (
        _weight_symbol(head, "acceleration_linear") * linear + _weight_symbol(head, "acceleration_angular") * angular
    )
    if shape.form == "minimum_time":
        return cost + _weight_symbol(head, "time") * step
    return cost


def _stage_cost(shape: Shape, state: Symbol, row: Symbol, head: Head) -> Symbol:
    """Return what a stage costs: distance beside the path, heading; in quadratic
    form distance to the goal and speed.
    """
    aside = (state[0] - row[0]) * row[2] + (state[1] - row[1]) * row[3]
    turned = row[5] * angle_error(state[2], row[4])
    cost = head.step * (_weight_symbol(head, "path") * aside**2 + _weight_symbol(head, "path_heading") * turned)
    cost += row[8] * _weight_symbol(head, "via_points") * ca.sumsqr(state[:2] - row[6:8])
    if shape.form == "minimum_time":
        return cost
    away = ca.sumsqr(state[:2] - head.goal[:2])
    speeds = state[3 : shape.pose_and_velocities]
    cost += _weight_symbol(head, "state_position") * away
    cost += head.goal_heading * _weight_symbol(head, "state_heading") * angle_error(state[2], head.goal[2])
    return (
        cost
        + _weight_symbol(head, "control_linear") * ca.sumsqr(speeds[:-1])
        + _weight_symbol(head, "control_angular") * speeds[-1] ** 2
    )


def _terminal_cost(state: Symbol, head: Head) -> Symbol:
    """Return what the end of the plan costs: missing the local goal."""
    away = ca.sumsqr(state[:2] - head.goal[:2])
    turned = head.goal_heading * angle_error(state[2], head.goal[2])
    return _weight_symbol(head, "goal_position") * away + _weight_symbol(head, "goal_heading") * turned


def angle_error(angle: Symbol, wanted: Symbol) -> Symbol:
    """Return the squared chord between two headings on the unit circle: their squared
    difference, but smooth all round.
    """
    return 2.0 * (1.0 - ca.cos(angle - wanted))


def _stage_distances(shape: Shape, state: Symbol, row: Symbol, head: Head, time: Symbol) -> Symbol:
    """Return how far each disc of the footprint is from its half-planes and from each moving obstacle ``time`` s ahead.

    What the robot's speed asks for beyond the constant gap is taken off.
    """
    c, s = ca.cos(state[2]), ca.sin(state[2])
    planes: Symbol = ca.reshape(row[STAGE_HEAD:], PLANE, shape.circles * shape.planes)
    movers: Symbol = ca.reshape(head.movers, MOVER, shape.movers)
    distances = []
    for i in range(shape.circles):
        ahead, left = head.circles_xy[2 * i], head.circles_xy[2 * i + 1]
        x, y = state[0] + c * ahead - s * left, state[1] + s * ahead + c * left
        own = range(i * shape.planes, (i + 1) * shape.planes)
        distances += [_obstacle_distance(shape, planes[:, j], x, y) for j in own]
        for m in range(shape.movers):
            dx, dy = x - movers[0, m] - time * movers[2, m], y - movers[1, m] - time * movers[3, m]
            distances.append(ca.sqrt(dx**2 + dy**2 + SMOOTH) - movers[4, m] - time * head.growth)
    speed = ca.sqrt(ca.sumsqr(state[3 : 2 + shape.velocities]) + SMOOTH)
    return ca.vertcat(*distances) - head.speed_distance * speed


def _obstacle_distance(shape: Shape, obstacle: Symbol, x: Symbol, y: Symbol) -> Symbol:
    """Return how far (x, y) is inside a half-plane, or from a cell beyond the distance to keep from it."""
    if shape.cells:
        return ca.sqrt((x - obstacle[0]) ** 2 + (y - obstacle[1]) ** 2 + SMOOTH) - obstacle[2]
    return obstacle[0] * x + obstacle[1] * y - obstacle[2]
