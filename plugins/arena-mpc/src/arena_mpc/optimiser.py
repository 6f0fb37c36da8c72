"""Turns a scene, a reference and an initial guess into a plan: outer iterations of obstacle association and optimisation."""

from __future__ import annotations

import numpy as np

from arena_mpc.arrays import FloatArray
from arena_mpc.corridor import half_planes
from arena_mpc.footprint import Discs, placed
from arena_mpc.models import control_bounds, velocity_bounds
from arena_mpc.moving import relevant_movers
from arena_mpc.parameters import Drive, Form, Grid, ModelName, Obstacles, SolverSettings, Weights
from arena_mpc.problem import PLANE, STAGE_HEAD, WEIGHTS, Shape
from arena_mpc.reference import Reference, beside
from arena_mpc.resizing import reachable_sizes
from arena_mpc.scene import Scene
from arena_mpc.solver import Bounds, Plan, available, compiled_problem

FEW = 8  # problems, built within half a second


class Optimiser:
    """Solves the controller's problem for one robot; what it compiles outlives it."""

    def __init__(
        self,
        model: ModelName,
        form: Form,
        drive: Drive,
        discs: Discs,
        grid: Grid,
        weights: Weights,
        obstacles: Obstacles,
        solver: SolverSettings,
    ) -> None:
        self._model, self._form, self._discs, self._grid, self._obstacles = model, form, discs, grid, obstacles
        self._wheelbase = drive.wheelbase or 1.0
        self._weights = np.array([getattr(weights, name) for name in WEIGHTS])
        turn = drive.wz_max if model == "bicycle" else 1.0
        self._bounds = Bounds(velocity_bounds(model, drive), control_bounds(model, drive), (grid.step_min, grid.step_max), turn)
        self._solvers = _solvers(solver)

    def prepare(self) -> None:
        """Build the problems that resizing may ask for, unless they are many, so that no later control step waits for them."""
        sizes = reachable_sizes(self._grid) if self._form == "minimum_time" else {self._grid.stages}
        if len(sizes) <= FEW:
            for stages in sorted(sizes):
                compiled_problem(self._shape(stages), self._solvers[0])

    def optimise(self, scene: Scene, reference: Reference, state: FloatArray, guess: Plan) -> Plan | None:
        """Return the optimal plan from ``state`` in the neighbourhood of ``guess``, None when no solver finds one."""
        for settings in self._solvers:
            plan: Plan | None = guess
            for _ in range(self._grid.outer_iterations):
                if plan is not None:
                    plan = self._solved(scene, reference, state, plan, settings)
            if plan is not None:
                return plan
        return None

    def _solved(self, scene: Scene, reference: Reference, state: FloatArray, guess: Plan, settings: SolverSettings) -> Plan | None:
        shape = self._shape(len(guess.states) - 1)
        return compiled_problem(shape, settings).solve(self._parameters(scene, reference, state, guess), guess, self._bounds)

    def _shape(self, stages: int) -> Shape:
        return Shape(self._model, self._form, stages, len(self._discs.centres_xy), self._obstacles.planes, self._obstacles.moving)

    def _parameters(self, scene: Scene, reference: Reference, state: FloatArray, guess: Plan) -> FloatArray:
        """Return the problem's parameters in the order of ``problem.Head``, then the stages' rows."""
        movers = relevant_movers(
            scene.tracks, guess.states[:, :2], guess.step, self._discs.radius + self._obstacles.moving_distance, self._obstacles.moving
        )
        fixed = (
            float(not reference.final),
            self._grid.step,
            self._wheelbase,
            self._obstacles.moving_growth,
            self._obstacles.speed_distance,
        )
        rows = self._stage_rows(scene, reference, guess.states)
        parts = (state, reference.goal, fixed, self._weights, self._discs.centres_xy.ravel(), movers.ravel(), rows.ravel())
        return np.concatenate(parts)

    def _stage_rows(self, scene: Scene, reference: Reference, states: FloatArray) -> FloatArray:
        """Return the path beside each stage of the guess, and the half-planes round it."""
        count, obstacles = len(states), self._obstacles
        rows = np.zeros((count, STAGE_HEAD + PLANE * len(self._discs.centres_xy) * obstacles.planes))
        rows[:, : STAGE_HEAD - 1] = beside(reference.path, states[:, :2])
        rows[:, STAGE_HEAD - 1] = 1.0
        centres = placed(self._discs, states).reshape(-1, 2)
        reach = self._discs.radius + obstacles.min_distance
        rows[:, STAGE_HEAD:] = half_planes(scene.window, scene.cells, centres, reach, obstacles.cutoff, obstacles.planes).reshape(count, -1)
        return rows


def _solvers(wanted: SolverSettings) -> tuple[SolverSettings, ...]:
    """Return the solvers to try in turn: the wanted one where casadi has it, then ipopt."""
    ipopt = SolverSettings("ipopt", wanted.max_iterations, wanted.tolerance)
    return (wanted, ipopt) if wanted.name != "ipopt" and available(wanted.name) else (ipopt,)
