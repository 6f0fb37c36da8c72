"""List where robots stood although there was a way: python benchmarks/stands.py RUN... [--longer-than 20].

A stand is a time in which the robot did not leave a circle of 0.3 m. At every second of it A* looks for a way from the
robot's true pose to the goal, in the true world with the scenario's obstacles and people as discs where they then are
(docs/navigation.md).
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from arena_core import EpisodeRecord, GlobalPlanner, NoPath, Obstacle, OccupancyGrid, Pose, Robot
from arena_core.hosting import compose, load_registry, to_plain
from arena_core.records import find_runs, read_record
from arena_core.values.obstacles import add_obstacles

STAND_RADIUS = 0.3  # m


@dataclass(frozen=True, slots=True)
class Standstill:
    """A time in one place: from ``begin`` to ``end``, s, at ``pose``; ``free`` s is the longest
    time in it with a way throughout.
    """

    begin: float
    end: float
    pose: Pose
    free: float


def find_stands(record: EpisodeRecord, grid: OccupancyGrid, longer_than: float) -> Iterator[Standstill]:
    """Yield the stands of an episode that took longer than so many seconds."""
    stamps, positions = record["stamp"], record["pose"][:, :2]
    planner = make_astar(record)
    begun = 0
    while begun < len(stamps) - 1:
        outside = np.flatnonzero(np.hypot(*(positions[begun:] - positions[begun]).T) >= STAND_RADIUS)
        left = begun + int(outside[0]) if len(outside) else len(stamps) - 1
        if stamps[left] - stamps[begun] > longer_than:
            free = longest_path_time(record, grid, planner, begun, left)
            yield Standstill(float(stamps[begun]), float(stamps[left]), Pose.of(record["pose"][begun]), free)
        begun = left


def longest_path_time(
    record: EpisodeRecord, grid: OccupancyGrid, planner: GlobalPlanner, begun: int, left: int
) -> float:
    """Return the longest time between two rows through which there was a way at each second, s."""
    per_second = max(1, round(1.0 / float(record["stamp"][1] - record["stamp"][0])))
    longest = current = 0.0
    for row in range(begun, left, per_second):
        current = current + 1.0 if has_path(record, grid, planner, row) else 0.0
        longest = max(longest, current)
    return longest


def has_path(record: EpisodeRecord, grid: OccupancyGrid, planner: GlobalPlanner, row: int) -> bool:
    """Return whether A* finds a way at this row."""
    scenario = record.meta["scenario"]
    standing = [Obstacle(np.array(o["vertices_xy"], float), o["radius"]) for o in scenario["obstacles"]]
    there = np.isfinite(record["pedestrian_positions"][row]).all(axis=1)
    people = zip(
        record["pedestrian_positions"][row][there].astype(float), record["pedestrian_radii"][there], strict=True
    )
    crowd = [Obstacle(position[None], float(radius)) for position, radius in people]
    try:
        planner.plan(add_obstacles(grid, [*standing, *crowd]), Pose.of(record["pose"][row]), Pose(*scenario["goal"]))
    except NoPath:
        return False
    return True


def make_astar(record: EpisodeRecord) -> GlobalPlanner:
    """Return A* for the robot as a disc that holds all of its body."""
    registry = load_registry()
    robot: Robot = registry.build("robot", record.meta["config"]["robot"])
    node = to_plain(compose([f"robot={robot.name}"]))["global_planner"]
    disc = {"radius": robot.footprint.radius, "vertices_xy": None}
    round_robot = registry.build("robot", {**record.meta["config"]["robot"], "footprint": disc})
    planner: GlobalPlanner = registry.build("global_planner", {**node, "name": "astar"}, robot=round_robot)
    return planner


def read_world(run: Path, record: EpisodeRecord) -> OccupancyGrid:
    """Return the map of an episode from its run's folder."""
    with np.load(run / record.meta["world"]["grid"], allow_pickle=False) as content:
        return OccupancyGrid(content["data"], float(content["resolution"]), Pose.of(content["origin"]))


def main() -> None:
    """Print each run's stands, and how many of them had a way for longer than what counts."""
    arguments = argparse.ArgumentParser(description=__doc__)
    arguments.add_argument("folders", nargs="+", type=Path)
    arguments.add_argument("--longer-than", type=float, default=20.0)
    given = arguments.parse_args()
    for folder in given.folders:
        for run in find_runs(folder):
            found = [
                print_stands(read_record(path), run, given.longer_than)
                for path in sorted((run / "records").glob("*.npz"))
            ]
            print(f"{run}: {len(found)} episodes, {sum(found)} stands of more than {given.longer_than:g} s with a way")


def print_stands(record: EpisodeRecord, run: Path, longer_than: float) -> int:
    """Print an episode's stands and return how many of them had a way for longer than what counts."""
    columns = record.meta["columns"]
    name = " ".join(str(columns[key]) for key in ("preset", "robot", "world", "episode"))
    found = list(find_stands(record, read_world(run, record), longer_than))
    for stand in found:
        times, where = f"{stand.begin:.0f}-{stand.end:.0f} s", f"({stand.pose.x:.1f}, {stand.pose.y:.1f})"
        print(f"  {name}: {times} at {where}, with a way for {stand.free:.0f} s; {record.meta['outcome']}")
    return sum(stand.free > longer_than for stand in found)


if __name__ == "__main__":
    main()
