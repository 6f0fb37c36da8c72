"""How alike two guidances are: what both make of the same worlds at the same steps, as statistics against the truth."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from arena_core import Pose, Snapshot, Tracks
from arena_gym.batch import NavigationBatch, make_guidance
from arena_gym.building import build_parts
from arena_gym.guidance import Floats, Guidance, GuidanceOutput, Ranges, Slots
from arena_gym.pool import Problem

RINGS = (2.0, 4.0, 6.0, 8.0)  # m from the robot, up to which people are told apart
VISIBLE = 5  # returns that a person sends who is in sight
SAME = 0.5  # m between a track and the person it follows, at most


class BothGuidances(Guidance):
    """Robots that the first guidance leads, while the second is shown the same; ``last`` is what each said."""

    def __init__(self, first: Guidance, second: Guidance) -> None:
        self._both = first, second
        self.last: tuple[GuidanceOutput, ...] = ()

    def begin(self, slots: Slots, problems: Sequence[Problem], snapshot: Snapshot, ranges: Ranges) -> GuidanceOutput:
        """Begin in both."""
        first, _ = (one.begin(slots, problems, snapshot, ranges) for one in self._both)
        return first

    def look(self, snapshot: Snapshot, ranges: Ranges) -> GuidanceOutput:
        """Look with both."""
        self.last = tuple(one.look(snapshot, ranges) for one in self._both)
        return self.last[0]


@dataclass(slots=True, eq=False)
class GuidanceTally:
    """What one guidance knew, gathered over steps; keys of ``seen`` ... are rings."""

    seen: dict[int, int] = field(default_factory=lambda: defaultdict(int))
    found: dict[int, int] = field(default_factory=lambda: defaultdict(int))
    places: dict[int, list[float]] = field(default_factory=lambda: defaultdict(list))
    speeds: dict[int, list[float]] = field(default_factory=lambda: defaultdict(list))
    radii: list[float] = field(default_factory=list)
    delays: list[float] = field(default_factory=list)
    coasting: list[float] = field(default_factory=list)
    poses: list[float] = field(default_factory=list)
    ahead: list[float] = field(default_factory=list)
    beside: list[float] = field(default_factory=list)
    others: int = 0
    paths: int = 0
    steps: int = 0
    _waiting: dict[tuple[int, int], float] = field(default_factory=dict)

    def rows(self, period: float) -> dict[str, float]:
        """Return the statistics by name; ``period`` s is the time of a step."""
        minutes = self.steps * period / 60.0
        found = {
            "tracks that are no person, mean of a robot": self.others / max(self.steps, 1),
            "new paths, 1/min": self.paths / minutes,
            "pose error, median m": _median(self.poses),
            "path ahead, mean m": _mean(self.ahead),
            "distance to the path, mean m": _mean(self.beside),
            "radius error, mean m": _mean(self.radii),
            "radius error, deviation m": float(np.std(self.radii)) if self.radii else math.nan,
            "delay until told, median s": _median(self.delays),
            "delay until told, mean s": _mean(self.delays),
            "hidden people still told of, share": _mean(self.coasting),
        }
        for ring, far in enumerate(RINGS):
            if self.seen[ring]:
                found[f"found up to {far:g} m, share"] = self.found[ring] / self.seen[ring]
                for name, errors in (("position", self.places[ring]), ("velocity", self.speeds[ring])):
                    found[f"{name} error up to {far:g} m, median"] = _median(errors)
                    found[f"{name} error up to {far:g} m, 95 %"] = _quantile(errors, 0.95)
        return found

    def add_robot(self, slot: int, known: tuple[Pose, Tracks], truth: tuple[Snapshot, Ranges], left: float) -> None:
        """Compare one robot's tracks, seen from where it believes to be, with the people about it."""
        snapshot, ranges = truth
        pose, tracks = known
        true = Pose.of(snapshot.poses[slot])
        self.poses.append(true.distance(pose))
        self.ahead.append(left)
        people, velocities = snapshot.crowd.positions[slot], snapshot.crowd.velocities[slot]
        turn = _turned(true.theta - pose.theta)
        places = (tracks.positions - (pose.x, pose.y)) @ turn.T + (true.x, true.y)
        away = np.hypot(*(people - (true.x, true.y)).T)
        returns = _returns_of(snapshot, slot, ranges)
        stamp, taken = float(snapshot.stamps[slot]), set()
        for person in np.flatnonzero(away < RINGS[-1]).tolist():
            radius = float(snapshot.crowd.radii[slot, person])
            on = int((np.hypot(*(returns - people[person]).T) < radius + 0.05).sum())
            off = np.hypot(*(places - people[person]).T) if len(places) else np.empty(0)
            nearest = int(off.argmin()) if len(off) else -1
            told = nearest >= 0 and off[nearest] < SAME
            if told:
                taken.add(nearest)
            if on < VISIBLE:
                self._waiting.pop((slot, person), None)
                if on == 0:
                    self.coasting.append(float(told))
                continue
            ring = int(np.searchsorted(RINGS, away[person]))
            self.seen[ring] += 1
            self._note_delay((slot, person), stamp, told=told)
            if told:
                self.found[ring] += 1
                self.places[ring].append(float(off[nearest]))
                velocity = turn @ tracks.velocities[nearest]
                self.speeds[ring].append(float(np.hypot(*(velocity - velocities[person]))))
                self.radii.append(float(tracks.radii[nearest]) - radius)
        self.others += len(places) - len(taken)
        self.steps += 1

    def _note_delay(self, who: tuple[int, int], stamp: float, *, told: bool) -> None:
        """Note how long someone has been in sight when first told of, unless that was at once."""
        began = self._waiting.setdefault(who, stamp)
        if told and began >= 0.0:
            if stamp > began:
                self.delays.append(stamp - began)
            self._waiting[who] = -1.0

    def forget(self, slots: set[int]) -> None:
        """Take in that other episodes begin in some slots."""
        self._waiting = {who: since for who, since in self._waiting.items() if who[0] not in slots}


def compare_guidances(
    configs: tuple[Mapping[str, Any], Mapping[str, Any]], worlds: int, steps: int
) -> tuple[dict[str, float], dict[str, float]]:
    """Return the statistics of two guidances in the same episodes, which the first one leads.

    Robots steer for their waypoints and stop for what is near.
    """
    first, second = (build_parts(config) for config in configs)
    batch = NavigationBatch(first, worlds)
    both = BothGuidances(make_guidance(first, batch.loop), make_guidance(second, batch.loop))
    batch.replace_guidance(both)
    batch.reset(range(worlds))
    tallies = GuidanceTally(), GuidanceTally()
    for _ in range(steps):
        step = batch.drive(_steer(batch))
        for tally, said in zip(tallies, both.last, strict=True):
            _tally_step(tally, said, batch.snapshot)
        ended = np.flatnonzero(step.terminated | step.truncated)
        if len(ended):
            batch.restart(ended)
            for tally in tallies:
                tally.forget(set(ended.tolist()))
    period = first.robot.control_period
    return tallies[0].rows(period), tallies[1].rows(period)


def _tally_step(tally: GuidanceTally, said: GuidanceOutput, snapshot: Snapshot) -> None:
    tally.paths += len(said.new_paths)
    for slot in range(len(said.poses)):
        path = said.paths.poses[said.paths.offsets[slot] : said.paths.offsets[slot + 1], :2]
        off = np.hypot(*(path - said.poses[slot, :2]).T)
        at = int(off.argmin())
        left = float(np.hypot(*np.diff(path[at:], axis=0).T).sum())
        tally.beside.append(float(off[at]))
        tally.add_robot(slot, (Pose.of(said.poses[slot]), said.tracks[slot]), (snapshot, snapshot.ranges), left)


def _steer(batch: NavigationBatch) -> Floats:
    """Return velocities (N, 3) towards the waypoints, none forwards where something is near."""
    poses, waypoints, limits = batch.seen.poses, batch.seen.waypoints, batch.parts.robot.limits
    if len(poses) < batch.worlds:  # some have begun again: all are known a step later
        return np.zeros((batch.worlds, 3))
    dx, dy = (waypoints[:, :2] - poses[:, :2]).T
    off = (np.arctan2(dy, dx) - poses[:, 2] + math.pi) % (2.0 * math.pi) - math.pi
    near = batch.snapshot.clearances < 0.15
    forwards = limits.vx_max * np.clip(np.cos(off), 0.0, 1.0) * np.where(near & (np.abs(off) < 1.0), 0.3, 1.0)
    return np.column_stack((forwards, np.zeros(len(off)), np.clip(2.0 * off, -limits.wz_max, limits.wz_max)))


def _returns_of(snapshot: Snapshot, slot: int, ranges: Ranges) -> Floats:
    """Return where the beams of one robot ended, (K, 2) in the true map."""
    head = snapshot.scan_header
    sensor = Pose.of(snapshot.poses[slot]).compose(head.mount)
    hit = np.flatnonzero(np.isfinite(ranges[slot]) & (ranges[slot] < head.range_max))
    angles = sensor.theta + head.angle_min + head.angle_increment * hit
    away = ranges[slot, hit].astype(np.float64)
    return np.column_stack((sensor.x + away * np.cos(angles), sensor.y + away * np.sin(angles)))


def _turned(angle: float) -> NDArray[np.float64]:
    return np.array(((math.cos(angle), -math.sin(angle)), (math.sin(angle), math.cos(angle))))


def _mean(values: Sequence[float]) -> float:
    return float(np.mean(values)) if values else math.nan


def _median(values: Sequence[float]) -> float:
    return _quantile(values, 0.5)


def _quantile(values: Sequence[float], share: float) -> float:
    return float(np.quantile(values, share)) if values else math.nan
