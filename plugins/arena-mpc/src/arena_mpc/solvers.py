"""The solvers that a control step may try in turn, each within what is left of the step's iterations."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Protocol

from arena_core import ConfigurationError
from arena_mpc.arrays import FloatArray
from arena_mpc.parameters import SolverSettings
from arena_mpc.plan import Plan, Room, Solution
from arena_mpc.shooting import solve_shooting
from arena_mpc.terms import Terms

if TYPE_CHECKING:
    from arena_mpc.problem import Shape


class Solver(Protocol):
    """Finds a plan near a guess."""

    def prepare(self, stages: int) -> None:
        """Build whatever problems of so many intervals need."""
        ...

    def solve(self, terms: Terms, state: FloatArray, guess: Plan, room: Room, left: int) -> Solution | None:
        """Return a solution of at most ``left`` iterations, None when it could take more."""
        ...


class Shooting:
    """Iterative linear-quadratic optimisation: whatever is left of the iterations gives a plan."""

    def __init__(self, settings: SolverSettings) -> None:
        self._settings = settings

    def prepare(self, stages: int) -> None:
        """Do nothing: one kernel serves all sizes."""

    def solve(self, terms: Terms, state: FloatArray, guess: Plan, room: Room, left: int) -> Solution | None:
        """Return what the iterations make of the guess."""
        iterations = min(left, self._settings.solution_iterations)
        return (
            solve_shooting(terms, state, guess, room, iterations, self._settings.tolerance) if iterations > 0 else None
        )


class InteriorPoint:
    """An interior-point method of casadi, which gives a plan at its end or none."""

    def __init__(self, settings: SolverSettings, shape_of: Callable[[int], Shape]) -> None:
        self._settings, self._shape_of = settings, shape_of

    def prepare(self, stages: int) -> None:
        """Build the problem of this size."""
        from arena_mpc.interior_point import compiled_problem

        compiled_problem(self._shape_of(stages), self._settings)

    def solve(self, terms: Terms, state: FloatArray, guess: Plan, room: Room, left: int) -> Solution | None:
        """Return the optimal plan near the guess."""
        from arena_mpc.interior_point import compiled_problem

        if left < self._settings.solution_iterations:
            return None
        found = compiled_problem(self._shape_of(len(guess.states) - 1), self._settings).solve(terms, state, guess, room)
        return found._replace(iterations=min(found.iterations, self._settings.solution_iterations))


def solvers_of(wanted: SolverSettings, constrained: str, shape_of: Callable[[int], Shape]) -> tuple[Solver, ...]:
    """Return the solvers to try in turn; behind fatrop stands ipopt, which takes its place where casadi lacks it.

    Raises ConfigurationError where shooting, which prices everything, is asked to hold constraints.
    """
    if wanted.name == "shooting" and constrained:
        raise ConfigurationError(f"mpc: solver.name is shooting; allowed with {constrained}: fatrop, ipopt")
    if wanted.name == "shooting":
        return (Shooting(wanted),)
    from arena_mpc.interior_point import has_solver

    ipopt = SolverSettings("ipopt", wanted.max_iterations, wanted.solution_iterations, wanted.tolerance)
    names = (wanted, ipopt) if wanted.name != "ipopt" and has_solver(wanted.name) else (ipopt,)
    return tuple(InteriorPoint(settings, shape_of) for settings in names)
