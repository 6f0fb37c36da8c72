"""Tracks of N robots in one compiled call: true bodies, seen as the tracker ``kalman`` was measured to see them."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from arena_core import ConfigurationError, Lidar, Predictions, Robot, Scenario, Snapshot, Tracks, stream_key
from arena_core.parameters import Fraction, NonNegative, Positive, PositiveInt
from arena_gym.body_filter import FilterNumbers, measure_position, measure_rest, predict_body
from arena_kernels.compiled import borrowing, inner
from arena_kernels.random import normal, uniform

Floats = NDArray[np.float64]
Counts = NDArray[np.int64]
Slots = NDArray[np.int64]

STILL = 0.03  # m/s: a body slower than this stands, and the tracker finds out
EDGE = 0.05  # m: a return so near outside a body's disc is the body's
DRAWS = 8  # random numbers that a body may take of one scan
_TURN = 2.0 * math.pi


@dataclass(frozen=True, slots=True)
class TrackModel:
    """How a tracker errs: a body with ``returns`` beams on it is found in a share ``found`` of scans and measured with
    ``noise`` m along an axis; beyond what follows from that, velocities have ``speed_noise`` m/s. There is one of each
    for each ring that ends at ``rings`` m, the last for all beyond.

    Tracks differ: the logarithm of what multiplies a track's noise has the deviation ``unlikeness``. Noise forgets
    itself over ``correlation`` s. Radii are off by ``radius_bias`` m and spread by ``radius_std``. Bodies that are none
    appear ``false_rate`` times a second and last ``false_life`` s on average.
    """

    returns: PositiveInt
    rings: tuple[Positive, ...]
    found: tuple[Fraction, ...]
    noise: tuple[Positive, ...]
    speed_noise: tuple[NonNegative, ...]
    unlikeness: NonNegative
    correlation: Positive
    radius_bias: float
    radius_std: NonNegative
    false_rate: NonNegative
    false_life: Positive


class ModelNumbers(NamedTuple):
    """``TrackModel`` and the tracker's own rules as kernels take them; ``rings`` (R,), the rest (R + 1,)."""

    rings: Floats
    found: Floats
    noise: Floats
    speed_noise: Floats
    errors: tuple[
        float, float, float, float, float, float
    ]  # correlation, radius bias and spread, false rate and life, unlikeness
    returns: int
    confirm_hits: int
    misses: int
    hidden_for: float
    variance_most: float
    reach: float
    gate: float
    settles: float
    filter: FilterNumbers


class Followed(NamedTuple):
    """What N robots hold of Q bodies each; a body with no ``hits`` is not followed.

    ``states`` (N, Q, 4) are x, y, vx, vy in the true ``map``, ``covariances`` (N, Q, 3) of place, both and speed along
    an axis, ``errors`` (N, Q, 4) the last noise and ``scales`` (N, Q) what multiplies it, ``times`` (N, Q, 2) s in
    sight and hidden, ``bodies`` (N, E, 4) x, y, radius and end of those that are no people, the first E of the Q.
    """

    keys: NDArray[np.uint64]
    ticks: Counts
    stamps: Floats
    newest: Counts
    hits: Counts
    missed: Counts
    ids: Counts
    states: Floats
    covariances: Floats
    errors: Floats
    times: Floats
    radii: Floats
    scales: Floats
    bodies: Floats

    @classmethod
    def room(cls, worlds: int, bodies: int, extra: int) -> Followed:
        """Return room for so many bodies, of which ``extra`` are no people, none followed."""
        each = worlds, bodies
        return cls(
            np.zeros(worlds, np.uint64),
            np.zeros(worlds, np.int64),
            np.zeros(worlds),
            np.zeros(worlds, np.int64),
            np.zeros(each, np.int64),
            np.zeros(each, np.int64),
            np.zeros(each, np.int64),
            np.zeros((*each, 4)),
            np.zeros((*each, 3)),
            np.zeros((*each, 4)),
            np.zeros((*each, 2)),
            np.zeros(each),
            np.ones(each),
            np.full((worlds, extra, 4), np.nan),
        )

    def widen(self, bodies: int) -> Followed:
        """Return the same with room for so many bodies."""
        wide = Followed.room(len(self.keys), bodies, self.bodies.shape[1])
        for old, new in zip(self, wide, strict=True):
            new[tuple(slice(0, n) for n in old.shape)] = old
        return wide


class ScanNumbers(NamedTuple):
    """The scans (N, B) of N robots, and how their beams lie: ``mount`` is x, y, heading in ``base_link``."""

    ranges: NDArray[np.float32]
    stamps: Floats
    angle_min: float
    increment: float
    range_max: float
    mount: tuple[float, float, float]


class TrueBodies(NamedTuple):
    """Where N robots are (N, 3), now and by their estimate, and their people (N, P, ...), at ``stamps`` (N,)."""

    stamps: Floats
    poses: Floats
    twists: Floats
    positions: Floats
    velocities: Floats
    radii: Floats


class ModelledTracks:
    """Tracks of N robots, as ``tracker`` (the configuration of ``kalman``) would hold them by a ``model`` of it.

    A slot's errors are keyed by its scenario and the scans since its episode began, so it is what it would be alone.
    """

    def __init__(self, model: TrackModel, tracker: Mapping[str, Any], robot: Robot, worlds: int) -> None:
        self._numbers = _model_numbers(model, tracker, robot)
        self._radius_most = float(tracker["shape"]["radius_max"])
        self._followed = Followed.room(worlds, 1, 1)
        self._lidar = robot.lidar

    def begin(self, slots: Slots, scenarios: Sequence[Scenario]) -> None:
        """Begin episodes: nothing is followed."""
        most = 1 + max((len(one.obstacles) for one in scenarios), default=0)
        if most > self._followed.bodies.shape[1]:
            self._add_bodies(most)
        held = self._followed
        for slot, scenario in zip(slots.tolist(), scenarios, strict=True):
            held.keys[slot] = stream_key(scenario.seed, scenario.name, "tracks")
            held.ticks[slot], held.stamps[slot], held.newest[slot] = 0, -np.inf, 0
            held.hits[slot], held.bodies[slot] = 0, np.nan
            for place, obstacle in enumerate(scenario.obstacles, start=1):
                held.bodies[slot, place, :2] = obstacle.vertices_xy.mean(axis=0)
                radius = obstacle.radius or _equal_radius(obstacle.vertices_xy)
                held.bodies[slot, place, 2:] = min(radius, self._radius_most), np.inf

    def follow(self, slots: Slots, snapshot: Snapshot, ranges: NDArray[np.float32], estimates: Floats) -> list[Tracks]:
        """Take in the scans (N, B) of robots in K slots, which believe to be at ``estimates`` (K, 3); return their
        tracks.
        """
        crowd, extra = snapshot.crowd, self._followed.bodies.shape[1]
        if extra + crowd.positions.shape[1] > self._followed.hits.shape[1]:
            self._followed = self._followed.widen(extra + crowd.positions.shape[1])
        truth = TrueBodies(
            snapshot.stamps, snapshot.poses, snapshot.twists, crowd.positions, crowd.velocities, crowd.radii
        )
        scans = scans_of(self._lidar, snapshot, ranges)
        follow_bodies(self._followed, slots, truth, scans, self._numbers)
        return self._published(slots, truth, estimates)

    def _published(self, slots: Slots, truth: TrueBodies, estimates: Floats) -> list[Tracks]:
        held, confirmed = self._followed, self._numbers.confirm_hits
        told = np.array([(held.hits[slot] >= confirmed).sum() for slot in slots])
        offsets = np.concatenate(((0,), np.cumsum(told)))
        count = int(offsets[-1])
        ids, places, covariances = np.empty(count, np.int32), np.empty((count, 5)), np.zeros((count, 4, 4))
        write_followed(held, (slots, estimates), truth, self._numbers, (ids, places, covariances))
        return [
            Tracks(ids[a:b], places[a:b, :2], places[a:b, 2:4], places[a:b, 4], covariances[a:b])
            for a, b in zip(offsets[:-1].tolist(), offsets[1:].tolist(), strict=True)
        ]

    def _add_bodies(self, extra: int) -> None:
        """Make room for so many bodies that are no people; those that are followed keep their places."""
        held, more = self._followed, extra - self._followed.bodies.shape[1]
        wide = Followed.room(len(held.keys), held.hits.shape[1] + more, extra)
        shift = held.bodies.shape[1]
        for old, new in zip(held, wide, strict=True):
            if old is held.bodies:
                new[:, :shift] = old
            elif old.ndim == 1:
                new[:] = old
            else:
                new[:, :shift], new[:, shift + more :] = old[:, :shift], old[:, shift:]
        self._followed = wide


def scans_of(lidar: Lidar, snapshot: Snapshot, ranges: NDArray[np.float32]) -> ScanNumbers:
    """Return the scans of N robots as kernels take them, with these ``ranges`` (N, B)."""
    mount = float(lidar.mount.x), float(lidar.mount.y), float(lidar.mount.theta)
    limits = float(lidar.angle_min), float(lidar.angle_increment), float(lidar.range_max)
    return ScanNumbers(ranges, snapshot.scan_stamps, *limits, mount)


def expect_straight(tracks: Sequence[Tracks]) -> tuple[Predictions, ...]:
    """Return what is expected of the tracks of N robots, which keep their velocities."""
    return tuple(Predictions.straight(one.positions, one.velocities, one.covariances) for one in tracks)


def _equal_radius(vertices: Floats) -> float:
    """Return the radius (m) of a disc with a polygon's area."""
    x, y = vertices.T
    return math.sqrt(0.5 * abs(float(x @ np.roll(y, -1) - y @ np.roll(x, -1))) / math.pi)


def _model_numbers(model: TrackModel, tracker: Mapping[str, Any], robot: Robot) -> ModelNumbers:
    life, motion = tracker["life"], tracker["motion"]
    doubt = float(tracker["position_doubt"]), float(tracker["heading_doubt"])
    speeds = float(motion["speed_std"]) ** 2, float(motion["standing_std"]) ** 2
    for name in ("found", "noise", "speed_noise"):
        if len(getattr(model, name)) != len(model.rings) + 1:
            raise ConfigurationError(
                f"guide.model.tracks.{name} has {len(getattr(model, name))} numbers; allowed: {len(model.rings) + 1}, "
                "one more than rings"
            )
    return ModelNumbers(
        np.array(model.rings, np.float64),
        np.array(model.found, np.float64),
        np.array(model.noise, np.float64),
        np.array(model.speed_noise, np.float64),
        (model.correlation, model.radius_bias, model.radius_std, model.false_rate, model.false_life, model.unlikeness),
        model.returns,
        int(life["confirm_hits"]),
        int(life["misses"]),
        float(life["hidden_for"]),
        float(life["position_std"]) ** 2,
        min(float(tracker["returns"]["range"]), float(robot.lidar.range_max)),
        float(tracker["gate"]),
        float(tracker["memory"]["standing"]),
        FilterNumbers(float(motion["acceleration_density"]), *speeds, *doubt),
    )


@borrowing
def follow_bodies(held: Followed, slots: Slots, truth: TrueBodies, scans: ScanNumbers, model: ModelNumbers) -> None:
    """Take in the newest scan of each robot in K ``slots``, if it is new."""
    extra = held.bodies.shape[1]
    for slot in slots:
        if scans.stamps[slot] <= held.stamps[slot]:
            continue
        age = truth.stamps[slot] - scans.stamps[slot]
        lapse = scans.stamps[slot] - held.stamps[slot] if held.ticks[slot] else 0.0
        held.stamps[slot] = scans.stamps[slot]
        held.ticks[slot] += 1
        sensor = _sensor_pose(truth, slot, age, scans.mount)
        _haunt(held, slot, (sensor, lapse), scans, model)
        for q in range(held.hits.shape[1]):
            if q < extra:
                x, y, radius, still = held.bodies[slot, q, 0], held.bodies[slot, q, 1], held.bodies[slot, q, 2], True
            elif q - extra < truth.positions.shape[1]:
                p = q - extra
                vx, vy = truth.velocities[slot, p, 0], truth.velocities[slot, p, 1]
                x, y = truth.positions[slot, p, 0] - age * vx, truth.positions[slot, p, 1] - age * vy
                radius, still = truth.radii[slot, p], math.hypot(vx, vy) < STILL
            else:
                x = y = radius = np.nan
                still = False
            _follow_body(held, (slot, q), (x, y, radius, still), (sensor, lapse, scans), model)


@inner
def _sensor_pose(truth: TrueBodies, slot: int, age: float, mount: tuple[float, float, float]) -> Any:
    """Return where the lidar truly was when it scanned: x, y, heading."""
    heading = truth.poses[slot, 2] - age * truth.twists[slot, 2]
    c, s = math.cos(heading), math.sin(heading)
    back, side = mount[0] - age * truth.twists[slot, 0], mount[1] - age * truth.twists[slot, 1]
    return (
        truth.poses[slot, 0] + c * back - s * side,
        truth.poses[slot, 1] + s * back + c * side,
        heading + mount[2],
    )


@inner
def _haunt(held: Followed, slot: int, seen: Any, scans: ScanNumbers, model: ModelNumbers) -> None:
    """Let a body that is none appear where a beam ended, and end."""
    sensor, lapse = seen
    now, key, tick = held.stamps[slot], held.keys[slot], held.ticks[slot]
    if held.bodies[slot, 0, 3] < now:
        held.bodies[slot, 0, :] = np.nan
        held.hits[slot, 0] = 0
    if held.hits[slot, 0] > 0 or uniform(key, tick, 0) >= model.errors[3] * lapse:
        return
    beam = int(uniform(key, tick, 1) * scans.ranges.shape[1])
    away = float(scans.ranges[slot, beam])
    if away < model.reach:
        bearing = sensor[2] + scans.angle_min + beam * scans.increment
        held.bodies[slot, 0, 0] = sensor[0] + away * math.cos(bearing)
        held.bodies[slot, 0, 1] = sensor[1] + away * math.sin(bearing)
        held.bodies[slot, 0, 2] = 0.3
        held.bodies[slot, 0, 3] = now - model.errors[4] * math.log(1.0 - uniform(key, tick, 2))


@inner
def _follow_body(held: Followed, at: tuple[int, int], body: Any, seen: Any, model: ModelNumbers) -> None:
    """Predict, measure and judge one body that is truly at x, y with a radius, standing ``still`` or not."""
    (slot, q), (sensor, lapse, scans) = at, seen
    x, y, radius, _ = body
    tracked = held.hits[slot, q] > 0
    if tracked:
        predict_body(held.states[slot, q], held.covariances[slot, q], lapse, model.filter.density)
    away = math.hypot(x - sensor[0], y - sensor[1])
    ring, index = 0, (q + 1) * DRAWS
    while ring < len(model.rings) and away > model.rings[ring]:
        ring += 1
    found = False
    if away - radius <= model.reach:  # false for who is absent, at NaN
        on, _ = _count_beams(scans, slot, sensor, (x, y, radius))
        found = on >= model.returns and uniform(held.keys[slot], held.ticks[slot], index) < model.found[ring]
    if found:
        _measure_body(held, at, body, (away, ring, index, lapse), model)
    elif tracked:
        _miss_body(held, at, seen, model)


@inner
def _count_beams(scans: ScanNumbers, slot: int, sensor: Any, disc: Any) -> tuple[int, float]:
    """Return how many beams end on a disc (x, y, radius), and which share of those to its middle half goes on behind
    it.
    """
    count = scans.ranges.shape[1]
    dx, dy = disc[0] - sensor[0], disc[1] - sensor[1]
    away, radius = math.hypot(dx, dy), disc[2]
    if away <= radius:
        return count, 0.0
    half = math.asin(radius / away)
    middle = ((math.atan2(dy, dx) - sensor[2] - scans.angle_min) % _TURN) / scans.increment
    turn = _TURN / scans.increment
    if middle - half / scans.increment > count - 1:
        middle -= turn
    near, edge, total, behind, on = 0.5 * half, radius + EDGE, 0, 0, 0
    reach = half / scans.increment
    for beam in range(math.ceil(middle - reach), math.floor(middle + reach) + 1):
        at = beam
        if at < 0:
            at += round(turn)
        elif at >= count:
            at -= round(turn)
        off = (beam - middle) * scans.increment
        inner_half = abs(off) <= near
        total += inner_half
        if 0 <= at < count:
            r = float(scans.ranges[slot, at])
            if r >= min(away + radius + 0.1, scans.range_max):
                behind += inner_half
            elif abs(r - away) < edge and r * r + away * away - 2.0 * r * away * math.cos(off) < edge * edge:
                on += 1
    return on, behind / total if total else 0.0


@inner
def _measure_body(held: Followed, at: tuple[int, int], body: Any, way: Any, model: ModelNumbers) -> None:
    """Take in that a body was found, and where."""
    (slot, q), (x, y, radius, still) = at, body
    away, ring, index, lapse = way
    key, tick = held.keys[slot], held.ticks[slot]
    fresh = held.hits[slot, q] == 0
    if fresh:
        held.scales[slot, q] = math.exp(model.errors[5] * normal(key, tick, index + 6))
    kept = 0.0 if fresh else math.exp(-lapse / model.errors[0])
    fading = math.sqrt(1.0 - kept * kept) * held.scales[slot, q]
    for axis in range(4):
        spread = fading * (model.noise[ring] if axis < 2 else model.speed_noise[ring])
        held.errors[slot, q, axis] = kept * held.errors[slot, q, axis] + spread * normal(key, tick, index + 1 + axis)
    px, py = x + held.errors[slot, q, 0], y + held.errors[slot, q, 1]
    doubt = model.filter.position_doubt**2 + (model.filter.heading_doubt * away) ** 2
    variance = model.noise[ring] ** 2 + doubt
    state, covariance = held.states[slot, q], held.covariances[slot, q]
    off = (px - state[0]) ** 2 + (py - state[1]) ** 2
    if not fresh and off > model.gate * (covariance[0] + variance):
        held.hits[slot, q], fresh = 0, True  # it is not where its track is: a new one begins
    if fresh:
        state[0], state[1], state[2], state[3] = px, py, 0.0, 0.0
        covariance[0], covariance[1], covariance[2] = variance, 0.0, model.filter.speed_variance
        held.times[slot, q, 0] = 0.0
        held.radii[slot, q] = radius + model.errors[1] + model.errors[2] * normal(key, tick, index + 5)
    else:
        measure_position(state, covariance, (px, py), variance)
        held.times[slot, q, 0] += lapse
    held.hits[slot, q] += 1
    held.missed[slot, q], held.times[slot, q, 1] = 0, 0.0
    if still and held.times[slot, q, 0] >= model.settles:
        measure_rest(state, covariance, model.filter.standing_variance)
    if held.hits[slot, q] == model.confirm_hits:
        held.newest[slot] += 1
        held.ids[slot, q] = held.newest[slot]


@inner
def _miss_body(held: Followed, at: tuple[int, int], seen: Any, model: ModelNumbers) -> None:
    """Judge a track without a body: seen through, or hidden."""
    (slot, q), (sensor, lapse, scans) = at, seen
    state = held.states[slot, q]
    _, behind = _count_beams(scans, slot, sensor, (state[0], state[1], max(held.radii[slot, q], 0.1)))
    out_of_reach = math.hypot(state[0] - sensor[0], state[1] - sensor[1]) >= model.reach
    if behind >= 0.5 and not out_of_reach:
        held.missed[slot, q] += 1
    else:
        held.times[slot, q, 1] += lapse
    unsure = held.covariances[slot, q, 0] > model.variance_most
    told = held.hits[slot, q] >= model.confirm_hits
    hidden = held.times[slot, q, 1] > min(model.hidden_for, held.times[slot, q, 0])
    if not told or held.missed[slot, q] >= model.misses or hidden or unsure:
        held.hits[slot, q] = 0


@borrowing
def write_followed(
    held: Followed, believed: tuple[Slots, Floats], truth: TrueBodies, model: ModelNumbers, out: Any
) -> None:
    """Write ids (T,), places (T, 5) x, y, vx, vy, radius and covariances (T, 4, 4) of what K robots tell of, moved on
    to now and as seen from where they believe to be.
    """
    (slots, estimates), (ids, places, covariances) = believed, out
    row = 0
    for k in range(len(slots)):
        slot = slots[k]
        age = truth.stamps[slot] - held.stamps[slot]
        x, y = truth.poses[slot, 0], truth.poses[slot, 1]
        turn = estimates[k, 2] - truth.poses[slot, 2]
        c, s = math.cos(turn), math.sin(turn)
        for q in range(held.hits.shape[1]):
            if held.hits[slot, q] < model.confirm_hits:
                continue
            state, (pp, pv, vv) = held.states[slot, q], held.covariances[slot, q]
            vx, vy = state[2] + held.errors[slot, q, 2], state[3] + held.errors[slot, q, 3]
            dx, dy = state[0] + age * state[2] - x, state[1] + age * state[3] - y
            ids[row] = held.ids[slot, q]
            places[row, 0], places[row, 1] = estimates[k, 0] + c * dx - s * dy, estimates[k, 1] + s * dx + c * dy
            places[row, 2], places[row, 3] = c * vx - s * vy, s * vx + c * vy
            places[row, 4] = max(held.radii[slot, q], 0.1)
            q11, q12 = model.filter.density * age**3 / 3.0, model.filter.density * age**2 / 2.0
            for i in range(2):
                covariances[row, i, i] = pp + 2.0 * age * pv + age * age * vv + q11
                covariances[row, i, i + 2] = covariances[row, i + 2, i] = pv + age * vv + q12
                covariances[row, i + 2, i + 2] = vv + model.filter.density * age
            row += 1
