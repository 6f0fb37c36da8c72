"""Compiled problems, kept for the life of the process, and their solution by an interior-point method."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any, NamedTuple

import casadi as ca
import numpy as np

from arena_mpc.arrays import FloatArray
from arena_mpc.parameters import SolverSettings
from arena_mpc.problem import Problem, Shape, formulate

FEASIBLE = 1e-3  # m, rad, m/s: greatest gap between intervals of a plan that can be driven
BARRIER = 0.1  # at which the interior-point method begins: warm enough for a shifted plan, free enough for a new one


class Plan(NamedTuple):
    """A solution: ``states`` (N + 1, 3 + velocities), the intervals' length ``step`` s, ``slack`` (N + 1,) m."""

    states: FloatArray
    step: float
    slack: FloatArray

    @property
    def duration(self) -> float:
        """Return how long the plan takes, s."""
        return (len(self.states) - 1) * self.step


@dataclass(frozen=True, slots=True, eq=False)
class Bounds:
    """Least and greatest velocities and controls, and of the intervals' length (s)."""

    velocities: tuple[FloatArray, FloatArray]
    controls: tuple[FloatArray, FloatArray]
    step: tuple[float, float]
    turn: float


class CompiledProblem:
    """One problem, built once; solve it with other numbers as often as needed."""

    def __init__(self, shape: Shape, settings: SolverSettings) -> None:
        problem = formulate(shape)
        self.shape = shape
        self._lower, self._upper = problem.lower, problem.upper
        self._equality = np.array(problem.equality)
        self._solve = _interior_point(problem, settings)

    def solve(self, parameters: FloatArray, guess: Plan, bounds: Bounds) -> Plan | None:
        """Return the optimal plan from an initial guess, None when no plan was found that the robot could drive."""
        low, high = self._variable_bounds(bounds)
        turns = np.abs(self._upper) == 1.0
        lower, upper = np.where(turns, -bounds.turn, self._lower), np.where(turns, bounds.turn, self._upper)
        found = self._solve(x0=self._packed(guess, bounds), p=parameters, lbx=low, ubx=high, lbg=lower, ubg=upper)
        values, rows = found["x"].full().ravel(), found["g"].full().ravel()
        if not np.isfinite(values).all():
            return None
        violation = np.maximum(lower - rows, rows - upper)
        if float(violation.max()) > FEASIBLE:
            return None
        return self._unpacked(values, guess.step)

    def _stride(self) -> int:
        return self.shape.states + self.shape.velocities + 1

    def _packed(self, plan: Plan, bounds: Bounds) -> FloatArray:
        shape = self.shape
        values = np.zeros((shape.stages + 1, self._stride()))
        values[:, : shape.pose_and_velocities] = plan.states
        if shape.form == "minimum_time":
            values[:, shape.states - 1] = plan.step
        steps = np.diff(plan.states[:, 3:], axis=0) / plan.step
        values[:-1, shape.states : -1] = np.clip(steps, *bounds.controls)
        values[:, -1] = plan.slack
        return self._without_last_controls(values)

    def _variable_bounds(self, bounds: Bounds) -> tuple[FloatArray, FloatArray]:
        sides = []
        for side, sign in ((0, -1.0), (1, 1.0)):
            values = np.full((self.shape.stages + 1, self._stride()), sign * np.inf)
            values[1:, 3 : self.shape.pose_and_velocities] = bounds.velocities[side]
            if self.shape.form == "minimum_time":
                values[:, self.shape.states - 1] = bounds.step[side]
            values[:-1, self.shape.states : -1] = bounds.controls[side]
            values[:, -1] = 0.0 if side == 0 else np.inf
            sides.append(self._without_last_controls(values))
        return sides[0], sides[1]

    def _without_last_controls(self, values: FloatArray) -> FloatArray:
        """Flatten rows of state, controls, slack; the last stage has no controls but slack."""
        flat = values.ravel()
        return np.concatenate((flat[: -1 - self.shape.velocities], flat[-1:]))

    def _unpacked(self, values: FloatArray, step: float) -> Plan:
        shape = self.shape
        whole = np.concatenate((values[:-1], np.zeros(shape.velocities), values[-1:])).reshape(shape.stages + 1, -1)
        if shape.form == "minimum_time":
            step = float(whole[0, shape.states - 1])
        return Plan(whole[:, : shape.pose_and_velocities].copy(), step, whole[:, -1].copy())


@lru_cache(maxsize=40)
def compiled_problem(shape: Shape, settings: SolverSettings) -> CompiledProblem:
    """Return the problem of this shape, built at the first request of the process."""
    return CompiledProblem(shape, settings)


def available(name: str) -> bool:
    """Tell whether casadi was built with a solver."""
    return bool(ca.has_nlpsol(name))


def _interior_point(problem: Problem, settings: SolverSettings) -> Any:
    """Build a quiet solver that is bounded by iterations, never by time."""
    common = {"max_iter": settings.max_iterations, "tol": settings.tolerance, "mu_init": BARRIER, "print_level": 0}
    options: dict[str, Any] = {"print_time": False, "error_on_fail": False}
    if settings.name == "fatrop":
        options |= {"structure_detection": "auto", "equality": problem.equality, "fatrop": common}
    else:
        options |= {"ipopt": {**common, "sb": "yes"}}
    return ca.nlpsol("mpc", settings.name, problem.nlp, options)
