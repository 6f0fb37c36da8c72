"""Compare a planner with and without a tracker on the same scenarios: paired differences, and
how often it stands or swings.
"""

from __future__ import annotations

import argparse
import tempfile
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from arena_core import EpisodeRecord
from arena_core.config.configuration import compose, to_plain
from arena_core.config.registry import load_registry
from arena_core.hosting import build_benchmark
from arena_core.records import build_metrics
from arena_core.statistics import Estimate, estimate_difference

STILL = 0.05  # m that a robot which stands may shift
COLUMNS = ("success", "collisions", "time", "detour", "reverse", "stand")
FloatArray = NDArray[np.float64]


def episode_row(record: EpisodeRecord, success: float, collisions: float) -> tuple[float, ...]:
    """Return a row of COLUMNS: time until the goal or the limit; way over straight distance; share of it in
    reverse; longest stand, s.
    """
    stamp, pose = record["stamp"].astype(float), record["pose"].astype(float)
    steps, middle = np.diff(pose[:, :2], axis=0), 0.5 * (pose[1:, 2] + pose[:-1, 2])
    ways = np.hypot(*steps.T)
    along = (steps * np.column_stack((np.cos(middle), np.sin(middle)))).sum(axis=1)
    goal = record.meta["scenario"]["goal"]
    straight = float(np.hypot(*(pose[0, :2] - goal[:2])))
    back = float(ways[along < -0.5 * ways].sum() / max(ways.sum(), 1e-9))
    return success, collisions, float(stamp[-1]), float(ways.sum()) / straight, back, longest_stand(stamp, pose)


def longest_stand(stamp: FloatArray, pose: FloatArray) -> float:
    """Return the longest time, s, that the robot stayed within STILL of where it was."""
    longest, since = 0.0, 0
    for k in range(1, len(stamp)):
        if np.hypot(*(pose[k, :2] - pose[since, :2])) > STILL:
            since = k
        longest = max(longest, float(stamp[k] - stamp[since]))
    return longest


def drive_episodes(overrides: Sequence[str], episodes: range) -> FloatArray:
    """Run episodes of ``arena run OVERRIDES`` and return their rows (E, COLUMNS)."""
    config = to_plain(compose(list(overrides)))
    registry = load_registry()
    benchmark = build_benchmark(config, registry)
    compute = {metric.name: metric.compute for metric in build_metrics(config, registry)[""]}
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for episode in episodes:
            record = benchmark.run(episode, Path(folder))
            rows.append(episode_row(record, compute["success"](record), compute["collisions"](record)))
    return np.array(rows, np.float64)


def estimate_text(estimate: Estimate) -> str:
    """Return a difference with its interval."""
    return f"{estimate.mean:+.2f} ({estimate.low:+.2f} to {estimate.high:+.2f})"


def table_row(world: str, robot: str, name: str, rows: FloatArray) -> str:
    """Return a row of the table: means, but the longest stand of all."""
    means = rows.mean(axis=0)
    cells = (
        f"{means[0]:.2f}",
        f"{means[1]:.2f}",
        f"{means[2]:.1f}",
        f"{means[3]:.2f}",
        f"{means[4]:.2f}",
        f"{rows[:, 5].max():.0f}",
    )
    return "| " + " | ".join((world, robot, name, *cells)) + " |"


def main() -> None:
    """Print a Markdown table of both, and below each pair how tracker and none differ (95 % intervals;
    success after Bonett and Price).
    """
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("overrides", nargs="*", help="what `arena run` takes, for both: planner=teb ...")
    parser.add_argument("--world", action="append", help="may be given again")
    parser.add_argument("--robot", action="append", help="may be given again")
    parser.add_argument("--tracker", action="append", help="each is compared with the last one; default: kalman, none")
    parser.add_argument("--first", type=int, default=0, help="the first episode's number")
    parser.add_argument("--episodes", type=int, default=100)
    parser.add_argument("--each", action="store_true", help="print every episode, too")
    given = parser.parse_args()
    trackers = given.tracker or ["kalman", "none"]
    print(f"| world | robot | tracker | {' | '.join(COLUMNS)} |\n|{' --- |' * 9}")
    for world in given.world or ["warehouse", "indoor", "outdoor"]:
        for robot in given.robot or ["turtlebot3", "jackal", "robotino"]:
            found = []
            for tracker in trackers:
                choices = [f"robot={robot}", f"world={world}", f"tracker={tracker}", *given.overrides]
                found.append(drive_episodes(choices, range(given.first, given.first + given.episodes)))
                print(table_row(world, robot, tracker, found[-1]), flush=True)
                if given.each:
                    print(np.array2string(found[-1], precision=2, suppress_small=True, max_line_width=160), flush=True)
            for tracker, rows in zip(trackers[:-1], found[:-1], strict=True):
                success = estimate_difference(rows[:, 0], found[-1][:, 0], proportion=True)
                time = estimate_difference(rows[:, 2], found[-1][:, 2])
                print(
                    f"| {world} | {robot} | {tracker} - {trackers[-1]} | {estimate_text(success)} | | "
                    f"{estimate_text(time)} | | | |",
                    flush=True,
                )


if __name__ == "__main__":
    main()
