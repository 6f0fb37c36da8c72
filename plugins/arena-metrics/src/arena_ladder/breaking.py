"""Breaking densities with their intervals: resamples of whole maps, which are what is independent.

A maximum a posteriori scatters less than the truth about it, because the prior and the other cells draw it in; so the
ends lie ``WIDER`` times as far off as the resamples' (calibrated: docs/results/ladder.md). Where a cell has next to no
failures, or successes, resamples are all alike although nothing is known: there the posterior's ends count, too.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from arena_core import random_generator
from arena_ladder.fitting import Counts, Fit, FloatArray, fit_counts, posterior_draws
from arena_ladder.plan import Plan

RESAMPLES = 200  # each is a fit; the ends of an interval are off by a twentieth of its width
WIDER = 1.15
WALKS = 400  # through the posterior
FEW = 5  # failures or successes among people, below which resamples say too little
TAIL = 0.025


@dataclass(frozen=True, slots=True)
class Drive:
    """One episode: its cell, its rung, its density, people per 100 m2, whose map, and how it ended."""

    cell: str
    rung: int
    density: float
    world_map: tuple[str, int, int]  # kind of world, seed, number
    success: bool
    strict: bool
    no_room: bool = False


@dataclass(frozen=True, slots=True)
class Breaking:
    """A breaking density with its 95 % interval, people per 100 m2, within the rungs ``least`` .. ``most``."""

    value: float
    low: float
    high: float
    least: float
    most: float

    @property
    def precise(self) -> float:
        """Return half of the interval as a share of the value: .2 is from 1 / 1.2 to 1.2 times as many."""
        return math.sqrt(self.high / self.low) - 1.0 if self.low > 0.0 else math.inf

    def text(self) -> str:
        """Return the value and its interval, "above 24" and "below 1" where they are beyond the rungs."""
        if self.low >= self.most or self.high <= self.least:
            return self._end(self.value)
        return f"{self._end(self.value)} ({self._end(self.low)} – {self._end(self.high)})"

    def _end(self, density: float) -> str:
        if density >= self.most:
            return f"above {self.most:g}"
        return f"below {self.least:g}" if density <= self.least else f"{density:.1f}"


@dataclass(frozen=True, slots=True, eq=False)
class Sample:
    """The episodes of a ladder as arrays, one line each: cell, rung, outcome, and the number of its map."""

    cells: NDArray[np.int64]
    rungs: NDArray[np.int64]
    won: FloatArray
    maps: NDArray[np.int64]
    strata: tuple[NDArray[np.int64], ...]  # numbers of the maps of each kind of world
    densities: FloatArray  # (C, R)

    def counts(self, weights: FloatArray) -> Counts:
        """Return what was driven where each map counts so often, (M,)."""
        shape = self.densities.shape
        place, each = self.cells * shape[1] + self.rungs, weights[self.maps]
        episodes, successes = (_sums(place, of, shape) for of in (each, each * self.won))
        return Counts(self.densities, episodes, successes)

    def resamples(self, number: int, key: str) -> FloatArray:
        """Return how often each of ``number`` resamples draws every map, (number, M); as many of each kind of world."""
        random = random_generator(len(self.won), "ladder", key)
        drawn = np.zeros((number, sum(map(len, self.strata))))
        for part in self.strata:
            drawn[:, part] = random.multinomial(len(part), np.full(len(part), 1.0 / len(part)), size=number)
        return drawn


def _sums(places: NDArray[np.int64], values: FloatArray, shape: tuple[int, ...]) -> FloatArray:
    size = int(np.prod(shape))
    return np.bincount(places, weights=values, minlength=size).astype(np.float64).reshape(shape)


def make_sample(plan: Plan, drives: Sequence[Drive], *, strict: bool = False) -> Sample:
    """Return the episodes that had room."""
    driven = [drive for drive in drives if not drive.no_room]
    maps: dict[tuple[str, int, int], int] = {}
    numbers = np.array([maps.setdefault(drive.world_map, len(maps)) for drive in driven], dtype=np.int64)
    kinds = dict.fromkeys(drive.world_map[0] for drive in driven)
    strata = tuple(np.array([i for name, i in maps.items() if name[0] == kind]) for kind in kinds)
    cells = np.array([plan.names.index(drive.cell) for drive in driven], dtype=np.int64)
    rungs = np.array([drive.rung for drive in driven], dtype=np.int64)
    won = np.array([drive.strict if strict else drive.success for drive in driven], dtype=np.float64)
    densities = np.tile(np.array(plan.rungs), (len(plan.names), 1))
    for c, r in set(zip(cells.tolist(), rungs.tolist(), strict=True)):
        there = (cells == c) & (rungs == r)
        densities[c, r] = np.mean([driven[i].density for i in np.flatnonzero(there)])
    return Sample(cells, rungs, won, numbers, strata, densities)


def resampled_fits(sample: Sample, fit: Fit, key: str) -> list[Fit]:
    """Return a fit to each resample of the maps."""
    return [fit_counts(sample.counts(weights), start=fit) for weights in sample.resamples(RESAMPLES, key)]


def find_breaking(plan: Plan, sample: Sample, shares: Sequence[float]) -> tuple[Fit, Mapping[float, list[Breaking]]]:
    """Return the fit, and of each share the breaking densities of all cells."""
    counts = sample.counts(np.ones(sum(map(len, sample.strata))))
    fit = fit_counts(counts)
    again = resampled_fits(sample, fit, "maps")
    random = random_generator(len(sample.won), "ladder", "posterior")
    drawn = [Fit(theta) for theta in posterior_draws(fit, counts, WALKS, random)]
    poor = _say_little(counts)
    return fit, {share: _intervals(plan, share, fit, again, (drawn, poor)) for share in shares}


def _say_little(counts: Counts) -> NDArray[np.bool_]:
    """Return which cells have next to no failures, or successes, among people, (C,)."""
    among = counts.densities > 0.0
    won = np.where(among, counts.successes, 0.0).sum(axis=1)
    lost = np.where(among, counts.episodes - counts.successes, 0.0).sum(axis=1)
    found: NDArray[np.bool_] = np.minimum(won, lost) < FEW
    return found


def ladder_ends(plan: Plan) -> tuple[float, float]:
    """Return the lowest rung with people and the highest one."""
    return min(rung for rung in plan.rungs if rung > 0.0), plan.rungs[-1]


def held_logs(plan: Plan, fits: Sequence[Fit], share: float) -> FloatArray:
    """Return the log breaking densities of fits, (F, C), held within the ends of the ladder."""
    least, most = ladder_ends(plan)
    found: FloatArray = np.clip([fit.log_breaking(share) for fit in fits], math.log(least), math.log(most))
    return found


def _intervals(
    plan: Plan, share: float, fit: Fit, again: Sequence[Fit], posterior: tuple[Sequence[Fit], NDArray[np.bool_]]
) -> list[Breaking]:
    least, most = ladder_ends(plan)
    drawn, poor = posterior
    values = held_logs(plan, [fit], share)[0]
    off, beyond = (
        np.quantile(held_logs(plan, fits, share), (TAIL, 1.0 - TAIL), axis=0) - values for fits in (again, drawn)
    )
    low, high = WIDER * np.minimum(off[0], 0.0), WIDER * np.maximum(off[1], 0.0)
    low, high = np.where(poor, np.minimum(low, beyond[0]), low), np.where(poor, np.maximum(high, beyond[1]), high)
    found = [_held(logs, least, most).tolist() for logs in (values, values + low, values + high)]
    return [Breaking(value, from_, to, least, most) for value, from_, to in zip(*found, strict=True)]


def _held(logs: FloatArray, least: float, most: float) -> FloatArray:
    """Return densities by their logs, those beyond the ends of the ladder at them, to the last digit."""
    beyond = [logs <= math.log(least), logs >= math.log(most)]
    found: FloatArray = np.select(beyond, [least, most], np.exp(np.clip(logs, math.log(least), math.log(most))))
    return found
