"""CPU time of a planner's every call in real episodes: ``python benchmarks/planner_cpu_time.py dwa,mppi,orca 5
[KEY=VALUE ...]``.

Process time, not wall time, of ``compute_velocity`` alone: local map and tracks are made before, for they cost all
planners the same. The first second of an episode does not count, in which whatever is compiled is compiled.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path
from time import process_time

import numpy as np

from arena_core import Observation, Twist
from arena_core.config.configuration import compose, to_plain
from arena_core.hosting import build_benchmark, load_registry

ROBOTS = ("turtlebot3", "jackal", "robotino")
RUN = ("world=warehouse", "task.pedestrians=10", "localizer=ground_truth", "executor=serial")
WARM = 1.0  # s of an episode that do not count


def call_times(planner: str, robot: str, episodes: int, more: list[str]) -> tuple[np.ndarray, float]:
    """Return the CPU seconds of each call over so many episodes, and the control period, s."""
    benchmark = build_benchmark(
        to_plain(compose([f"planner={planner}", f"robot={robot}", *RUN, *more])), load_registry()
    )
    seconds: list[float] = []
    inner = benchmark.navigator.planner
    compute = inner.compute_velocity

    def timed(observation: Observation) -> Twist:
        observation.local_map, observation.tracks  # noqa: B018  made when first asked for
        began = process_time()
        try:
            return compute(observation)
        finally:
            if observation.stamp >= WARM:
                seconds.append(process_time() - began)

    inner.compute_velocity = timed  # type: ignore[method-assign]
    with tempfile.TemporaryDirectory() as folder:
        for episode in range(episodes):
            benchmark.run(episode, Path(folder))
    return np.array(seconds), benchmark.navigator.control_period


def main(planners: list[str], episodes: int, more: list[str]) -> None:
    """Print a row for each planner and robot."""
    print("| planner | robot | calls | p50 [ms] | p95 [ms] | p99 [ms] | greatest [ms] | control period [ms] |")
    print("| --- | --- | --- | --- | --- | --- | --- | --- |")
    for planner in planners:
        for robot in ROBOTS:
            seconds, period = call_times(planner, robot, episodes, more)
            numbers = [f"{1e3 * number:.2f}" for number in (*np.percentile(seconds, (50, 95, 99)), seconds.max())]
            print(
                f"| `{planner}` | {robot} | {len(seconds)} | {' | '.join(numbers)} | {1e3 * period:.0f} |", flush=True
            )


if __name__ == "__main__":
    main(sys.argv[1].split(","), int(sys.argv[2]), sys.argv[3:])
