"""N worlds that are driven in step: what single, vectorised and team environments are made of."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from arena_core import (
    ConfigurationError,
    EarlierScans,
    ObservationBatch,
    OccupancyGrid,
    ScanMemory,
    Snapshot,
    Transition,
)
from arena_core.hosting import EpisodeLoop, Guide, Situation, Truth, WorldTruth
from arena_gym.batched_guidance import BatchedGuidance
from arena_gym.building import Parts
from arena_gym.episodes import Episode, EpisodeKey, draw_episode, draw_stage
from arena_gym.guidance import Guidance, GuidanceOutput, NavigatorGuidance, PathGuidance
from arena_gym.modelled_tracks import ModelledTracks
from arena_gym.path_tracking import PathTracking
from arena_gym.range_noise import RangeNoise
from arena_gym.shared_guidance import SharedGuidance

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]
Slots = NDArray[np.int64]
STANDING = 0.05  # m/s: a robot slower than this stands, however it turns


@dataclass(frozen=True, slots=True, eq=False)
class Step:
    """What came of one control step in N worlds: observations (N, D), rewards (N,), and how
    episodes ended, if they did.
    """

    observations: NDArray[np.float32]
    rewards: Floats
    arrived: Flags
    mistaken: Flags
    collided: Flags
    timed_out: Flags
    terminated: Flags
    truncated: Flags


class NavigationBatch:
    """Drives N robots by the actions of a policy; slot k is bit for bit what it is alone.

    In ``worlds`` of ``team`` robots each the arrays of N have a row for each robot, those of a world one after another.

    An episode ends when the robot believes to be within its goal's radius, when it has collided too often, or when its
    time is over. A robot whose episode ends while its action still holds stands until all have driven so long.
    ``reward`` judges the steps, and may be changed. ``steps`` (N,) count since the episodes began. ``stage`` is the
    level of a task that has any; ``keys`` are what the running episodes were drawn from. ``seen`` is what was encoded
    last: a row for each robot after a step, for each that began again after a reset.
    """

    seen: ObservationBatch
    _situation: Situation

    def __init__(self, parts: Parts, worlds: int, *, team: int = 1) -> None:
        self.parts = parts
        self.worlds, self.robots, self._team = worlds, worlds * team, team
        self.stage = parts.pool.staging.start if parts.pool.staging else None
        self.episodes: list[Episode] = []
        self.keys: list[EpisodeKey] = []
        self.steps = np.zeros(self.robots, np.int64)
        self._steps_of_action = parts.settings.every
        self.loop = EpisodeLoop(
            parts.simulator, parts.robot.control_period, worlds, parts.settings.collisions_to_end, team=team
        )
        self._stage_weights: tuple[float, ...] | None = None
        self._guidance = make_guidance(parts, self.loop)
        self.reward = parts.reward
        self._tracking = PathTracking(self.robots)
        self._delays = np.zeros(self.robots, np.int64)
        self._noise = RangeNoise(parts.robot.lidar, self.robots)
        self._memory = ScanMemory(parts.encoder.lookback, self.robots, parts.robot.lidar.beams)
        self._recalled = parts.encoder.blank(self.robots)
        self._commands = np.zeros((self.robots, 3))
        self._nearest = np.zeros(self.robots)
        self._standing = np.zeros(self.robots)
        limit = parts.settings.standing_to_end
        self._standing_to_end = np.inf if limit is None else limit - 1e-9

    @property
    def collisions(self) -> Slots:
        """Return how many collisions each episode has had so far, (N,)."""
        return self.loop.collisions

    @property
    def snapshot(self) -> Snapshot:
        """Return what is true now."""
        return self.loop.snapshot

    def reset(self, seeds: Sequence[int]) -> NDArray[np.float32]:
        """Begin the first episodes of these seeds, one a world; return the observations (N, D)."""
        return self.begin_at([self._episode_key(seed, 0) for seed in seeds])

    def begin_at(self, keys: Sequence[EpisodeKey]) -> NDArray[np.float32]:
        """Begin these episodes, one a world; return the observations (N, D)."""
        self.keys = list(keys)
        self.episodes = [episode for key in self.keys for episode in self._draw_episodes(key)]
        snapshot = self.loop.begin([episode.problem.scenario for episode in self.episodes[:: self._team]])
        return self._begin_episodes(np.arange(self.robots), snapshot)

    def restart(self, slots: Slots) -> NDArray[np.float32]:
        """Begin the next episodes of these K worlds, the others go on; return the observations (K, D)."""
        for slot in slots.tolist():
            self.keys[slot] = self._episode_key(self.keys[slot].seed, self.keys[slot].number + 1)
            first = slot * self._team
            self.episodes[first : first + self._team] = self._draw_episodes(self.keys[slot])
        return self.begin_again(slots)

    def begin_again(self, slots: Slots) -> NDArray[np.float32]:
        """Begin the same episodes of these K worlds once more, the others go on; return the observations (K, D)."""
        scenarios = [self.episodes[slot * self._team].problem.scenario for slot in slots.tolist()]
        robots = (slots[:, None] * self._team + np.arange(self._team)).reshape(-1)
        return self._begin_episodes(robots, self.loop.begin(scenarios, slots))

    @property
    def led_by_model(self) -> bool:
        """Return whether a model stands for the real parts of the robots' guides."""
        return isinstance(self._guidance, BatchedGuidance)

    def lead_by_real_parts(self) -> None:
        """Let the real parts of guides lead all robots; to be called ahead of ``restart`` of all, or ``begin_at``."""
        self.replace_guidance(make_guidance(replace(self.parts, guidance_model=None), self.loop))

    def replace_guidance(self, guidance: Guidance) -> None:
        """Let another guidance lead all robots; to be called ahead of ``reset`` or ``begin_at``."""
        self._guidance = guidance

    def truth(self, slot: int) -> Truth:
        """Return the truth of a world, for privileged parts of whoever drives there."""
        return WorldTruth(self.loop, slot, self.episodes[slot].problem.scenario)

    def set_stage(self, stage: int) -> None:
        """Let episodes that begin from now on be of this level of the task; raise
        ConfigurationError where there is none.
        """
        self.parts.pool.at_stage(stage)
        self.stage, self._stage_weights = stage, None

    def mix_stages(self, weights: Sequence[float]) -> None:
        """Let each episode that begins from now on draw its level, with these weights of all levels."""
        self._stage_weights = tuple(weights)

    def step(self, actions: NDArray[Any]) -> Step:
        """Drive by actions (N, A) in [-1, 1] for as many control steps as one holds; rewards add up."""
        return self.step_some(actions, np.ones(self.robots, bool))

    def step_some(self, actions: NDArray[Any], driving: Flags) -> Step:
        """As ``step``, for the robots that are ``driving`` (N,); the others brake and stand. What comes of it is of use
        for those who drive alone.
        """
        total = self._drive_control_step(actions, driving)
        for _ in range(self._steps_of_action - 1):
            goes_on = driving & ~(total.terminated | total.truncated)
            if goes_on.any():
                total = _join_steps(total, self._drive_control_step(actions, goes_on), goes_on)
        return total

    def _commanded_velocities(self, actions: NDArray[Any], driving: Flags) -> Floats:
        """Return the velocities (N, 3) that ``actions`` ask for at one control step, of use for
        those that are ``driving`` (N,).
        """
        return self.parts.scale.commands(actions)

    def _drive_control_step(self, actions: NDArray[Any], driving: Flags) -> Step:
        """Let the robots that are ``driving`` (N,) do so for one control step; return what came
        of it, of use for those alone.
        """
        steps, collisions = self.steps.copy(), self.collisions.copy()
        step = self.drive(np.where(driving[:, None], self._commanded_velocities(actions, driving), 0.0))
        self.steps, self.loop.collisions = (
            np.where(driving, self.steps, steps),
            np.where(driving, self.collisions, collisions),
        )
        return step

    def drive(self, commands: Floats) -> Step:
        """Drive for one control period by velocities (N, 3) in ``base_link``."""
        parts, before, last_commands = self.parts, self._situation, self._commands
        self._commands = commands
        snapshot = self.loop.drive(commands, self._delays)
        self.steps += 1
        ranges = self._noise.add_noise(snapshot.ranges, self.steps)
        guided = self._guidance.look(snapshot, ranges)
        if guided.new_paths:
            self._tracking.replace_paths(guided.new_paths, snapshot.poses)
        self._tracking.follow(snapshot.poses)
        self._nearest = ranges.min(axis=1).astype(np.float64)
        self._standing = self._standing_times(snapshot)
        self._situation = self._current_situation(snapshot)
        before = _on_new_paths(before, self._situation, guided)
        verdicts = self.loop.judge(guided.arrived)
        arrived, collided = verdicts.arrived, verdicts.collided
        timed_out = verdicts.timed_out | ((self._standing >= self._standing_to_end) & ~guided.arrived)
        terminated = arrived | verdicts.mistaken | verdicts.failed
        self._memory.remember(ranges, guided.poses)
        self.seen = self._make_observations(snapshot, ranges, guided, self._memory.earlier())
        period = parts.robot.control_period
        rewards = self.reward.reward(
            Transition(before, self._situation, self._commands, last_commands, arrived, collided, timed_out, period)
        )
        return Step(
            self._encode_observations(),
            rewards,
            arrived,
            verdicts.mistaken,
            collided,
            timed_out,
            terminated,
            timed_out & ~terminated,
        )

    def _episode_key(self, seed: int, number: int) -> EpisodeKey:
        """Return what episode ``number`` of a seed is drawn from, as levels are now."""
        weights = self._stage_weights
        return EpisodeKey(seed, number, self.stage if weights is None else draw_stage(weights, seed, number))

    def _draw_episodes(self, key: EpisodeKey) -> tuple[Episode, ...]:
        """Return an episode of a world, as each of its robots faces it; the first one's scenario is the whole team's.

        Raises ConfigurationError where its problem has another number of robots.
        """
        pool = self.parts.pool if key.stage is None else self.parts.pool.at_stage(key.stage)
        episode = draw_episode(pool, self.parts.randomization, key.seed, key.number)
        robots = (episode, *episode.mates)
        if len(robots) != self._team:
            name = episode.problem.scenario.name
            raise ConfigurationError(
                f"{name} has {len(robots)} robots; allowed here: {self._team} (arena_gym.team_env drives teams)"
            )
        return robots

    def _begin_episodes(self, slots: Slots, snapshot: Snapshot) -> NDArray[np.float32]:
        """Note how the episodes of these slots begin; return what is seen there."""
        begun = [self.episodes[slot] for slot in slots.tolist()]
        self._commands = self._commands.copy()
        self._commands[slots], self.steps[slots] = 0.0, 0
        self._tracking.begin(slots, [episode.problem for episode in begun])
        self._delays[slots] = [episode.latency * self.loop.ticks for episode in begun]
        self._noise.begin(slots, begun)
        ranges = self._noise.add_noise(snapshot.ranges, self.steps)
        self._nearest[slots], self._standing[slots] = ranges[slots].min(axis=1), 0.0
        self._situation = self._current_situation(snapshot)
        guided = self._guidance.begin(slots, [episode.problem for episode in begun], snapshot, ranges)
        self._memory.begin(slots, ranges[slots], guided.poses)
        self._recalled[slots] = 0.0
        self.seen = self._make_observations(snapshot, ranges, guided, self._memory.earlier(slots), slots)
        return self._encode_observations(slots)

    def _encode_observations(self, slots: Slots | slice = slice(None)) -> NDArray[np.float32]:
        """Return the encoder's numbers for what these slots have just seen, and keep them where
        it recalls them a step later.
        """
        rows = self.parts.encoder.encode(self.seen)
        if self.parts.encoder.recurrent:
            self._recalled[slots] = rows
        return rows

    def _make_observations(
        self,
        snapshot: Snapshot,
        ranges: NDArray[np.float32],
        guided: GuidanceOutput,
        earlier: EarlierScans,
        slots: Slots | None = None,
    ) -> ObservationBatch:
        """Return what the robots in these slots see, all of them where none are named."""
        rows = np.arange(self.robots) if slots is None else slots
        return ObservationBatch(
            snapshot.stamps[rows],
            ranges[rows],
            guided.poses,
            snapshot.odometry_twists[rows],
            self.loop.goals[rows],
            guided.waypoints,
            self._commands[rows],
            guided.paths,
            earlier,
            tuple(_map_of(self.episodes[slot]) for slot in rows.tolist()),
            self._recalled[rows],
            None if snapshot.depths is None else snapshot.depths[rows],
            guided.tracks,
            guided.predictions,
        )

    def _current_situation(self, snapshot: Snapshot) -> Situation:
        """Return the truth that rewards see."""
        progress = self._tracking.progress.copy()
        return Situation(
            snapshot.poses,
            snapshot.twists,
            self.loop.goal_distances(),
            progress[:, 0],
            progress[:, 1],
            snapshot.clearances,
            snapshot.clearances_people,
            self._nearest.copy(),
            self._standing.copy(),
        )

    def _standing_times(self, snapshot: Snapshot) -> Floats:
        """Return for how long each robot has stood, s."""
        stands = np.hypot(snapshot.twists[:, 0], snapshot.twists[:, 1]) < STANDING
        return np.where(stands, self._standing + self.parts.robot.control_period, 0.0)


def make_guidance(parts: Parts, loop: EpisodeLoop) -> Guidance:
    """Return what leads the robots: their first paths, or guides, which share what they can.

    Raises ConfigurationError where the observation has tracks and no one tracks.
    """
    if parts.encoder.tracked and (parts.make_guide is None or parts.config["guide"]["tracker"]["name"] == "none"):
        said = "guide is null" if parts.make_guide is None else "guide.tracker is none"
        raise ConfigurationError(
            f"{said}; allowed: a guide (driving or navigator) with a tracker (tracker@guide.tracker=kalman), "
            "whose tracks are observed"
        )
    if parts.make_guide is None:
        return PathGuidance(parts.waypoints, loop.robots)
    if parts.guidance_model is not None:
        return _model_guidance(parts, parts.make_guide(), loop.robots)
    if SharedGuidance.can_share(parts.make_guide()):
        return SharedGuidance(parts.make_guide, parts.waypoints, loop, tracked=parts.encoder.tracked)
    return NavigatorGuidance(parts.make_guide, loop, tracked=parts.encoder.tracked)


def _model_guidance(parts: Parts, guide: Guide, worlds: int) -> Guidance:
    """Return guidance by a model of the real parts."""
    model = parts.guidance_model
    assert model is not None
    tracker = parts.config["guide"]["tracker"]
    tracks = ModelledTracks(model.tracks, tracker, parts.robot, worlds) if parts.encoder.tracked else None
    return BatchedGuidance(guide, model, tracks, parts.waypoints, worlds)


def _on_new_paths(before: Situation, after: Situation, guided: GuidanceOutput) -> Situation:
    """Return the situation before a step with the progress after it where the path is new:
    no one gains by replanning.
    """
    if not guided.new_paths:
        return before
    slots = list(guided.new_paths)
    left, beside = before.path_lengths_left.copy(), before.path_distances.copy()
    left[slots], beside[slots] = after.path_lengths_left[slots], after.path_distances[slots]
    return replace(before, path_lengths_left=left, path_distances=beside)


def _map_of(episode: Episode) -> OccupancyGrid | None:
    world = episode.problem.scenario.world
    return world.grid if world.known else None


def _join_steps(first: Step, then: Step, goes_on: Flags) -> Step:
    """Return two steps in a row as one, of which only those that go on took the second."""
    flags = {
        name: getattr(first, name) | (getattr(then, name) & goes_on)
        for name in ("arrived", "mistaken", "collided", "timed_out", "terminated", "truncated")
    }
    observations = np.where(goes_on[:, None], then.observations, first.observations)
    return replace(first, observations=observations, rewards=first.rewards + goes_on * then.rewards, **flags)
