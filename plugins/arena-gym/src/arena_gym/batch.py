"""N worlds that are driven in step: what single and vectorised environments are made of."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from arena_core import EarlierScans, ObservationBatch, OccupancyGrid, PathBatch, ScanMemory, Situation, Snapshot, Transition
from arena_gym.building import Parts
from arena_gym.episodes import Episode, draw_episode
from arena_gym.late_commands import LateCommands
from arena_gym.path_tracking import PathTracking
from arena_gym.range_noise import RangeNoise

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]
Slots = NDArray[np.int64]
STANDING = 0.05  # m/s: a robot slower than this stands, however it turns


@dataclass(frozen=True, slots=True, eq=False)
class Step:
    """What came of one control step in N worlds: observations (N, D), rewards (N,), and how episodes ended, if they did."""

    observations: NDArray[np.float32]
    rewards: Floats
    arrived: Flags
    collided: Flags
    timed_out: Flags
    terminated: Flags
    truncated: Flags


class NavigationBatch:
    """Drives N robots by the actions of a policy; slot k is bit for bit what it is alone.

    An episode ends when the robot is within its goal's radius, when it has collided too often, or when its time is over.
    ``steps`` and ``collisions`` (N,) count since the episodes began. ``stage`` is the level of a task that has any. ``seen`` is what
    was encoded last: a row for each robot after a step, for each that began anew after a reset.
    """

    seen: ObservationBatch
    _situation: Situation

    def __init__(self, parts: Parts, worlds: int) -> None:
        self.parts = parts
        self.worlds = worlds
        self.stage = parts.pool.staging.start if parts.pool.staging else None
        self.episodes: list[Episode] = []
        self.steps = np.zeros(worlds, np.int64)
        self.collisions = np.zeros(worlds, np.int64)
        self._ticks = round(parts.robot.control_period / parts.simulator.inner_step)
        self._seeds: list[int] = []
        self._numbers: list[int] = []
        self._tracking = PathTracking(worlds)
        self._late = LateCommands(worlds, parts.randomization.latency.high)
        self._noise = RangeNoise(parts.robot.lidar, worlds)
        self._memory = ScanMemory(parts.encoder.lookback, worlds, parts.robot.lidar.beams)
        self._recalled = parts.encoder.blank(worlds)
        self._goals = np.zeros((worlds, 3))
        self._goal_radii, self._time_limits = np.zeros(worlds), np.zeros(worlds)
        self._commands = np.zeros((worlds, 3))
        self._nearest = np.zeros(worlds)
        self._standing = np.zeros(worlds)

    def reset(self, seeds: Sequence[int]) -> NDArray[np.float32]:
        """Begin the first episodes of these seeds, one a world; return the observations (N, D)."""
        self._seeds, self._numbers = list(seeds), [0] * self.worlds
        self.episodes = [self._next_episode(slot) for slot in range(self.worlds)]
        snapshot = self.parts.simulator.reset([episode.problem.scenario for episode in self.episodes])
        return self._begin(np.arange(self.worlds), snapshot)

    def restart(self, slots: Slots) -> NDArray[np.float32]:
        """Begin the next episodes of these K worlds, the others go on; return the observations (K, D)."""
        for slot in slots.tolist():
            self.episodes[slot] = self._next_episode(slot)
        scenarios = [self.episodes[slot].problem.scenario for slot in slots.tolist()]
        return self._begin(slots, self.parts.simulator.reset(scenarios, slots))

    def set_stage(self, stage: int) -> None:
        """Let episodes that begin from now on be of this level of the task; raise ConfigurationError where there is none."""
        self.parts.pool.at_stage(stage)
        self.stage = stage

    def step(self, actions: NDArray[Any]) -> Step:
        """Drive for one control period by actions (N, A) in [-1, 1]."""
        return self.drive(self.parts.scale.commands(actions))

    def drive(self, commands: Floats) -> Step:
        """Drive for one control period by velocities (N, 3) in ``base_link``."""
        parts, before, last_commands = self.parts, self._situation, self._commands
        self._commands = commands
        snapshot = parts.simulator.advance(self._late.acting(self._commands), self._ticks)
        self.steps += 1
        ranges = self._noise.disturbed(snapshot.ranges, self.steps)
        waypoints = parts.waypoints.next(self._tracking.paths, snapshot.poses, snapshot.stamps).poses
        self._tracking.follow(snapshot.poses)
        self._nearest = ranges.min(axis=1).astype(np.float64)
        self._standing = self._stood(snapshot)
        self._situation = self._seen(snapshot)
        arrived, collided, timed_out = self._judge(snapshot)
        limit = parts.settings.collisions_to_end
        terminated = arrived if limit is None else arrived | (collided & (self.collisions >= limit))
        self._memory.remember(ranges, snapshot.poses)
        earlier = self._memory.earlier()
        paths, maps = self._tracking.paths, self._maps()
        self.seen = _observed(snapshot, ranges, self._goals, waypoints, self._commands, paths, earlier, maps, self._recalled)
        period = parts.robot.control_period
        rewards = parts.reward.reward(
            Transition(before, self._situation, self._commands, last_commands, arrived, collided, timed_out, period)
        )
        return Step(self._encoded(), rewards, arrived, collided, timed_out, terminated, timed_out & ~terminated)

    def _next_episode(self, slot: int) -> Episode:
        number = self._numbers[slot]
        self._numbers[slot] += 1
        pool = self.parts.pool if self.stage is None else self.parts.pool.at_stage(self.stage)
        return draw_episode(pool, self.parts.randomization, self._seeds[slot], number)

    def _begin(self, slots: Slots, snapshot: Snapshot) -> NDArray[np.float32]:
        """Note how the episodes of these slots begin; return what is seen there."""
        begun = [self.episodes[slot] for slot in slots.tolist()]
        scenarios = [episode.problem.scenario for episode in begun]
        self._goals[slots] = [scenario.goal.array() for scenario in scenarios]
        self._goal_radii[slots] = [scenario.goal_radius for scenario in scenarios]
        self._time_limits[slots] = [scenario.time_limit for scenario in scenarios]
        self._commands = self._commands.copy()
        self._commands[slots], self.steps[slots], self.collisions[slots] = 0.0, 0, 0
        self._tracking.begin(slots, [episode.problem for episode in begun])
        self._late.begin(slots, [episode.latency for episode in begun])
        self._noise.begin(slots, begun)
        self.parts.waypoints.reset(slots, self.worlds)
        ranges = self._noise.disturbed(snapshot.ranges, self.steps)
        self._nearest[slots], self._standing[slots] = ranges[slots].min(axis=1), 0.0
        self._situation = self._seen(snapshot)
        waypoints = np.array([episode.problem.waypoint for episode in begun])
        paths = PathBatch.of([episode.problem.path for episode in begun])
        self._memory.begin(slots, ranges[slots], snapshot.poses[slots])
        self._recalled[slots] = 0.0
        earlier = self._memory.earlier(slots)
        maps = tuple(_map_of(episode) for episode in begun)
        self.seen = _observed(snapshot, ranges, self._goals, waypoints, self._commands, paths, earlier, maps, self._recalled, slots)
        return self._encoded(slots)

    def _encoded(self, slots: Slots | slice = slice(None)) -> NDArray[np.float32]:
        """Return the encoder's numbers for what these slots have just seen, and keep them where it recalls them a step later."""
        rows = self.parts.encoder.encode(self.seen)
        if self.parts.encoder.recurrent:
            self._recalled[slots] = rows
        return rows

    def _maps(self) -> tuple[OccupancyGrid | None, ...]:
        return tuple(_map_of(episode) for episode in self.episodes)

    def _seen(self, snapshot: Snapshot) -> Situation:
        """Return the truth that rewards see."""
        progress = self._tracking.progress.copy()
        return Situation(
            snapshot.poses,
            snapshot.twists,
            np.hypot(snapshot.poses[:, 0] - self._goals[:, 0], snapshot.poses[:, 1] - self._goals[:, 1]),
            progress[:, 0],
            progress[:, 1],
            snapshot.clearances,
            snapshot.clearances_people,
            self._nearest.copy(),
            self._standing.copy(),
        )

    def _stood(self, snapshot: Snapshot) -> Floats:
        """Return for how long each robot has stood, s."""
        stands = np.hypot(snapshot.twists[:, 0], snapshot.twists[:, 1]) < STANDING
        return np.where(stands, self._standing + self.parts.robot.control_period, 0.0)

    def _judge(self, snapshot: Snapshot) -> tuple[Flags, Flags, Flags]:
        """Return who arrived, who collided, and whose time is over, in the order of a benchmark's judge."""
        arrived = self._situation.goal_distances <= self._goal_radii
        collisions = np.array([len(contacts) for contacts in snapshot.contacts])
        self.collisions += collisions
        return arrived, (collisions > 0) & ~arrived, (snapshot.stamps >= self._time_limits - 1e-9) & ~arrived


def _observed(
    snapshot: Snapshot,
    ranges: NDArray[np.float32],
    goals: Floats,
    waypoints: Floats,
    last_commands: Floats,
    paths: PathBatch,
    earlier: EarlierScans,
    maps: tuple[OccupancyGrid | None, ...],
    recalled: NDArray[np.float32],
    slots: Slots | slice = slice(None),
) -> ObservationBatch:
    """Return what the robots in these slots see, whose waypoints and paths are given; the pose estimate is the truth."""
    return ObservationBatch(
        snapshot.stamps[slots],
        ranges[slots],
        snapshot.poses[slots],
        snapshot.odometry_twists[slots],
        goals[slots],
        waypoints,
        last_commands[slots],
        paths,
        earlier,
        maps,
        recalled[slots].copy(),
    )


def _map_of(episode: Episode) -> OccupancyGrid | None:
    world = episode.problem.scenario.world
    return world.grid if world.known else None
