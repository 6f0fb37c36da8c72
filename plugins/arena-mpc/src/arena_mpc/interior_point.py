"""Compiled problems, kept for the life of the process, and their solution by an interior-point method of casadi."""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Any

import casadi as ca
import numpy as np

from arena_mpc.arrays import FloatArray
from arena_mpc.columns import VELOCITIES
from arena_mpc.parameters import SolverSettings
from arena_mpc.plan import Plan, Room, Solution
from arena_mpc.problem import Problem, Shape, formulate_problem
from arena_mpc.terms import Terms

FEASIBLE = 1e-3  # m, rad, m/s: greatest gap between intervals of a plan that can be driven
BARRIER = 0.1  # at which the interior-point method begins: warm enough for a shifted plan, free enough for a new one


class CompiledProblem:
    """One problem, built once; solve it with other numbers as often as needed."""

    def __init__(self, shape: Shape, settings: SolverSettings) -> None:
        problem = formulate_problem(shape)
        self.shape = shape
        self._lower, self._upper = problem.lower, problem.upper
        self._turns = np.abs(self._upper) == 1.0
        self._solve = _interior_point(problem, settings)

    def solve(self, terms: Terms, state: FloatArray, guess: Plan, room: Room) -> Solution:
        """Return the optimal plan from an initial guess, None when no plan was found that the robot could drive."""
        low, high = self._variable_bounds(room)
        lower, upper = np.where(self._turns, -room.turn, self._lower), np.where(self._turns, room.turn, self._upper)
        found = self._solve(
            x0=self._pack_plan(guess, room), p=parameter_values(terms, state), lbx=low, ubx=high, lbg=lower, ubg=upper
        )
        values, rows, done = (
            found["x"].full().ravel(),
            found["g"].full().ravel(),
            int(self._solve.stats()["iter_count"]),
        )
        violation = np.maximum(lower - rows, rows - upper)
        if not np.isfinite(values).all() or float(violation.max()) > FEASIBLE:
            return Solution(None, math.inf, done)
        return Solution(self._unpack_plan(values, guess.step), float(found["f"]), done)

    def _filled_rows(self, stages_and_end: int, filled: float) -> FloatArray:
        """Return rows of state, controls and, where constraints are soft, slack, one for each stage."""
        return np.full((stages_and_end, self.shape.states + self.shape.velocities + self.shape.slacks), filled)

    def _pack_plan(self, plan: Plan, room: Room) -> FloatArray:
        shape = self.shape
        values = self._filled_rows(shape.stages + 1, 0.0)
        values[:, : shape.pose_and_velocities] = plan.states
        if shape.form == "minimum_time":
            values[:, shape.states - 1] = plan.step
        steps = np.diff(plan.states[:, VELOCITIES:], axis=0) / plan.step
        values[:-1, self._control_columns()] = np.clip(steps, -room.most, room.most)
        if shape.slacks:
            values[:, -1] = plan.slack
        return self._flatten_rows(values)

    def _control_columns(self) -> slice:
        return slice(self.shape.states, self.shape.states + self.shape.velocities)

    def _variable_bounds(self, room: Room) -> tuple[FloatArray, FloatArray]:
        sides = []
        for sign, velocities, step in ((-1.0, room.low, room.step_low), (1.0, room.high, room.step_high)):
            values = self._filled_rows(self.shape.stages + 1, sign * np.inf)
            values[1:, VELOCITIES : self.shape.pose_and_velocities] = velocities
            if self.shape.form == "minimum_time":
                values[:, self.shape.states - 1] = step
            values[:-1, self._control_columns()] = sign * room.most
            if self.shape.slacks:
                values[:, -1] = 0.0 if sign < 0.0 else np.inf
            sides.append(self._flatten_rows(values))
        return sides[0], sides[1]

    def _flatten_rows(self, values: FloatArray) -> FloatArray:
        """Flatten the rows; the last stage has no controls but slack."""
        flat, slacks = values.ravel(), self.shape.slacks
        return np.concatenate((flat[: len(flat) - slacks - self.shape.velocities], flat[len(flat) - slacks :]))

    def _unpack_plan(self, values: FloatArray, step: float) -> Plan:
        shape, end = self.shape, len(values) - self.shape.slacks
        whole = np.concatenate((values[:end], np.zeros(shape.velocities), values[end:])).reshape(shape.stages + 1, -1)
        if shape.form == "minimum_time":
            step = float(whole[0, shape.states - 1])
        slack = whole[:, -1].copy() if shape.slacks else np.zeros(shape.stages + 1)
        return Plan(whole[:, : shape.pose_and_velocities].copy(), step, slack)


def parameter_values(terms: Terms, state: FloatArray) -> FloatArray:
    """Return a problem's parameters in the order of ``problem.Head``, then the stages' rows."""
    fixed = (terms.goal_heading, terms.step, terms.wheelbase, terms.growth, terms.speed_distance)
    stages = len(terms.rows)
    rows = np.concatenate((terms.rows, terms.movers.reshape(stages, -1)), axis=1)
    return np.concatenate((state, terms.goal, fixed, terms.weights, terms.discs_xy.ravel(), rows.ravel()))


@lru_cache(maxsize=60)
def compiled_problem(shape: Shape, settings: SolverSettings) -> CompiledProblem:
    """Return the problem of this shape, built at the first request of the process."""
    return CompiledProblem(shape, settings)


def has_solver(name: str) -> bool:
    """Return whether casadi was built with a solver."""
    return bool(ca.has_nlpsol(name))


def _interior_point(problem: Problem, settings: SolverSettings) -> Any:
    """Build a quiet solver that is bounded by iterations, never by time."""
    common = {"max_iter": settings.solution_iterations, "tol": settings.tolerance, "mu_init": BARRIER, "print_level": 0}
    options: dict[str, Any] = {"print_time": False, "error_on_fail": False}
    if settings.name == "fatrop":
        options |= {"structure_detection": "auto", "equality": problem.equality, "fatrop": common}
    else:
        options |= {"ipopt": {**common, "sb": "yes"}}
    return ca.nlpsol("mpc", settings.name, problem.nlp, options)
