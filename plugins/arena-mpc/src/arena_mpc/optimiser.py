"""Turns a scene, a reference and an initial guess into a plan: outer iterations of obstacle
association and optimisation.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from arena_mpc.arrays import FloatArray
from arena_mpc.columns import HEADING_COUNTS, PLANE, STAGE_HEAD, THETA, VIA_X
from arena_mpc.corridor import half_planes, nearest_cells
from arena_mpc.footprint import Discs, place_discs
from arena_mpc.models import control_bounds, velocity_bounds
from arena_mpc.motion import NUMBER
from arena_mpc.moving import relevant_movers
from arena_mpc.objective import WEIGHTS
from arena_mpc.parameters import Drive, Form, Grid, ModelName, Obstacles, SolverSettings, Weights
from arena_mpc.plan import Plan, Room, Solution
from arena_mpc.reference import Reference, nearest_path_points, nearest_stages
from arena_mpc.resizing import reachable_sizes
from arena_mpc.scene import Scene
from arena_mpc.solvers import Solver, solvers_of
from arena_mpc.terms import Terms

if TYPE_CHECKING:
    from arena_mpc.problem import Shape

FEW = 8  # problems, built within half a second


class Optimiser:
    """Solves the controller's problem for one robot; what it compiles outlives it."""

    def __init__(
        self,
        model: ModelName,
        form: Form,
        drive: Drive,
        discs: Discs,
        fixed_end: bool,
        grid: Grid,
        weights: Weights,
        obstacles: Obstacles,
        solver: SolverSettings,
    ) -> None:
        self._model, self._form, self._discs, self._grid, self._obstacles = model, form, discs, grid, obstacles
        self._fixed_end = fixed_end
        self._wheelbase = drive.wheelbase or 1.0
        self._weights = np.array([getattr(weights, name) for name in WEIGHTS])
        turn = drive.wz_max if model == "bicycle" else 1.0
        self._room = Room(
            *velocity_bounds(model, drive), control_bounds(model, drive)[1], grid.step_min, grid.step_max, turn
        )
        self._solvers: tuple[Solver, ...] = solvers_of(
            solver, _constraint_names(obstacles, fixed_end), self._problem_shape
        )

    def prepare(self) -> None:
        """Build the problems that resizing may ask for, unless they are many, so that no later
        control step waits for them.
        """
        sizes = reachable_sizes(self._grid) if self._form == "minimum_time" else {self._grid.stages}
        if len(sizes) <= FEW:
            for stages in sorted(sizes):
                self._solvers[0].prepare(stages)

    def optimise(self, scene: Scene, reference: Reference, state: FloatArray, guess: Plan, left: int) -> Solution:
        """Return the optimal plan from ``state`` near ``guess``, None when no solver finds one
        within ``left`` iterations.
        """
        used = 0
        for solver in self._solvers:
            best = Solution(None, math.inf, 0)
            for _ in range(self._grid.outer_iterations):
                beginning = guess if best.plan is None else best.plan
                found = solver.solve(
                    self._problem_terms(scene, reference, beginning), state, beginning, self._room, left - used
                )
                if found is None:
                    break
                best, used = found, used + found.iterations
                if found.plan is None:
                    break
            if best.plan is not None:
                return best._replace(iterations=used)
        return Solution(None, math.inf, used)

    def _problem_shape(self, stages: int) -> Shape:
        from arena_mpc.problem import Shape

        obstacles = self._obstacles
        sizes = (len(self._discs.centres_xy), obstacles.planes, obstacles.moving)
        return Shape(
            self._model, self._form, stages, *sizes, obstacles.association == "cells", obstacles.hard, self._fixed_end
        )

    def _problem_terms(self, scene: Scene, reference: Reference, guess: Plan) -> Terms:
        """Return the numbers of the problem in the neighbourhood of a guess."""
        obstacles = self._obstacles
        distance = self._discs.radius + obstacles.moving_distance
        return Terms(
            model=NUMBER[self._model],
            timed=self._form == "minimum_time",
            wheelbase=self._wheelbase,
            step=self._grid.step,
            growth=obstacles.moving_growth,
            speed_distance=obstacles.speed_distance,
            goal_heading=float(not reference.final),
            goal=_unwrap_heading(reference.goal, guess.states[-1, THETA]),
            weights=self._weights,
            discs_xy=self._discs.centres_xy,
            movers=relevant_movers(scene, guess.states[:, :2], guess.step, distance, obstacles.moving),
            rows=self._stage_rows(scene, reference, guess.states),
        )

    def _stage_rows(self, scene: Scene, reference: Reference, states: FloatArray) -> FloatArray:
        """Return the path beside each stage of the guess, its via point, and the obstacles round it."""
        count, obstacles = len(states), self._obstacles
        rows = np.zeros((count, STAGE_HEAD + PLANE * len(self._discs.centres_xy) * obstacles.planes))
        rows[:, :HEADING_COUNTS] = nearest_path_points(reference.path, states[:, :2])
        rows[:, HEADING_COUNTS] = 1.0
        rows[:, VIA_X:STAGE_HEAD] = nearest_stages(reference.via_points, states[:, :2])
        rows[:, STAGE_HEAD:] = self._stage_obstacles(scene, states).reshape(count, -1)
        return rows

    def _stage_obstacles(self, scene: Scene, states: FloatArray) -> FloatArray:
        """Return the half-planes or cells round every stage and disc."""
        obstacles, centres = self._obstacles, place_discs(self._discs, states).reshape(-1, 2)
        radius, wanted = self._discs.radius, obstacles.min_distance
        if obstacles.association == "half_planes":
            return half_planes(scene.window, scene.cells, centres, radius, wanted, obstacles.cutoff, obstacles.planes)
        headings = np.repeat(states[:, THETA], len(self._discs.centres_xy))
        return nearest_cells(
            scene.cells,
            centres,
            headings,
            radius + wanted,
            obstacles.forced_inclusion,
            obstacles.cutoff,
            obstacles.planes,
        )


def _unwrap_heading(goal: FloatArray, heading: float) -> FloatArray:
    """Return a goal (3,) whose heading is counted on from ``heading``, rad."""
    turned = goal.copy()
    turned[THETA] += 2.0 * np.pi * round((heading - goal[THETA]) / (2.0 * np.pi))
    return turned


def _constraint_names(obstacles: Obstacles, fixed_end: bool) -> str:
    """Return which settings only an interior-point method can hold, as an error names them;
    empty when there are none.
    """
    asked = {"obstacles.hard=true": obstacles.hard, "obstacles.association=cells": obstacles.association == "cells"}
    asked["final_state_fixed=true"] = fixed_end
    return ", ".join(name for name, wanted in asked.items() if wanted)
