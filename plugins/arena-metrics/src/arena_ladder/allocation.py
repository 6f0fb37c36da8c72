"""Which rung each cell drives next: where a block tells most of its breaking density, by what is finished alone.

The first blocks lie on fixed rungs. From then on all cells are fitted together, and each that is not finished drives
the rung after whose block the posterior of its log breaking density would be narrowest, as a D-optimal design of one
quantity (Chaloner and Verdinelli 1995). So it does not matter how many workers there are.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from arena_ladder.fitting import Counts, Fit, FloatArray, breaking_slope, chance_slope, covariance, fit_counts
from arena_ladder.plan import Plan

SHARE = 0.9  # success of the breaking density that decides
NORMAL = 1.959964
NO_ROOM = 0.5  # share of a block that found no room, from which on its rung is left out


@dataclass(frozen=True, slots=True)
class Block:
    """What came of a block of a cell: its rung, how many of its problems found no room, and of the others the number,
    successes and mean density, people per 100 m2.
    """

    rung: int
    no_room: int
    episodes: int
    successes: int
    density: float


def next_rungs(plan: Plan, driven: Mapping[str, Sequence[Block]]) -> dict[str, int]:
    """Return the rung of the next block of each cell that is not finished; empty where all are."""
    found: dict[str, int] = {}
    open_cells = [name for name in plan.names if _asked(plan, driven[name]) < plan.cap]
    for name in open_cells:
        left = [rung for rung in plan.first if rung not in {block.rung for block in driven[name]}]
        if left:
            found[name] = left[0]
    later = [name for name in open_cells if name not in found]
    if not later:
        return found
    counts = count_blocks(plan, driven)
    fit = fit_counts(counts)
    spread = covariance(fit, counts)
    for name in later:
        closed = rungs_without_room(plan, driven[name])
        cell = plan.names.index(name)
        if len(closed) < len(plan.rungs) and not is_finished(plan, fit, spread, cell):
            found[name] = _best_rung(plan, fit, spread, cell, closed)
    return found


def count_blocks(plan: Plan, driven: Mapping[str, Sequence[Block]]) -> Counts:
    """Return episodes, successes and mean densities of each cell and rung."""
    shape = (len(plan.names), len(plan.rungs))
    episodes, successes, people = (np.zeros(shape) for _ in range(3))
    for i, name in enumerate(plan.names):
        for block in driven[name]:
            episodes[i, block.rung] += block.episodes
            successes[i, block.rung] += block.successes
            people[i, block.rung] += block.episodes * block.density
    nominal = np.broadcast_to(np.array(plan.rungs), shape)
    return Counts(np.where(episodes > 0.0, people / np.maximum(episodes, 1.0), nominal), episodes, successes)


def rungs_without_room(plan: Plan, blocks: Sequence[Block]) -> set[int]:
    """Return the rungs on which people had no room, and all above."""
    full = [block.rung for block in blocks if block.no_room >= NO_ROOM * plan.block]
    return set(range(min(full), len(plan.rungs))) if full else set()


def is_finished(plan: Plan, fit: Fit, spread: FloatArray, cell: int) -> bool:
    """Return whether a cell's breaking density is known well enough, or surely beyond the ladder."""
    middle, error = float(fit.log_breaking(SHARE)[cell]), breaking_error(fit, spread, cell)
    if not math.isfinite(middle):  # does not succeed so often even without people
        place = 2 + fit.cells + cell
        sure = (fit.theta[place] - math.log((1.0 - SHARE) / SHARE)) / math.sqrt(spread[place, place])
        return bool(sure >= NORMAL)
    low, high = middle - NORMAL * error, middle + NORMAL * error
    beyond = low > math.log(plan.rungs[-1]) or high < math.log(min(rung for rung in plan.rungs if rung > 0.0))
    return beyond or NORMAL * error <= math.log1p(plan.precision)


def breaking_error(fit: Fit, spread: FloatArray, cell: int) -> float:
    """Return the standard deviation of the posterior of a cell's log breaking density."""
    along = breaking_slope(fit, cell, SHARE)
    return math.sqrt(max(float(along @ spread @ along), 0.0))


def _best_rung(plan: Plan, fit: Fit, spread: FloatArray, cell: int, closed: Collection[int]) -> int:
    along = breaking_slope(fit, cell, SHARE)
    if not along.any():
        return 0  # what is open is the lapse rate
    known = spread @ along
    gains = []
    for rung, density in enumerate(plan.rungs):
        p, slope = chance_slope(fit, cell, density)
        one = plan.block / max(p * (1.0 - p), 1e-9)
        gain = one * float(slope @ known) ** 2 / (1.0 + one * float(slope @ spread @ slope))
        gains.append(-1.0 if rung in closed else round(gain / float(along @ known), 9))
    return int(np.argmax(gains))


def _asked(plan: Plan, blocks: Sequence[Block]) -> int:
    return plan.block * len(blocks)
