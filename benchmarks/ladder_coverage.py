"""Simulated ladders of known truth, with adaptive blocks, stopping rule, cap and map clusters: do intervals hold it?

``python benchmarks/ladder_coverage.py 100`` simulates so many ladders and prints docs/results/ladder.md's table.
"""

from __future__ import annotations

import math
import sys
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from arena_ladder.allocation import Block, next_rungs
from arena_ladder.breaking import Drive, find_breaking, make_sample
from arena_ladder.plan import Plan, make_plan

SPREAD = 0.3  # of the log densities that maps bear: a map on which everything breaks earlier
SHARES = (0.9, 0.5)


@dataclass(frozen=True)
class Truth:
    """A planner: the slope, halves and lapses of its cells, on a middling map."""

    slope: float
    halves: NDArray[np.float64]
    lapses: NDArray[np.float64]

    def success(self, cell: int, density: float, shift: float | NDArray[np.float64]) -> float | NDArray[np.float64]:
        """Return the chance of success on a map that bears exp(shift) times as many."""
        return (1.0 - self.lapses[cell]) / (1.0 + (density / (self.halves[cell] * np.exp(shift))) ** self.slope)

    def breaking(self, cell: int, share: float) -> float:
        """Return the density at which the success over all maps is ``share``; 0 where it never is."""
        nodes = np.linspace(-4.0, 4.0, 81)
        weights = np.exp(-(nodes**2) / 2.0) / np.exp(-(nodes**2) / 2.0).sum()
        if 1.0 - self.lapses[cell] <= share:
            return 0.0
        low, high = -6.0, 8.0
        for _ in range(60):
            middle = 0.5 * (low + high)
            over = float((self.success(cell, math.exp(middle), SPREAD * nodes) * weights).sum()) > share
            low, high = (middle, high) if over else (low, middle)
        return math.exp(low)


def draw_truth(random: np.random.Generator, cells: int) -> Truth:
    """Draw a planner: breaking between next to no people and more than the ladder has."""
    middle = random.normal(math.log(9.0), 0.6)
    halves = np.exp(random.normal(middle, 0.6, cells))
    return Truth(math.exp(random.normal(math.log(2.0), 0.4)), halves, random.beta(1.0, 40.0, cells))


def drive_ladder(plan: Plan, truth: Truth, random: np.random.Generator) -> list[Drive]:
    """Return the episodes of a whole ladder; maps of one kind of world are shared by its crowds."""
    shifts: dict[tuple[str, int, int], float] = {}
    driven: dict[str, list[Block]] = {name: [] for name in plan.names}
    drives: list[Drive] = []
    while due := next_rungs(plan, driven):
        for name, rung in due.items():
            cell, world = plan.names.index(name), name.partition("_")[0]
            maps = [(world, plan.seed + len(driven[name]), i) for i in range(plan.block)]
            for one in maps:
                shifts.setdefault(one, SPREAD * random.normal())
            won = [bool(random.random() < truth.success(cell, plan.rungs[rung], shifts[one])) for one in maps]
            drives += [Drive(name, rung, plan.rungs[rung], m, w, w) for m, w in zip(maps, won, strict=True)]
            driven[name].append(Block(rung, 0, plan.block, sum(won), plan.rungs[rung]))
    return drives


def main(arguments: list[str]) -> None:
    """Print the coverage, the precision and the episodes."""
    number, cap = int(arguments[0]), int(arguments[1]) if len(arguments) > 1 else 96
    plan, random = replace(make_plan(), cap=cap), np.random.default_rng(int(arguments[2]) if len(arguments) > 2 else 1)
    held: dict[float, list[bool]] = {share: [] for share in SHARES}
    reached, episodes = [], []
    for _ in range(number):
        truth = draw_truth(random, len(plan.names))
        drives = drive_ladder(plan, truth, random)
        _, found = find_breaking(plan, make_sample(plan, drives), SHARES)
        episodes.append(len(drives) / len(plan.names))
        for share in SHARES:
            for cell, one in enumerate(found[share]):
                true = min(max(truth.breaking(cell, share), one.least), one.most)
                held[share].append(one.low - 1e-9 <= true <= one.high + 1e-9)
                if share == SHARES[0]:
                    reached.append(one.precise <= plan.precision)
    for share in SHARES:
        print(f"| {share:g} | {len(held[share])} cells | {100.0 * np.mean(held[share]):.1f} % |")
    print(f"within ± {plan.precision:.0%}: {100.0 * np.mean(reached):.0f} % of the cells; ", end="")
    print(f"{np.mean(episodes):.0f} episodes a cell, cap {cap}")


if __name__ == "__main__":
    main(sys.argv[1:])
