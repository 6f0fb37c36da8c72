"""Sentences on pairs of planners: how many times as many people one bears, from the maps that both drove."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from arena_ladder.breaking import RESAMPLES, Drive, Sample, held_logs, make_sample
from arena_ladder.fitting import Fit, FloatArray, fit_counts
from arena_ladder.plan import Plan
from arena_ladder.results import Ladder

SHARE = 0.9
ALPHA = 0.05  # of all sentences of one robot together, after Bonferroni
LEAST_MAPS = 5


@dataclass(frozen=True, slots=True)
class PairFinding:
    """How many times as many people per 100 m2 the first planner bears as the second, geometric mean over ``cells``."""

    first: str
    second: str
    ratio: float
    low: float
    high: float
    maps: int
    cells: int

    def better_first(self) -> PairFinding:
        """Return the same with the better planner first."""
        if self.ratio >= 1.0:
            return self
        return replace(
            self,
            first=self.second,
            second=self.first,
            ratio=1.0 / self.ratio,
            low=1.0 / self.high,
            high=1.0 / self.low,
        )

    def text(self) -> str:
        """Return the sentence, the better planner first."""
        if self.maps < LEAST_MAPS:
            both = f"{self.first} and {self.second} met on {self.maps} maps only"
            return f"{both}: with fewer than {LEAST_MAPS} nothing can be said."
        over = f"{self.maps} maps in {self.cells} kinds of worlds and crowds"
        if self.ratio < 1.0:
            return self.better_first().text()
        range_text = f"{self.ratio:.2f} times ({self.low:.2f} – {self.high:.2f})"
        if self.low > 1.0:
            many = f"{self.first} bears {range_text} as many people as {self.second}"
            return f"{many} before its success falls to .9; {over}."
        return f"{self.first} and {self.second} cannot be told apart: {range_text} as many people; {over}."


def compare_ladders(ladders: Sequence[Ladder]) -> list[PairFinding]:
    """Return what the maps that both drove say of each pair of planners on one robot."""
    pairs = [(a, b) for a, b in combinations(ladders, 2) if a.robot == b.robot and a.plan.rungs == b.plan.rungs]
    return [_compare_pair(a, b, len(pairs)) for a, b in pairs]


def summary_sentences(found: Sequence[PairFinding]) -> list[str]:
    """Return for each planner whom it surely bears more people than, those first who do so most often."""
    behind: dict[str, list[PairFinding]] = {}
    for one in (pair.better_first() for pair in found if pair.maps >= LEAST_MAPS):
        if one.low > 1.0:
            behind.setdefault(one.first, []).append(one)
    order = sorted(behind, key=lambda name: -len(behind[name]))
    return [
        f"{name} surely bears more people than {', '.join(one.second for one in behind[name])}: "
        f"{_range_text([one.ratio for one in behind[name]])} times as many."
        for name in order
    ]


def _range_text(ratios: Sequence[float]) -> str:
    low, high = f"{min(ratios):.1f}", f"{max(ratios):.1f}"
    return low if low == high else f"{low} to {high}"


def _compare_pair(first: Ladder, second: Ladder, family: int) -> PairFinding:
    cells = {name: words for name, words in first.plan.cells.items() if second.plan.cells.get(name) == words}
    plan = replace(first.plan, cells=cells)
    both = [[drive for drive in one.drives if drive.cell in cells and not drive.no_room] for one in (first, second)]
    shared = {(d.cell, d.world_map) for d in both[0]} & {(d.cell, d.world_map) for d in both[1]}
    kept = [[drive for drive in drives if (drive.cell, drive.world_map) in shared] for drives in both]
    maps = len({world_map for _, world_map in shared})
    if maps < LEAST_MAPS:
        return PairFinding(first.planner, second.planner, 1.0, 1.0, 1.0, maps, len(cells))
    middle, error = _log_ratio(plan, *kept)
    reach = _normal_quantile(1.0 - ALPHA / (2.0 * family)) * error
    ratio, low, high = (math.exp(x) for x in (middle, middle - reach, middle + reach))
    return PairFinding(first.planner, second.planner, ratio, low, high, maps, len(cells))


def _log_ratio(plan: Plan, first: Sequence[Drive], second: Sequence[Drive]) -> tuple[float, float]:
    """Return the mean difference of log breaking densities, held within the ladder, and its standard deviation over
    resamples of the maps.
    """
    samples = [make_sample(plan, sorted(drives, key=_place)) for drives in (first, second)]
    fits = [fit_counts(sample.counts(np.ones(sum(map(len, sample.strata))))) for sample in samples]
    weights = _common_resamples(samples[0], first)
    again = [_refit(*each, weights) for each in zip(samples, fits, strict=True)]
    found = [held_logs(plan, [fit], SHARE).mean() for fit in fits]
    spread = (held_logs(plan, again[0], SHARE) - held_logs(plan, again[1], SHARE)).mean(axis=1)
    return float(found[0] - found[1]), float(spread.std(ddof=1))


def _common_resamples(sample: Sample, drives: Sequence[Drive]) -> FloatArray:
    """Return draws of the maps, which both planners' samples number alike."""
    return sample.resamples(RESAMPLES, f"pair {len(drives)}")


def _refit(sample: Sample, fit: Fit, weights: FloatArray) -> list[Fit]:
    return [fit_counts(sample.counts(each), start=fit) for each in weights]


def _place(drive: Drive) -> tuple[str, tuple[str, int, int]]:
    return drive.cell, drive.world_map


def _normal_quantile(share: float) -> float:
    from scipy.special import ndtri

    return float(ndtri(share))
