"""Measure trackers against the truth of simulated drives: all trackers on the same scans, as
any planner would meet them.
"""

from __future__ import annotations

import argparse
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

from arena_core import (
    NO_TRACKS,
    EpisodeRecord,
    EpisodeStart,
    LaserScan,
    Observation,
    OccupancyGrid,
    Planner,
    Pose,
    Robot,
    Tracker,
    Tracks,
    Twist,
)
from arena_core.config.configuration import compose, to_plain
from arena_core.config.registry import load_registry
from arena_core.hosting import build_benchmark

NEAR = 5.0  # m from the robot: who is farther away is not counted
VISIBLE = 5  # returns that a person must send to be in sight
SAME = 0.5  # m between a track and the person that it follows, at most


@dataclass(slots=True, eq=False)
class RecordingTracker(Tracker):
    """Writes down what a tracker is told, and tells of nothing."""

    grid: OccupancyGrid | None = None
    steps: list[tuple[LaserScan, Pose, float]] = field(default_factory=list)

    def reset(self, grid: OccupancyGrid | None) -> None:
        """Begin a new page."""
        self.grid, self.steps = grid, []

    def update(self, scan: LaserScan, pose: Pose, stamp: float) -> Tracks:
        """Note a scan."""
        self.steps.append((scan, pose, stamp))
        return NO_TRACKS


@dataclass(slots=True, eq=False)
class TrackingPlanner(Planner):
    """Asks for tracks at every step, then does what another planner does."""

    planner: Planner

    def reset(self, episode: EpisodeStart) -> None:
        """Begin an episode."""
        self.planner.reset(episode)

    def compute_velocity(self, observation: Observation) -> Twist:
        """Return the other planner's command."""
        assert observation.tracks is NO_TRACKS
        return self.planner.compute_velocity(observation)


@dataclass(frozen=True, slots=True, eq=False)
class Drive:
    """One episode: what a tracker was told at each of T steps, and what was true."""

    robot: Robot
    grid: OccupancyGrid | None
    steps: list[tuple[LaserScan, Pose, float]]
    record: EpisodeRecord


@dataclass(slots=True, eq=False)
class Score:
    """Errors of tracks of people in sight (m, m/s), and counts over all drives; ``seconds`` driven."""

    position_errors: list[float] = field(default_factory=list)
    velocity_errors: list[float] = field(default_factory=list)
    seen: int = 0
    found: int = 0
    false_tracks: int = 0
    switches: int = 0
    seconds: float = 0.0

    def cells(self) -> list[str]:
        """Return the score as cells of a table."""
        minutes = self.seconds / 60.0
        return [
            f"{np.median(self.position_errors):.3f} ({np.quantile(self.position_errors, 0.95):.2f})",
            f"{np.median(self.velocity_errors):.3f} ({np.quantile(self.velocity_errors, 0.95):.2f})",
            f"{self.found / max(self.seen, 1):.3f}",
            f"{self.false_tracks / minutes:.2f}",
            f"{self.switches / minutes:.2f}",
        ]


def run_drives(overrides: Sequence[str], episodes: int) -> Iterator[Drive]:
    """Run episodes of ``arena run OVERRIDES``."""
    benchmark = build_benchmark(to_plain(compose(list(overrides))), load_registry())
    benchmark.navigator.tracker = notebook = RecordingTracker()
    benchmark.navigator.planner = TrackingPlanner(benchmark.navigator.planner)
    with tempfile.TemporaryDirectory() as folder:
        for episode in range(episodes):
            record = benchmark.run(episode, Path(folder))
            yield Drive(benchmark.robot, notebook.grid, notebook.steps, record)


def build_tracker(preset: str, robot: Robot, overrides: Sequence[str] = ()) -> Tracker:
    """Build a tracker from its preset."""
    node = to_plain(compose([f"tracker={preset}", *overrides]))["tracker"]
    tracker: Tracker = load_registry().build("tracker", node, robot=robot)
    return tracker


def track_drive(tracker: Tracker, drive: Drive) -> list[Tracks]:
    """Return the tracks at each step of a drive."""
    tracker.reset(drive.grid)
    return [tracker.update(scan, pose, stamp) for scan, pose, stamp in drive.steps]


def tracks_from_truth(drive: Drive, told: Sequence[Tracks]) -> list[Tracks]:
    """Return the tracks (without covariances) as if the robot had known where it was: for localisers that drift."""
    moved = []
    for (_, pose, stamp), tracks in zip(drive.steps, told, strict=True):
        true = Pose.of(drive.record["pose"][int(np.argmin(np.abs(drive.record["stamp"] - stamp)))])
        c, s = np.cos(true.theta - pose.theta), np.sin(true.theta - pose.theta)
        turn = np.array(((c, s), (-s, c)))
        positions = (tracks.positions - (pose.x, pose.y)) @ turn + (true.x, true.y)
        moved.append(replace(tracks, positions=positions, velocities=tracks.velocities @ turn))
    return moved


def add_errors(score: Score, drive: Drive, told: Sequence[Tracks]) -> None:
    """Compare tracks with the truth; a track keeps its person while it is near it (Bernardin and
    Stiefelhagen 2008, CLEAR MOT).
    """
    record, rows = drive.record, {round(float(s), 6): k for k, s in enumerate(drive.record["stamp"])}
    person_of: dict[int, int] = {}
    track_of: dict[int, int] = {}
    life: dict[int, list[int]] = {}
    for (scan, _, stamp), tracks in zip(drive.steps, told, strict=True):
        row = rows[round(stamp, 6)]
        people, velocities = (
            record["pedestrian_positions"][row].astype(float),
            record["pedestrian_velocities"][row].astype(float),
        )
        in_sight = visible_people(scan, Pose.of(record["pose"][row]), people, record["pedestrian_radii"])
        person_of = match_tracks(tracks, people, person_of)
        for k, number in enumerate(tracks.ids.tolist()):
            person = person_of.get(number)
            life.setdefault(number, [0, 0])[person is not None] += 1
            if person is None:
                continue
            if in_sight[person]:
                score.switches += track_of.get(person, number) != number
                track_of[person] = number
                score.found += 1
                score.position_errors.append(float(np.hypot(*(tracks.positions[k] - people[person]))))
                score.velocity_errors.append(float(np.hypot(*(tracks.velocities[k] - velocities[person]))))
        track_of = {person: number for person, number in track_of.items() if in_sight[person]}
        score.seen += int(in_sight.sum())
    score.false_tracks += sum(off > on for off, on in life.values())
    score.seconds += float(record["stamp"][-1])


def visible_people(
    scan: LaserScan, pose: Pose, people: NDArray[np.float64], radii: NDArray[np.float64]
) -> NDArray[np.bool_]:
    """Tell who is near and sends enough returns; the scan as it was seen from the true pose."""
    sensor = pose.compose(scan.mount)
    hit = np.isfinite(scan.ranges)
    angles = sensor.theta + scan.angle_min + scan.angle_increment * np.flatnonzero(hit)
    ends = np.column_stack((sensor.x + scan.ranges[hit] * np.cos(angles), sensor.y + scan.ranges[hit] * np.sin(angles)))
    on_body = np.hypot(*(ends[:, None] - people).transpose(2, 0, 1)) < radii + 0.05
    near = np.hypot(people[:, 0] - pose.x, people[:, 1] - pose.y) < NEAR
    return near & (on_body.sum(axis=0) >= VISIBLE)


def match_tracks(tracks: Tracks, people: NDArray[np.float64], before: dict[int, int]) -> dict[int, int]:
    """Return which person each track follows: the one before while it is near, else the nearest ones in sum."""
    away = np.hypot(*(tracks.positions[:, None] - people).transpose(2, 0, 1))
    ids = tracks.ids.tolist()
    kept = {n: before[n] for k, n in enumerate(ids) if n in before and away[k, before[n]] < SAME}
    rows = [k for k, n in enumerate(ids) if n not in kept]
    columns = [p for p in range(len(people)) if p not in kept.values()]
    costs = np.where(away < SAME, away, 1e3)[np.ix_(rows, columns)]
    for r, c in zip(*linear_sum_assignment(costs), strict=True):
        if costs[r, c] < SAME:
            kept[ids[rows[r]]] = columns[c]
    return kept


def main() -> None:
    """Print a Markdown table: median (95 % quantile) of the errors over all people in sight and steps, then counts."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "--world", action="append", help="overrides of one world, separated by blanks; may be given again"
    )
    parser.add_argument("--robot", action="append", help="may be given again")
    parser.add_argument("--localizer", action="append", help="may be given again")
    parser.add_argument("--speed", action="append", type=float, help="the people's, m/s; may be given again")
    parser.add_argument(
        "--tracker", action="append", help="a preset and overrides, separated by blanks; may be given again"
    )
    parser.add_argument("--episodes", type=int, default=5)
    parser.add_argument("--people", type=int, default=5)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument(
        "--relative",
        action="store_true",
        help="compare as seen from the robot, not in the map: for localisers that drift",
    )
    given = parser.parse_args()
    print(
        "| world | robot | localizer | people m/s | tracker | position m | velocity m/s | recall | false / min | "
        "switches / min |"
    )
    print("| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |")
    for world in given.world or ["world=warehouse"]:
        for robot in given.robot or ["turtlebot3", "jackal", "robotino"]:
            for localizer in given.localizer or ["ground_truth", "amcl"]:
                for speed in given.speed or [0.3, 1.0, 1.5]:
                    crowd = [f"task.pedestrians={given.people}", f"task.people.speed={speed}", f"seed={given.seed}"]
                    found = list(
                        run_drives([*world.split(), f"robot={robot}", f"localizer={localizer}", *crowd], given.episodes)
                    )
                    for tracker in given.tracker or ["kalman"]:
                        preset, *overrides = tracker.split()
                        score = Score()
                        built = build_tracker(preset, found[0].robot, overrides)
                        for drive in found:
                            told = track_drive(built, drive)
                            add_errors(score, drive, tracks_from_truth(drive, told) if given.relative else told)
                        name = world.removeprefix("world=")
                        print(
                            "|",
                            " | ".join((name, robot, localizer, f"{speed:g}", tracker, *score.cells())),
                            "|",
                            flush=True,
                        )


if __name__ == "__main__":
    main()
