"""Measure how far localisers are off on simulated drives: the robot drives on the truth, and every localiser watches the same sensors."""

from __future__ import annotations

import argparse
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from arena_core import Localizer, OccupancyGrid, Pose, PoseEstimate, Robot, Sensors, generator
from arena_core.benchmark import build_benchmark
from arena_core.configuration import compose, plain
from arena_core.registry import Registry, load_registry

EXACT = Pose(0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True, eq=False)
class Drive:
    """One episode: the distance travelled, m, and the distance (m) of each localiser's estimate from the truth at every step, (T,)."""

    travelled: float
    errors: dict[str, NDArray[np.float64]]


@dataclass(slots=True, eq=False)
class Watched(Localizer):
    """Believes the truth, and lets ``watching`` localisers watch; each of them believes to start ``wrong_by`` (in base_link) off."""

    watching: dict[str, Localizer]
    wrong_by: Pose
    truth: list[Pose] = field(default_factory=list)
    estimates: dict[str, list[Pose]] = field(default_factory=dict)

    def reset(self, grid: OccupancyGrid | None, start: Pose, random: np.random.Generator) -> None:
        """Begin an episode; each watcher gets a random stream of its own."""
        self.truth = []
        self.estimates = {name: [] for name in self.watching}
        for name, localizer in self.watching.items():
            localizer.reset(grid, start.compose(self.wrong_by), generator(int(random.integers(2**31)), "watched", name))

    def update(self, sensors: Sensors) -> PoseEstimate:
        """Return the truth."""
        assert sensors.reference is not None
        self.truth.append(sensors.reference)
        for name, localizer in self.watching.items():
            self.estimates[name].append(localizer.update(sensors).pose)
        return PoseEstimate(sensors.reference, np.zeros((3, 3)))

    def drive(self) -> Drive:
        """Return how the episode went."""
        steps = pairwise(self.truth)
        errors = {
            name: np.array([pose.distance(true) for pose, true in zip(poses, self.truth, strict=True)])
            for name, poses in self.estimates.items()
        }
        return Drive(sum(a.distance(b) for a, b in steps), errors)


def drives(overrides: Sequence[str], localizers: Sequence[str], episodes: int, wrong_by: Pose = EXACT) -> list[Drive]:
    """Run episodes of ``arena run OVERRIDES`` on the truth and return how the localisers (names of presets) did meanwhile."""
    registry = load_registry()
    benchmark = build_benchmark(plain(compose(["localizer=ground_truth", *overrides])), registry)
    watched = Watched({name: build(name, benchmark.robot, registry) for name in localizers}, wrong_by)
    benchmark.navigator.localizer = watched
    found = []
    with tempfile.TemporaryDirectory() as folder:
        for episode in range(episodes):
            benchmark.run(episode, Path(folder))
            found.append(watched.drive())
    return found


def build(preset: str, robot: Robot, registry: Registry) -> Localizer:
    """Build a localiser from its preset; ROS's own defaults get the motion model that a ROS user would set for the robot."""
    node = dict(plain(compose([f"localizer={preset}"]))["localizer"])
    if preset == "amcl_as_ros" and robot.holonomic:
        node["odom_model_type"] = "omni"
    localizer: Localizer = registry.build("localizer", node, robot=robot)
    return localizer


def main() -> None:
    """Print a Markdown table: mean error over each drive's steps, then mean and worst over the drives."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--world", action="append", help="overrides of one world, separated by blanks; may be given again")
    parser.add_argument("--robot", action="append", help="may be given again")
    parser.add_argument("--localizer", action="append", help="may be given again")
    parser.add_argument("--episodes", type=int, default=5)
    parser.add_argument("--people", type=int, default=5)
    parser.add_argument("--wrong", type=float, nargs=3, default=(0.0, 0.0, 0.0), metavar=("X", "Y", "THETA"), help="error of the start")
    given = parser.parse_args()
    localizers = given.localizer or ["amcl", "amcl_as_ros", "odometry"]
    print("| world | robot | drives | metres |", *(f"{name}: mean (worst) m |" for name in localizers))
    print("| --- | --- | --- | --- |", *("--- |" for _ in localizers))
    for world in given.world or ["world=warehouse"]:
        for robot in given.robot or ["turtlebot3", "jackal", "robotino"]:
            overrides = [*world.split(), f"robot={robot}", f"task.pedestrians={given.people}"]
            found = drives(overrides, localizers, given.episodes, Pose(*given.wrong))
            means = {name: [float(drive.errors[name].mean()) for drive in found] for name in localizers}
            cells = (f"{np.mean(means[name]):.3f} ({max(means[name]):.3f}) |" for name in localizers)
            print(f"| {world.removeprefix('world=')} | {robot} | {len(found)} | {sum(drive.travelled for drive in found):.0f} |", *cells)


if __name__ == "__main__":
    main()
