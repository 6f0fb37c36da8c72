"""Measure the CPU time that a planner takes for a control step, in episodes as `arena run` runs them, local map and tracks not counted."""

from __future__ import annotations

import argparse
import tempfile
from dataclasses import dataclass, field
from pathlib import Path
from time import process_time

import numpy as np

from arena_core import EpisodeStart, Observation, Planner, Twist
from arena_core.benchmark import build_benchmark
from arena_core.configuration import compose, plain
from arena_core.registry import load_registry


@dataclass(slots=True, eq=False)
class Timed(Planner):
    """Does what another planner does, and notes how long it takes, s; the first step of all compiles and is left out."""

    planner: Planner
    seconds: list[float] = field(default_factory=list)
    warm: bool = False

    def reset(self, episode: EpisodeStart) -> None:
        """Begin an episode."""
        self.planner.reset(episode)

    def compute_velocity(self, observation: Observation) -> Twist:
        """Return the other planner's command."""
        _ = observation.local_map, observation.tracks
        began = process_time()
        try:
            return self.planner.compute_velocity(observation)
        finally:
            if self.warm:
                self.seconds.append(process_time() - began)
            self.warm = True


def main() -> None:
    """Print a Markdown table of quantiles over all steps, ms."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("overrides", nargs="*", help="what `arena run` takes: planner=teb world=indoor ...")
    parser.add_argument("--robot", action="append", help="may be given again")
    parser.add_argument("--episodes", type=int, default=30)
    given = parser.parse_args()
    print("| robot | steps | p50 ms | p95 ms | p99 ms | most ms |\n| --- | --- | --- | --- | --- | --- |")
    for robot in given.robot or ["turtlebot3", "jackal", "robotino"]:
        benchmark = build_benchmark(plain(compose([f"robot={robot}", *given.overrides])), load_registry())
        benchmark.navigator.planner = timed = Timed(benchmark.navigator.planner)
        with tempfile.TemporaryDirectory() as folder:
            for episode in range(given.episodes):
                benchmark.run(episode, Path(folder))
        ms = 1e3 * np.array(timed.seconds)
        quantiles = " | ".join(f"{value:.1f}" for value in (*np.quantile(ms, (0.5, 0.95, 0.99)), ms.max()))
        print(f"| {robot} | {len(ms)} | {quantiles} |", flush=True)


if __name__ == "__main__":
    main()
