"""Measure how far localisers are off on simulated drives: the robot drives on the truth, and every
localiser watches the same sensors.
"""

from __future__ import annotations

import argparse
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from arena_core import Localizer, OccupancyGrid, Pose, PoseEstimate, Robot, Sensors, random_generator, wrap_angle
from arena_core.config.configuration import compose, to_plain
from arena_core.config.registry import Registry, load_registry
from arena_core.hosting import build_benchmark

EXACT = Pose(0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True, eq=False)
class Drive:
    """One episode: the distance travelled, m, and how far each localiser's estimate is from the truth at
    every step, (T,), m and rad.
    """

    travelled: float
    errors: dict[str, NDArray[np.float64]]
    turns: dict[str, NDArray[np.float64]]


@dataclass(slots=True, eq=False)
class TruthLocalizer(Localizer):
    """Believes the truth, and lets ``watching`` localisers watch; each of them believes to start
    ``wrong_by`` (in base_link) off.
    """

    watching: dict[str, Localizer]
    wrong_by: Pose
    truth: list[Pose] = field(default_factory=list)
    estimates: dict[str, list[Pose]] = field(default_factory=dict)

    def reset(self, grid: OccupancyGrid | None, start: Pose, random: np.random.Generator) -> None:
        """Begin an episode; each watcher gets a random stream of its own."""
        self.truth = []
        self.estimates = {name: [] for name in self.watching}
        for name, localizer in self.watching.items():
            localizer.reset(
                grid, start.compose(self.wrong_by), random_generator(int(random.integers(2**31)), "watched", name)
            )

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
        turns = {
            name: np.array(
                [abs(wrap_angle(pose.theta - true.theta)) for pose, true in zip(poses, self.truth, strict=True)]
            )
            for name, poses in self.estimates.items()
        }
        return Drive(sum(a.distance(b) for a, b in steps), errors, turns)


def run_drives(
    overrides: Sequence[str], localizers: Sequence[str], episodes: int, wrong_by: Pose = EXACT
) -> list[Drive]:
    """Run episodes of ``arena run OVERRIDES`` on the truth and return how the localisers (names
    of presets) did meanwhile.
    """
    registry = load_registry()
    benchmark = build_benchmark(to_plain(compose(["localizer=ground_truth", *overrides])), registry)
    watched = TruthLocalizer({name: build_localizer(name, benchmark.robot, registry) for name in localizers}, wrong_by)
    benchmark.navigator.localizer = watched
    found = []
    with tempfile.TemporaryDirectory() as folder:
        for episode in range(episodes):
            benchmark.run(episode, Path(folder))
            found.append(watched.drive())
    return found


def build_localizer(preset: str, robot: Robot, registry: Registry) -> Localizer:
    """Build a localiser from its preset, with overrides after blanks; ROS's own values get the motion model
    that a ROS user would set.
    """
    name, *changes = preset.split()
    node = dict(to_plain(compose([f"localizer={name}", *(f"localizer.{change}" for change in changes)]))["localizer"])
    if node.get("odom", {}).get("model_type") == "diff" and robot.holonomic:
        node["odom"]["model_type"] = "omni"
    localizer: Localizer = registry.build("localizer", node, robot=robot)
    return localizer


def format_cell(found: Sequence[Drive], name: str) -> str:
    """Return one localiser's columns: mean and worst of the drives' mean errors, 95th percentile
    of all steps; then headings.
    """
    means = [float(drive.errors[name].mean()) for drive in found]
    steps, turns = (
        np.concatenate([errors[name] for errors in kind])
        for kind in ([d.errors for d in found], [d.turns for d in found])
    )
    place = f"{np.mean(means):.3f} ({max(means):.3f}) / {np.quantile(steps, 0.95):.3f}"
    return f"{place} | {np.degrees(turns.mean()):.1f} / {np.degrees(np.quantile(turns, 0.95)):.1f} |"


def main() -> None:
    """Print a Markdown table: mean error over each drive's steps, then mean and worst over the drives; the
    95th percentile of all steps.
    """
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "--world", action="append", help="overrides of one world, separated by blanks; may be given again"
    )
    parser.add_argument("--robot", action="append", help="may be given again")
    parser.add_argument(
        "--localizer",
        action="append",
        help="a preset, with overrides (KEY=VALUE) of it after blanks; may be given again",
    )
    parser.add_argument("--episodes", type=int, default=5)
    parser.add_argument("--people", type=int, default=5)
    parser.add_argument(
        "--wrong", type=float, nargs=3, default=(0.0, 0.0, 0.0), metavar=("X", "Y", "THETA"), help="error of the start"
    )
    given = parser.parse_args()
    localizers = given.localizer or ["amcl", "amcl_as_ros", "odometry"]
    print(
        "| world | robot | drives | metres |",
        *(f"{name}: mean (worst) / p95, m | mean / p95, deg |" for name in localizers),
    )
    print("| --- | --- | --- | --- |", *("--- | --- |" for _ in localizers))
    for world in given.world or ["world=warehouse"]:
        for robot in given.robot or ["turtlebot3", "jackal", "robotino"]:
            overrides = [*world.split(), f"robot={robot}", f"task.pedestrians={given.people}"]
            found = run_drives(overrides, localizers, given.episodes, Pose(*given.wrong))
            cells = (format_cell(found, name) for name in localizers)
            print(
                f"| {world.removeprefix('world=')} | {robot} | {len(found)} | "
                f"{sum(drive.travelled for drive in found):.0f} |",
                *cells,
            )


if __name__ == "__main__":
    main()
