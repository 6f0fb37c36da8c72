"""One cell of a ladder by our fit and by psignifit (Schuett et al. 2016), on the same simulated episodes.

``pip install psignifit``, then ``python benchmarks/ladder_psignifit.py`` prints both densities of half success and what
lies between them.
"""

from __future__ import annotations

import math

import numpy as np
import psignifit

from arena_ladder.fitting import Counts, breaking_slope, covariance, fit_counts

RUNGS = np.array([0.0, 1.0, 2.0, 4.0, 8.0, 12.0, 16.0, 24.0])
NOBODY = 0.05  # people per 100 m2 in place of none: psignifit knows the logarithm alone
EPISODES = 40


def main() -> None:
    """Print a line for each simulated planner."""
    print("| true half | ours | psignifit | ours [95 %] | psignifit [95 %] |\n| --- | --- | --- | --- | --- |")
    for seed, (half, slope, lapse) in enumerate(((3.0, 2.0, 0.02), (8.0, 2.0, 0.05), (14.0, 3.0, 0.01))):
        random = np.random.default_rng(seed)
        won = random.binomial(EPISODES, (1.0 - lapse) / (1.0 + (RUNGS / half) ** slope)).astype(float)
        counts = Counts(RUNGS[None], np.full((1, len(RUNGS)), float(EPISODES)), won[None])
        fit = fit_counts(counts)
        along = breaking_slope(fit, 0, 0.5)
        error = math.sqrt(along @ covariance(fit, counts) @ along)
        ours = float(fit.log_breaking(0.5)[0])
        logs = np.log(np.maximum(RUNGS, NOBODY))
        table = np.stack((logs, EPISODES - won, np.full(len(RUNGS), EPISODES)), axis=1)
        found = psignifit.psignifit(table, experiment_type="yes/no", sigmoid="logistic")
        theirs, ends = found.threshold(0.5, unscaled=True)
        low, high = ends["0.95"]
        their_range = f"{np.exp(low):.1f} – {np.exp(high):.1f}"
        own = f"{math.exp(ours - 1.96 * error):.1f} – {math.exp(ours + 1.96 * error):.1f}"
        print(f"| {half:g} | {math.exp(ours):.2f} | {math.exp(theirs):.2f} | {own} | {their_range} |")


if __name__ == "__main__":
    main()
