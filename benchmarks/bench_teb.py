"""Speed of the timed elastic band: 40 poses among 10 moving obstacles, against scipy's sparse
least squares on the same residuals.
"""

from __future__ import annotations

import math
from functools import partial
from typing import Any

import numpy as np
from scipy.optimize import least_squares
from scipy.sparse import csr_matrix
from timing import interleave

from arena_kernels.costmap_window import CostmapWindow
from arena_kernels.distance import distance_field
from arena_kernels.foreseen import Foreseen
from arena_teb.association import Reach
from arena_teb.optimisation import Effort, Model, optimise_band
from arena_teb.polygons import NO_HULLS
from arena_teb.problem import REACH, BandTerms, Ends, Penalties, Shape, Surroundings
from arena_teb.resize import Sampling, resize_band
from arena_teb.solver import solve_band
from arena_teb.surroundings import Scene, Vicinity, find_surroundings
from arena_teb.terms import evaluate_terms, make_rows

EFFORT = Effort(12, 4, 0.002, 2.0)  # the preset's
ENOUGH = 100, 1e-4  # iterations and tolerance of the single solution
CALLS = 10  # a timing
SHAPE = Shape(np.zeros((1, 2)), 0.15, 0.15)
ENDS = Ends(np.array((0.2, 0.0, 0.0)), np.zeros(3), 0.0, 1.0, 0.0)
PENALTIES = Penalties(
    speed_min=np.array((-0.2, 0.0, -1.0)),
    speed_max=np.array((0.3, 0.0, 1.0)),
    acceleration=np.array((0.5, 0.5, 0.5)),
    root_speed=np.sqrt((50.0, 0.0, 10.0)),
    root_acceleration=np.array((1.0, 0.0, 1.0)),
    root_nonholonomic=math.sqrt(1000.0),
    root_forward=math.sqrt(10.0),
    root_turn_radius=0.0,
    root_time=1.0,
    root_path=0.0,
    root_obstacle=math.sqrt(50.0),
    root_inflation=math.sqrt(0.2),
    root_dynamic=math.sqrt(50.0),
    root_dynamic_inflation=math.sqrt(0.2),
    root_via=0.0,
    root_rotation=0.0,
    turn_radius=0.0,
    near=0.15,
    inflated=0.4,
    dynamic_near=0.3,
    dynamic_inflated=0.6,
    exponent=1.0,
    unit=0.15,
)
MODEL = Model(PENALTIES, SHAPE, Sampling(0.3, 0.1, 3, 80, math.inf), Vicinity(Reach(0.6, 0.0), 1.0, 0.2, 0.5), EFFORT)


def make_scene() -> tuple[np.ndarray, Scene]:
    """Return a band of 40 poses on a straight line, and walls and people about it."""
    lethal = np.zeros((120, 120), np.bool_)
    lethal[45:50, 50:60] = lethal[66:72, 80:90] = lethal[40:46, 100:110] = True
    window = CostmapWindow(np.where(lethal, 254, 0).astype(np.uint8), distance_field(lethal, 0.05), 0.05, -2.0, -3.0)
    random = np.random.default_rng(2)
    positions, velocities = random.uniform((0.5, -1.5), (3.5, 1.5), (10, 2)), random.uniform(-0.3, 0.3, (10, 2))
    band = np.zeros((40, 4))
    band[:, 0], band[:, 3] = np.linspace(0.0, 3.5, 40), 0.3
    foreseen = Foreseen.straight(positions, velocities)
    return band, Scene(window, NO_HULLS, foreseen, np.full(10, 0.25), math.inf, np.empty((0, 2)))


def optimise_whole_band(band: np.ndarray, around: Scene) -> None:
    """Optimise as the planner does, resizing and pairing included."""
    for _ in range(CALLS):
        optimise_band(band, around, MODEL, ENDS)


def our_solution(band: np.ndarray, around: Surroundings) -> float:
    """Solve one problem by the banded Levenberg-Marquardt."""
    for _ in range(CALLS):
        solved = band.copy()
        cost, _ = solve_band(solved, PENALTIES, SHAPE, ENDS, around, *ENOUGH)
    return cost


def scipy_solution(band: np.ndarray, around: Surroundings, cost: float) -> float:
    """Solve it by scipy's trust region with the same sparse Jacobian, up to the same cost; return the cost."""
    rows = make_rows(around)
    free = np.ones(band.shape, np.bool_)
    free[0, :3] = free[-1, [0, 1, 3]] = False
    lowest = np.tile((-np.inf, -np.inf, -np.inf, 1e-4), (len(band), 1))

    def at(values: np.ndarray) -> None:
        placed = band.copy()
        placed[free] = values
        evaluate_terms(placed, BandTerms(PENALTIES, rows), SHAPE, ENDS, around)

    def residuals(values: np.ndarray) -> np.ndarray:
        at(values)
        found = np.zeros(len(rows.residual))
        found[rows.term[: rows.used[0]]] = rows.residual[: rows.used[0]]
        return found

    def jacobian(values: np.ndarray) -> csr_matrix:
        at(values)
        row, column = np.nonzero(np.arange(REACH) < rows.width[: rows.used[0], None])
        entries = rows.jacobian[row, column], (rows.term[row], rows.first[row] + column)
        return csr_matrix(entries, shape=(len(rows.width), band.size))[:, free.ravel()]

    def enough(intermediate_result: Any) -> None:
        if intermediate_result.cost <= 1.02 * cost:
            raise StopIteration

    start, bounds = band[free], (lowest[free], np.inf)
    found = least_squares(residuals, start, jacobian, bounds=bounds, x_scale="jac", max_nfev=200, callback=enough)
    return float(found.cost)


def measure() -> list[dict[str, Any]]:
    """Return the median user CPU time of a whole optimisation, and of one solution with its peer at equal cost."""
    band, here = make_scene()
    sampled = resize_band(band, MODEL.sampling)
    around = find_surroundings(sampled, here, MODEL.vicinity)
    cost = our_solution(sampled, around)
    theirs = scipy_solution(sampled, around, cost)
    functions = {
        "whole": partial(optimise_whole_band, band, here),
        "ours": partial(our_solution, sampled, around),
        "scipy": partial(scipy_solution, sampled, around, cost),
    }
    times = interleave(functions, repeats=9)
    ms = {name: float(np.median(seconds)) * 1e3 / (1 if name == "scipy" else CALLS) for name, seconds in times.items()}
    at_most = "TEB optimisation, 40 poses, 10 moving obstacles, 4 x 12 iterations, at most"
    solution = f"TEB solution, the same, cost {cost:.2f} (scipy {theirs:.2f})"
    peer = "scipy least_squares, sparse"
    return [
        {
            "what": at_most,
            "ours_ms": ms["whole"],
            "peer": None,
            "peer_ms": None,
            "ratio": None,
            "goal": 3.0,
            "unit": "ms",
        },
        {
            "what": solution,
            "ours_ms": ms["ours"],
            "peer": peer,
            "peer_ms": ms["scipy"],
            "ratio": ms["ours"] / ms["scipy"],
            "goal": 1.0 / 40.0,
            "unit": "x peer",
        },
    ]
