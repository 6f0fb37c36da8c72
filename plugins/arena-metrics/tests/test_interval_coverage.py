"""Simulated episodes of known effect: how often intervals hold the truth, and how often chance passes for a difference.

The usual tests draw a small share; ``make long`` draws ARENA_REPLICATIONS of each case and asks for 93 % and 97 %
themselves.
"""

from __future__ import annotations

import math
import os
from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

from arena_core.statistics import after_holm, compare, estimate

REPLICATIONS = int(os.environ.get("ARENA_REPLICATIONS", "4"))
WHOLE = REPLICATIONS >= 1000
NUMBERS = (15, 50, 300) if WHOLE else (15, 50)  # episodes
REPEATS = 5  # of a problem, where problems are repeated; of 15 episodes 3
FAMILY = 4  # planners against a baseline
Sample = Callable[[np.random.Generator, int], NDArray[np.float64]]

FIGURES: dict[str, tuple[Sample, float]] = {  # how they are drawn, and their mean
    "normal": (lambda random, n: random.normal(3.0, 1.0, n), 3.0),
    "gamma": (lambda random, n: random.gamma(2.0, 1.0, n), 2.0),
    "exponential": (lambda random, n: random.exponential(1.0, n), 1.0),
    "lognormal": (lambda random, n: random.lognormal(0.0, 0.6, n), math.exp(0.18)),
}
EVENTS: dict[str, tuple[Sample, float]] = {
    "rare": (lambda random, n: random.poisson(0.1, n).astype(float), 0.1),
    "some": (lambda random, n: random.poisson(0.5, n).astype(float), 0.5),
    "many": (lambda random, n: random.poisson(2.0, n).astype(float), 2.0),
    "bunched": (lambda random, n: random.poisson(random.gamma(0.7, 1.0, n)).astype(float), 0.7),
}
REPEATED: dict[str, tuple[str, Sample, float]] = {  # by problem: a level of its own, then the episodes' luck
    "normal": ("figure", lambda random, n: random.normal(_levels(random.normal(3.0, 1.0, _problems(n)), n), 1.0), 3.0),
    "gamma": (
        "figure",
        lambda random, n: _levels(random.gamma(2.0, 1.0, _problems(n)), n) * random.gamma(4.0, 0.25, n),
        2.0,
    ),
    "success": ("proportion", lambda random, n: _won(random, _levels(random.beta(2.4, 0.6, _problems(n)), n)), 0.8),
    "events": (
        "count",
        lambda random, n: random.poisson(_levels(random.gamma(1.0, 0.5, _problems(n)), n)).astype(float),
        0.5,
    ),
}
# two planners, and the effect
PAIRS: dict[str, tuple[str, Callable[[np.random.Generator, int, float], NDArray[np.float64]], float]] = {
    "normal": (
        "figure",
        lambda random, n, d: _both(random.normal(0.0, 1.0, (2, n)) + random.normal(0.0, 2.0, n), d),
        0.5,
    ),
    "gamma": (
        "figure",
        lambda random, n, d: _both(random.gamma(2.0, 1.0, (2, n)) * random.lognormal(0.0, 0.3, n), d),
        0.5,
    ),
    "lognormal": ("figure", lambda random, n, d: _both(random.lognormal(0.0, 0.6, (2, n)), d), 0.3),
    "events": ("count", lambda random, n, d: random.poisson([[0.3 + d] * n, [0.3] * n]).astype(float), 0.3),
    "rare events": ("count", lambda random, n, d: random.poisson([[0.05 + d] * n, [0.05] * n]).astype(float), 0.05),
    "success": ("proportion", lambda random, n, d: _rivals(random, random.beta(2.0, 2.0, n), d), 0.2),
    "near certain success": ("proportion", lambda random, n, d: _rivals(random, np.full(n, 0.9), d), 0.1),
    "repeated success": (
        "proportion",
        lambda random, n, d: _rivals(random, _levels(random.beta(1.0, 1.0, _problems(n)), n), d),
        0.2,
    ),
    "repeated gamma": ("figure", lambda random, n, d: _repeated_rivals(random, n, d), 0.5),
}


def _repeats(n: int) -> int:
    return 3 if n == 15 else REPEATS


def _problems(n: int) -> int:
    return n // _repeats(n)


def _levels(of_problems: NDArray[np.float64], n: int) -> NDArray[np.float64]:
    return np.repeat(of_problems, _repeats(n))


def _labels(name: str, n: int) -> list[int] | None:
    return [i // _repeats(n) for i in range(n)] if "repeated" in name else None


def _won(random: np.random.Generator, chance: NDArray[np.float64]) -> NDArray[np.float64]:
    return (random.random(chance.shape) < chance).astype(float)


def _both(samples: NDArray[np.float64], effect: float) -> NDArray[np.float64]:
    return samples + np.array([[effect], [0.0]])


def _rivals(random: np.random.Generator, chance: NDArray[np.float64], effect: float) -> NDArray[np.float64]:
    """Draw successes on problems of these chances: a share of all that is the effect succeeds
    with one and fails with the other.
    """
    ours = np.where(random.random(len(chance)) < effect, 1.0, _won(random, chance))
    return np.stack((ours, _won(random, chance * (1.0 - effect))))


def _repeated_rivals(random: np.random.Generator, n: int, effect: float) -> NDArray[np.float64]:
    """Draw figures of planners that differ in their way with each problem, and by the effect over all."""
    own = np.stack([_levels(random.gamma(2.0, 1.0, _problems(n)), n) for _ in range(2)])
    return _both(own + random.normal(0.0, 1.0, (2, n)), effect)


def share(found: list[bool]) -> float:
    return float(np.mean(found))


def tolerance(probability: float) -> float:
    """Return how far a small share may be off by chance; nothing where all is drawn."""
    return 0.0 if WHOLE else 3.0 * math.sqrt(probability * (1.0 - probability) / REPLICATIONS)


def told(kind: str, name: str, n: int, found: float) -> None:
    """Say a result to whoever runs the whole (pytest -s)."""
    if WHOLE:
        print(f"| {kind} | {name} | {n} | {100.0 * found:.1f} |")


def covered(low: float, high: float, truth: float) -> bool:
    return low - 1e-12 <= truth <= high + 1e-12


def check(kind: str, name: str, n: int, found: list[bool], continuous: bool) -> None:
    coverage = share(found)
    told(kind, name, n, coverage)
    assert coverage >= 0.93 - tolerance(0.93)
    if continuous and n >= 50:
        assert coverage <= 0.97 + tolerance(0.97)


@pytest.mark.parametrize("n", NUMBERS)
@pytest.mark.parametrize("name", FIGURES)
def test_intervals_of_figures_hold_the_mean(name, n):
    draw, mean = FIGURES[name]
    random = np.random.default_rng([n, 1])
    found = [estimate(draw(random, n)) for _ in range(REPLICATIONS)]
    check("mean", name, n, [covered(one.low, one.high, mean) for one in found], continuous=True)


@pytest.mark.parametrize("n", NUMBERS)
@pytest.mark.parametrize("name", EVENTS)
def test_intervals_of_events_hold_the_mean(name, n):
    draw, mean = EVENTS[name]
    random = np.random.default_rng([n, 2])
    found = [estimate(draw(random, n), "count") for _ in range(REPLICATIONS)]
    check("mean of events", name, n, [covered(one.low, one.high, mean) for one in found], continuous=False)


@pytest.mark.parametrize("n", NUMBERS)
@pytest.mark.parametrize("name", REPEATED)
def test_intervals_over_repeated_problems_hold_the_mean(name, n):
    kind, draw, mean = REPEATED[name]
    random = np.random.default_rng([n, 3])
    found = [estimate(draw(random, n), kind, _labels("repeated", n)) for _ in range(REPLICATIONS)]
    check(
        "mean over repeats", name, n, [covered(one.low, one.high, mean) for one in found], continuous=kind == "figure"
    )


@pytest.mark.parametrize("n", NUMBERS)
@pytest.mark.parametrize("name", PAIRS)
def test_intervals_of_paired_differences_hold_the_effect(name, n):
    kind, draw, effect = PAIRS[name]
    random = np.random.default_rng([n, 4])
    found = [compare(*draw(random, n, effect), kind, _labels(name, n)).difference for _ in range(REPLICATIONS)]
    check("difference", name, n, [covered(one.low, one.high, effect) for one in found], continuous=kind == "figure")


@pytest.mark.parametrize("n", NUMBERS if WHOLE else (15,))
@pytest.mark.parametrize("name", PAIRS)
def test_equal_planners_are_rarely_told_apart_after_holm(name, n):
    """Of several planners that equal the baseline, none is told apart from it in 95 % of the tables."""
    kind, draw, _ = PAIRS[name]
    random, alarms = np.random.default_rng([n, 5]), []
    for _ in range(REPLICATIONS):
        family = after_holm([compare(*draw(random, n, 0.0), kind, _labels(name, n)) for _ in range(FAMILY)])
        alarms.append(any(one.told_apart for one in family))
    told(f"false alarms in {FAMILY} comparisons", name, n, share(alarms))
    # the exact share of mid-p is .0504 at most, so what is above that is the simulation's own error
    assert share(alarms) <= 0.05 + (2.0 * math.sqrt(0.05 * 0.95 / REPLICATIONS) if WHOLE else tolerance(0.05))
