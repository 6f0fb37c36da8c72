"""Measure predictors against the truth of simulated drives in many places: a table of `arena predict measure`.

usage: .venv/bin/python benchmarks/prediction_error.py [--episodes N] [--seed N] [--time S] [--tracker NAME ...]
[--world NAME ...] [--people NAME ...] [--crowd NAME ...] [--predictor NAME ...] [WORD ...]
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from itertools import product

from arena_core.commands import align_columns
from arena_prediction.measure import measure

HORIZON, MISS = 2.0, 0.5  # s ahead, and m beyond which a hypothesis misses
DRAWN = ("indoor", "outdoor", "rooms", "cellular", "indoor_large", "outdoor_large")  # worlds that are drawn by seed
HEADER = ["world", "crowd", "people", "tracker", "predictor", "tracks", "ADE m", "of the first", "FDE m", "min ADE m"]
SURE = ["missed", "NLL", "in 50 %", "in 90 %", "ms a call"]


def rows_of(place: Sequence[str], given: argparse.Namespace) -> list[list[str]]:
    """Return a row for each predictor, of a world, a crowd, its profile and a tracker."""
    words = [f"{key}={name}" for key, name in zip(("world", "pedestrians", "people", "tracker"), place, strict=True)]
    words += ["world.regenerate=1"] * (place[0] in DRAWN)
    words += ["planner=pure_pursuit", "robot=turtlebot3", "task.pedestrians=10", f"task.time_limit={given.time}"]
    words += ["pedestrians.reaction=ignore"] * (place[1] != "replay")
    words += [f"seed={given.seed}", f"episodes={given.episodes}", *given.words]
    found = measure(words, given.predictor, HORIZON, MISS)
    first, rows = found[given.predictor[0]].summary.ade, []
    for name, one in found.items():
        mean = one.summary
        far = [f"{mean.ade:.3f}", f"{mean.ade / first:.2f}", f"{mean.fde:.3f}", f"{mean.min_ade:.3f}"]
        sure = [f"{value:.2f}" for value in (mean.missed, mean.nll, mean.in_50, mean.in_90)]
        rows.append([*place, name, str(mean.tracks), *far, *sure, f"{one.milliseconds:.3f}"])
    return rows


def main() -> None:
    """Print a table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--episodes", type=int, default=8)
    parser.add_argument("--seed", type=int, default=2000, help="none that a predictor was held against")
    parser.add_argument("--time", type=float, default=60.0)
    for flag, default in (
        ("--tracker", ["ground_truth", "kalman"]),
        ("--world", ["indoor", "warehouse"]),
        ("--crowd", ["social_force"]),
        ("--people", ["slow", "lifelike"]),
        ("--predictor", ["constant_velocity", "social_force", "learned"]),
    ):
        parser.add_argument(flag, nargs="+", default=default)
    parser.add_argument("words", nargs="*", help="further words of arena run")
    given = parser.parse_intermixed_args()
    rows = [[*HEADER, *SURE]]
    for place in product(given.world, given.crowd, given.people, given.tracker):
        rows += rows_of(place, given)
        print(" ".join(place), flush=True)
    print("\n".join(align_columns(rows)))


if __name__ == "__main__":
    main()
