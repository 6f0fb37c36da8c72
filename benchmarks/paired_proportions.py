"""How often intervals of paired proportions hold the truth, and how often equal planners are told apart: all tables.

Summed, not drawn: ``python benchmarks/paired_proportions.py`` prints docs/results/interval_coverage.md's table.
"""

from __future__ import annotations

import numpy as np
from scipy.stats import multinomial

from arena_core.statistics import compare

NUMBERS = (15, 30, 50, 100)
DIFFERING = (0.1, 0.2, 0.4, 0.6, 0.8)
DIFFERENCES = (0.0, 0.05, 0.1, 0.2, 0.3)
MANY = 10  # differing pairs that are expected


def all_tables(n: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the numbers of pairs won, lost and alike, (K, 3), and low, high and p of each, (K, 3)."""
    tables = np.array([(a, b, n - a - b) for a in range(n + 1) for b in range(n + 1 - a)])
    found = [compare(np.repeat([1.0, -1.0, 0.0], table), np.zeros(n), "proportion") for table in tables]
    return tables, np.array([(one.difference.low, one.difference.high, one.p) for one in found])


def main() -> None:
    """Print a line for each number of pairs."""
    print("| pairs | differing pairs expected | coverage: mean | least | greatest | equal planners told apart |")
    print("| --- | --- | --- | --- | --- | --- |")
    for n in NUMBERS:
        tables, found = all_tables(n)
        held: dict[bool, list[float]] = {True: [], False: []}
        told: dict[bool, list[float]] = {True: [], False: []}
        for share in DIFFERING:
            for d in (d for d in DIFFERENCES if d <= share):
                chance = multinomial.pmf(tables, n, [(share + d) / 2, (share - d) / 2, 1.0 - share])
                inside = (found[:, 0] - 1e-12 <= d) & (d <= found[:, 1] + 1e-12)
                held[n * share >= MANY].append(chance[inside].sum())
                if d == 0.0:
                    told[n * share >= MANY].append(chance[found[:, 2] <= 0.05].sum())
        for many, shares in held.items():
            if shares:
                words = f"{MANY} or more" if many else "fewer"
                mean, least, most = (100.0 * f(shares) for f in (np.mean, np.min, np.max))
                errors = " – ".join(f"{100.0 * f(told[many]):.1f} %" for f in (np.min, np.max))
                print(f"| {n} | {words} | {mean:.1f} % | {least:.1f} % | {most:.1f} % | {errors} |")


if __name__ == "__main__":
    main()
