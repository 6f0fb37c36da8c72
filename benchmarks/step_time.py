"""Measure the CPU time of a planner's steps over whole episodes, the first left out: step_time.py planner=mpc robot=jackal episodes=30."""

from __future__ import annotations

import sys
from pathlib import Path
from tempfile import TemporaryDirectory
from time import process_time

import numpy as np

from arena_core import Observation, Planner, Twist, load_registry
from arena_core.benchmark import build_benchmark
from arena_core.configuration import compose, plain

QUANTILES = (0.5, 0.95, 0.99)


class Timed:
    """A planner whose steps are timed; what it observes is computed before."""

    def __init__(self, planner: Planner) -> None:
        self._compute, self.seconds = planner.compute_velocity, list[float]()

    def __call__(self, observation: Observation) -> Twist:
        """Return the planner's command and note what CPU time it took."""
        _ = observation.local_map, observation.tracks
        began = process_time()
        try:
            return self._compute(observation)
        finally:
            self.seconds.append(process_time() - began)


def main(overrides: list[str]) -> None:
    """Print mean, median and tails of a step, ms."""
    benchmark = build_benchmark(plain(compose(overrides)), load_registry())
    planner = benchmark.navigator.planner
    timed = Timed(planner)
    planner.compute_velocity = timed  # type: ignore[method-assign]
    with TemporaryDirectory() as folder:
        benchmark.run(0, Path(folder))
        timed.seconds.clear()  # whatever is compiled or loaded once
        for episode in range(benchmark.settings.episodes):
            benchmark.run(episode, Path(folder))
    values = np.array(timed.seconds) * 1e3
    tails = "  ".join(f"p{round(100 * q)} {value:.1f}" for q, value in zip(QUANTILES, np.quantile(values, QUANTILES), strict=True))
    print(f"{' '.join(overrides)}: {len(values)} steps, mean {values.mean():.1f}  {tails}  greatest {values.max():.1f} ms")


if __name__ == "__main__":
    main(sys.argv[1:])
