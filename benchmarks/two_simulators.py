"""Drive the same scenarios in both simulators and say how far apart they are: python benchmarks/two_simulators.py
[FOLDER] [--episodes 20].

Without people and at the true pose, paths are compared point by point; among people, which act on what robots do
differently by a centimetre, only what episodes come to is compared. Runs that FOLDER holds already are read, not driven
again.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy.spatial import cKDTree

import arena_core as arena

SIMULATORS = {
    "sim2d": ["simulator=sim2d"],
    "mujoco, planar": ["simulator=mujoco"],
    "mujoco, wheels": ["simulator=mujoco", "simulator.drive=wheels"],
}
ROBOTS = ("turtlebot3", "jackal", "robotino")
WORLDS = ("warehouse", "indoor", "outdoor")
ALONE = ["localizer=ground_truth", "task.pedestrians=0", "planner=dwa"]
AMONG = ["task.pedestrians=5", "planner=dwa,rosnav"]
SPACING = 0.01  # [m] of the points that a path is compared at


def drive_runs(folder: Path, words: list[str]) -> arena.Runs:
    """Return the runs of these words in ``folder``; drive them unless they are there."""
    if not (folder.is_dir() and any(folder.rglob("episodes.csv"))):
        arena.run(words, folder)
    return arena.Runs.below(folder)


def path_points(poses: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return points (K, 2), m, along the path of poses (T, 3), evenly spaced."""
    steps = np.hypot(*np.diff(poses[:, :2], axis=0).T)
    way = np.concatenate(([0.0], np.cumsum(steps)))
    at = np.arange(0.0, way[-1], SPACING)
    return np.column_stack([np.interp(at, way, poses[:, k]) for k in range(2)])


def path_distance(one: NDArray[np.float64], other: NDArray[np.float64]) -> float:
    """Return how far points of each path are from the other path at the mean, m."""
    a, b = path_points(one), path_points(other)
    return float(np.mean(np.concatenate((cKDTree(b).query(a)[0], cKDTree(a).query(b)[0]))))


def episodes_of(runs: arena.Runs) -> Iterator[tuple[tuple[str, str], NDArray[np.float64]]]:
    """Yield (planner, world and scenario) and true poses of each episode."""
    for run in runs:
        for episode in run.episodes["episode"].tolist():
            record = run.record(int(episode))
            told = record.meta["columns"]
            yield (told["planner"], f"{told['world']} {told['scenario']}"), record["pose"]


def path_differences(folder: Path, episodes: int) -> pd.DataFrame:
    """Return how far paths in MuJoCo are from those in the plane, for each robot and drive."""
    rows = []
    for robot in ROBOTS:
        words = [f"robot={robot}", f"world={','.join(WORLDS)}", f"episodes={episodes}", *ALONE]
        paths = {
            name: dict(episodes_of(drive_runs(folder / "alone" / robot / name, [*words, *extra])))
            for name, extra in SIMULATORS.items()
        }
        flat = paths.pop("sim2d")
        for name, others in paths.items():
            for planner in sorted({planner for planner, _ in flat}):
                apart = np.array(
                    [path_distance(flat[key], others[key]) for key in flat if key[0] == planner and key in others]
                )
                rows.append(
                    {
                        "robot": robot,
                        "simulator": name,
                        "planner": planner,
                        "scenarios": len(apart),
                        "mean [m]": apart.mean(),
                        "worst [m]": apart.max(),
                    }
                )
    return pd.DataFrame(rows)


def wilson_text(successes: int, count: int) -> str:
    """Return a share with its 95 % Wilson interval."""
    z, share = 1.959964, successes / count
    middle, half = share + z * z / (2 * count), z * math.sqrt(share * (1 - share) / count + z * z / (4 * count * count))
    low, high = (middle - half) / (1 + z * z / count), (middle + half) / (1 + z * z / count)
    return f"{share:.2f} [{low:.2f}, {high:.2f}]"


def crowd_outcomes(folder: Path, episodes: int) -> pd.DataFrame:
    """Return what episodes among people come to in each simulator."""
    rows = []
    for robot in ROBOTS:
        words = [f"robot={robot}", f"world={','.join(WORLDS)}", f"episodes={episodes}", *AMONG]
        for name, extra in SIMULATORS.items():
            table = drive_runs(folder / "among" / robot / name, [*words, *extra]).episodes
            for planner, of in table.groupby("planner"):
                good = of[of["outcome"] == "goal_reached"]
                rows.append(
                    {
                        "robot": robot,
                        "planner": planner,
                        "simulator": name,
                        "episodes": len(of),
                        "success": wilson_text(len(good), len(of)),
                        "collisions": of["collisions"].mean(),
                        "time to goal, median [s]": pd.to_numeric(good["time_to_goal"]).median(),
                    }
                )
    return pd.DataFrame(rows).sort_values(["robot", "planner", "simulator"])


def main() -> None:
    """Print both tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", nargs="?", type=Path, default=Path("outputs/two_simulators"))
    parser.add_argument("--episodes", type=int, default=20, help="of each of three worlds")
    given = parser.parse_args()
    print(path_differences(given.folder, given.episodes).to_string(index=False, float_format="%.3f"))
    print(crowd_outcomes(given.folder, given.episodes).to_string(index=False, float_format="%.2f"), flush=True)


if __name__ == "__main__":
    main()
