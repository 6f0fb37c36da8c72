"""How success falls with density: one hierarchical psychometric fit a planner and robot, over all its cells.

In a cell, a kind of world with a crowd, the chance of success among x people per 100 m2 is

    p(x) = (1 - lapse) / (1 + (x / half)^slope),    p(0) = 1 - lapse,

logistic in log x with a lapse rate (Wichmann and Hill 2001), the slope common to all cells. The fit is the maximum a
posteriori under priors that say little (PRIOR). The breaking density of .9 is where p itself, not p without its lapses,
comes down to .9.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Prior:
    """Means and standard deviations: of the log of the slope, of the middle of all cells' log halves, of a cell's own
    about it; and of lapses, a beta distribution.
    """

    slope: tuple[float, float] = (math.log(2.0), 0.7)
    middle: tuple[float, float] = (math.log(8.0), 1.5)
    spread: float = 1.0
    lapse: tuple[float, float] = (1.0, 15.0)


PRIOR = Prior()
WALK, SETTLED = 300, 120  # steps of a walk, and those before it is where the posterior has it
KEPT = 30  # steps between two draws of a walk


@dataclass(frozen=True, slots=True, eq=False)
class Counts:
    """What was driven: of each (cell, rung) the density, people per 100 m2, episodes and successes, (C, R)."""

    densities: FloatArray
    episodes: FloatArray
    successes: FloatArray

    @property
    def cells(self) -> int:
        """Return the number of cells."""
        return len(self.densities)


@dataclass(frozen=True, slots=True, eq=False)
class Fit:
    """A fit: the vector of parameters (log slope, middle, C log halves, C logits of lapses)."""

    theta: FloatArray

    @property
    def cells(self) -> int:
        """Return the number of cells."""
        return (len(self.theta) - 2) // 2

    @property
    def slope(self) -> float:
        """Return the common slope."""
        return float(np.exp(self.theta[0]))

    @property
    def halves(self) -> FloatArray:
        """Return the density of each cell where half of what is not lapses succeeds, (C,)."""
        found: FloatArray = np.exp(self.theta[2 : 2 + self.cells])
        return found

    @property
    def lapses(self) -> FloatArray:
        """Return the lapse rate of each cell, (C,)."""
        found: FloatArray = 1.0 / (1.0 + np.exp(-self.theta[2 + self.cells :]))
        return found

    def success(self, cell: int, densities: FloatArray) -> FloatArray:
        """Return the chance of success in a cell at some densities."""
        half, kept = self.halves[cell], 1.0 - self.lapses[cell]
        found: FloatArray = kept / (1.0 + (np.asarray(densities, dtype=np.float64) / half) ** self.slope)
        return found

    def log_breaking(self, share: float) -> FloatArray:
        """Return the log density at which each cell's success is ``share``, (C,); -inf where it never is so high."""
        wanted = share / (1.0 - self.lapses)
        with np.errstate(divide="ignore", invalid="ignore"):
            odds = np.log(np.where(wanted < 1.0, (1.0 - wanted) / wanted, 0.0))
        found: FloatArray = self.theta[2 : 2 + self.cells] + odds / self.slope
        return found


def fit_counts(counts: Counts, prior: Prior = PRIOR, start: Fit | None = None) -> Fit:
    """Return the maximum a posteriori; ``start`` is a fit of nearly the same counts, from which it is near."""
    from scipy.optimize import minimize

    first = start.theta if start is not None else _first_guess(counts.cells, prior)
    found = minimize(_loss_and_slope, first, args=(counts, prior), jac=True, method="BFGS", options={"gtol": 1e-6})
    return Fit(np.asarray(found.x, dtype=np.float64))


def covariance(fit: Fit, counts: Counts, prior: Prior = PRIOR) -> FloatArray:
    """Return Laplace's covariance of the parameters: the inverse of the curvature at the maximum."""
    step = 1e-4
    curved = np.empty((len(fit.theta), len(fit.theta)))
    for i, unit in enumerate(np.eye(len(fit.theta)) * step):
        above, below = (_loss_and_slope(fit.theta + sign * unit, counts, prior)[1] for sign in (1.0, -1.0))
        curved[i] = (above - below) / (2.0 * step)
    found: FloatArray = np.linalg.inv(0.5 * (curved + curved.T)).astype(np.float64)
    return found


def posterior_draws(fit: Fit, counts: Counts, walks: int, random: np.random.Generator) -> FloatArray:
    """Return draws of the parameters from the posterior, (N, K): where Metropolis walks are from time to time.

    Walks begin where Laplace's normal has them, and step as Roberts, Gelman and Gilks (1997) advise. Where next to
    nothing failed that normal is too wide by far, for the posterior of a lapse is skewed.
    """
    shape = covariance(fit, counts)
    places = random.multivariate_normal(fit.theta, shape, walks)
    heights = -_losses(places, counts, PRIOR)
    variances, axes = np.linalg.eigh(shape)  # a curvature by differences may be a digit off, which Cholesky's refuses
    root = axes * np.sqrt(np.maximum(variances, 0.0)) * (2.38 / math.sqrt(len(fit.theta)))
    kept = []
    for step in range(1, WALK + 1):
        tried = places + random.standard_normal(places.shape) @ root.T
        found = -_losses(tried, counts, PRIOR)
        taken = np.log(random.random(walks)) < found - heights
        places[taken], heights[taken] = tried[taken], found[taken]
        if step > SETTLED and step % KEPT == 0:
            kept.append(places.copy())
    return np.concatenate(kept)


def breaking_slope(fit: Fit, cell: int, share: float) -> FloatArray:
    """Return how the log breaking density of a cell changes with the parameters; zeros where there is none."""
    step, found = 1e-5, np.zeros(len(fit.theta))
    for i in (0, 2 + cell, 2 + fit.cells + cell):
        unit = np.zeros(len(fit.theta))
        unit[i] = step
        ends = [Fit(fit.theta + sign * unit).log_breaking(share)[cell] for sign in (1.0, -1.0)]
        found[i] = (ends[0] - ends[1]) / (2.0 * step) if all(map(math.isfinite, ends)) else 0.0
    return found


def chance_slope(fit: Fit, cell: int, density: float) -> tuple[float, FloatArray]:
    """Return the chance of success at a density, and how it changes with the parameters."""
    p, by_slope, by_half, by_lapse = _chances(fit.theta, np.array([[density]]), [cell])
    found = np.zeros(len(fit.theta))
    found[0], found[2 + cell], found[2 + fit.cells + cell] = by_slope[0, 0], by_half[0, 0], by_lapse[0, 0]
    return float(p[0, 0]), found


def _first_guess(cells: int, prior: Prior) -> FloatArray:
    lapse = prior.lapse[0] / sum(prior.lapse)
    return np.concatenate(
        ([prior.slope[0], prior.middle[0]], np.full(cells, prior.middle[0]), np.full(cells, math.log(lapse)))
    )


def _chances(
    theta: FloatArray, densities: FloatArray, cells: Sequence[int]
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Return success at densities (C, R) of some cells, and its derivatives by log slope, log half, logit of lapse."""
    count = (len(theta) - 2) // 2
    slope, half = math.exp(theta[0]), theta[2 : 2 + count][cells][:, None]
    lapse = 1.0 / (1.0 + np.exp(-theta[2 + count :][cells][:, None]))
    there = densities > 0.0
    off = np.where(there, np.log(np.where(there, densities, 1.0)) - half, 0.0)
    kept = np.where(there, 1.0 / (1.0 + np.exp(np.clip(slope * off, -500.0, 500.0))), 1.0)
    steep = np.where(there, (1.0 - lapse) * kept * (1.0 - kept) * slope, 0.0)
    return (1.0 - lapse) * kept, -steep * off, steep, -lapse * (1.0 - lapse) * kept


def _loss_and_slope(theta: FloatArray, counts: Counts, prior: Prior) -> tuple[float, FloatArray]:
    """Return the negative log posterior and its gradient."""
    n = counts.cells
    p, by_slope, by_half, by_lapse = _chances(theta, counts.densities, range(n))
    p = np.clip(p, 1e-12, 1.0 - 1e-12)
    failed = counts.episodes - counts.successes
    loss = -float((counts.successes * np.log(p) + failed * np.log1p(-p)).sum())
    pull = failed / (1.0 - p) - counts.successes / p
    found = np.zeros(len(theta))
    found[0], found[2 : 2 + n] = (pull * by_slope).sum(), (pull * by_half).sum(axis=1)
    found[2 + n :] = (pull * by_lapse).sum(axis=1)
    return loss + _add_prior(theta, n, prior, found), found


def _losses(thetas: FloatArray, counts: Counts, prior: Prior) -> FloatArray:
    """Return the negative log posterior of many parameters (D, K), (D,)."""
    n = counts.cells
    slope, middle, halves, logits = np.exp(thetas[:, :1]), thetas[:, 1:2], thetas[:, 2 : 2 + n], thetas[:, 2 + n :]
    there = counts.densities > 0.0
    logs = np.where(there, np.log(np.where(there, counts.densities, 1.0)), -np.inf)
    with np.errstate(over="ignore"):
        odds = np.exp(np.clip(slope[:, :, None] * (logs - halves[:, :, None]), -500.0, 500.0))
    p = np.clip(1.0 / ((1.0 + np.exp(logits))[:, :, None] * (1.0 + np.where(there, odds, 0.0))), 1e-12, 1.0 - 1e-12)
    told = counts.successes * np.log(p) + (counts.episodes - counts.successes) * np.log1p(-p)
    steep, own = (thetas[:, 0] - prior.slope[0]) / prior.slope[1], (halves - middle) / prior.spread
    away = (thetas[:, 1] - prior.middle[0]) / prior.middle[1]
    lapses = prior.lapse[0] * np.logaddexp(0.0, -logits) + prior.lapse[1] * np.logaddexp(0.0, logits)
    found: FloatArray = 0.5 * (steep**2 + away**2 + (own**2).sum(axis=1)) + lapses.sum(axis=1) - told.sum(axis=(1, 2))
    return found


def _add_prior(theta: FloatArray, cells: int, prior: Prior, slope: FloatArray) -> float:
    """Add the prior's gradient to ``slope`` and return its negative log density."""
    steep, middle = ((theta[i] - mean) / deviation for i, (mean, deviation) in enumerate((prior.slope, prior.middle)))
    own = (theta[2 : 2 + cells] - theta[1]) / prior.spread
    logits = theta[2 + cells :]
    a, b = prior.lapse
    lapse = 1.0 / (1.0 + np.exp(-logits))
    slope[0] += steep / prior.slope[1]
    slope[1] += middle / prior.middle[1] - own.sum() / prior.spread
    slope[2 : 2 + cells] += own / prior.spread
    slope[2 + cells :] += -a * (1.0 - lapse) + b * lapse
    lapses = (a * np.logaddexp(0.0, -logits) + b * np.logaddexp(0.0, logits)).sum()
    return float(0.5 * (steep**2 + middle**2 + (own**2).sum()) + lapses)
