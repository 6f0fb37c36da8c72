"""The outer loop of the timed elastic band: resize, pair with obstacles, solve, and weigh obstacles more."""

from __future__ import annotations

from typing import NamedTuple

from arena_kernels.compiled import compiled
from arena_teb.problem import BandTerms, Ends, FloatArray, Penalties, Shape, Surroundings
from arena_teb.resize import Sampling, resize_band
from arena_teb.solver import solve_band
from arena_teb.surroundings import Scene, Vicinity, find_surroundings
from arena_teb.terms import evaluate_terms, make_rows


class Effort(NamedTuple):
    """How much is done: iterations, the gain (share of the cost) below which an inner loop ends, and by which factor
    obstacles weigh more from one outer iteration to the next."""

    inner: int
    outer: int
    tolerance: float
    adaptation: float


class Model(NamedTuple):
    """All that does not change from step to step."""

    penalties: Penalties
    shape: Shape
    sampling: Sampling
    vicinity: Vicinity
    effort: Effort


@compiled
def optimise_band(
    band: FloatArray, scene: Scene, model: Model, ends: Ends
) -> tuple[FloatArray, Surroundings, Penalties]:
    """Return the optimised band (M, 4), with the surroundings and penalties of its
    last solution (RAS 2017, algorithm 1).
    """
    band, around, penalties = improve_band(band, scene, model, ends, 1.0)
    for outer in range(1, model.effort.outer):
        band, around, penalties = improve_band(band, scene, model, ends, model.effort.adaptation**outer)
    return band, around, penalties


@compiled
def improve_band(
    band: FloatArray, scene: Scene, model: Model, ends: Ends, factor: float
) -> tuple[FloatArray, Surroundings, Penalties]:
    """Return a band after one outer iteration in which static obstacles weigh ``factor`` times
    as much, and what it was solved with.
    """
    band = resize_band(band, model.sampling)
    around = find_surroundings(band, scene, model.vicinity, model.shape)
    penalties = scale_penalties(model.penalties, factor)
    solve_band(band, penalties, model.shape, ends, around, model.effort.inner, model.effort.tolerance)
    return band, around, penalties


@compiled
def scale_penalties(penalties: Penalties, factor: float) -> Penalties:
    """Return penalties whose weight of static obstacles is ``factor`` times as great."""
    p = penalties
    return Penalties(
        p.speed_min,
        p.speed_max,
        p.acceleration,
        p.root_speed,
        p.root_acceleration,
        p.root_nonholonomic,
        p.root_forward,
        p.root_turn_radius,
        p.root_time,
        p.root_path,
        p.root_obstacle * factor**0.5,
        p.root_inflation,
        p.root_dynamic,
        p.root_dynamic_inflation,
        p.root_via,
        p.root_rotation,
        p.turn_radius,
        p.near,
        p.inflated,
        p.dynamic_near,
        p.dynamic_inflated,
        p.exponent,
        p.unit,
    )


@compiled
def band_cost(band: FloatArray, scene: Scene, penalties: Penalties, model: Model, ends: Ends) -> float:
    """Return the cost of a band by which topologies are compared."""
    around = find_surroundings(band, scene, model.vicinity, model.shape)
    rows = make_rows(around)
    return evaluate_terms(band, BandTerms(penalties, rows), model.shape, ends, around)
