"""What a network is told of each tracked person: two seconds of its way, its neighbours, the free space around it."""

from __future__ import annotations

from math import exp, hypot, inf, isfinite, log, sqrt
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arena_core import OccupancyGrid, Tracks
from arena_kernels.compiled import TypedDispatch, borrowing, inner
from arena_kernels.distance import distance_field
from arena_kernels.ground import Ground, in_cells

Floats = NDArray[np.float64]
Singles = NDArray[np.float32]

AGES = np.array((0.2, 0.4, 0.6, 0.8, 1.0, 1.3, 1.6, 2.0))  # s ago, at which a track's way is told
RECENT = 4  # place in AGES of the time over which a heading is taken, and the way that a neighbour has come
NEIGHBOURS, NEIGHBOUR_SIZE = 6, 12  # the nearest ones, and numbers of each
RAYS, RAY_RANGE, RAY_STEP = 16, 5.0, 0.1  # looks for walls, m, and the least step of a look, m
RAY_COSINES, RAY_SINES = (f(2.0 * np.pi * np.arange(RAYS) / RAYS) for f in (np.cos, np.sin))
BODY_SIZE = 8
HISTORY_SIZE = 4 * len(AGES)
WALL_SIZE = 2 * RAYS
OWN_SIZE = BODY_SIZE + HISTORY_SIZE + WALL_SIZE
SIZE = OWN_SIZE + NEIGHBOURS * NEIGHBOUR_SIZE
NEIGHBOUR_RANGE = 6.0  # m of centres
SLOWEST = 0.1  # m/s, the least speed that ways and times are counted by
KEPT, SPACING = 24, 0.095  # places kept of a track, and the least time between two of them, s
LAYOUT = "arena-prediction-features-1"  # which numbers these are: another layout is another name


class Histories(NamedTuple):
    """The ways of up to S tracks: ``ids`` and ``counts`` (S,), -1 and 0 where there is none; ``stamps`` (S, KEPT) s and
    ``states`` (S, KEPT, 4), x, y, vx, vy, of which the newest is entry ``counts - 1`` modulo KEPT; ``seen`` (S,) s when
    each was last told of, ``began`` (S,) s when it was first.
    """

    ids: NDArray[np.int64]
    counts: NDArray[np.int64]
    stamps: Floats
    states: Floats
    seen: Floats
    began: Floats


class Now(NamedTuple):
    """K tracks now: ``ids`` (K,), ``places`` and ``velocities`` (K, 2), ``radii`` (K,), ``unsure`` (K, 2): standard
    deviations of place, m, and velocity, m/s; ``slots`` (K,) where the history of each stands, and room for
    ``earlier`` (K, A, 4), its states at AGES.
    """

    ids: NDArray[np.int64]
    places: Floats
    velocities: Floats
    radii: Floats
    unsure: Floats
    slots: NDArray[np.int64]
    earlier: Floats


class Told(NamedTuple):
    """What is told of K tracks: ``numbers`` (K, SIZE) and ``frames`` (K, 4), as ``TrackMemory.encode`` returns them."""

    numbers: Singles
    frames: Floats


class TrackMemory:
    """Remembers where tracks were, and writes what a network is told of them."""

    def __init__(self) -> None:
        self._note, self._encode = TypedDispatch(note_tracks), TypedDispatch(encode_tracks)
        self.reset(None)

    def reset(self, grid: OccupancyGrid | None) -> None:
        """Begin an episode; no one has been seen."""
        self._ground = OPEN if grid is None else grid.derive(ground_of)
        self._histories = blank_histories(32)

    def encode(self, tracks: Tracks, stamp: float) -> Told:
        """Return numbers (K, SIZE) and frames (K, 4): cosine and sine of each track's own x axis, its speed scale, m/s,
        and whether it is known: 1, or 0 where its place or velocity is no number.
        """
        count = len(tracks.ids)
        if count > len(self._histories.ids):
            self._histories = grown(self._histories, 2 * count)
        now = now_of(tracks)
        told = Told(np.zeros((count, SIZE), np.float32), np.empty((count, 4)))
        self._note(self._histories, now, float(stamp))
        self._encode(self._histories, now, float(stamp), self._ground, told)
        return told


def now_of(tracks: Tracks) -> Now:
    """Return tracks as kernels read them."""
    covariances = tracks.covariances
    unsure = np.sqrt(np.maximum(0.5 * (covariances[:, (0, 2), (0, 2)] + covariances[:, (1, 3), (1, 3)]), 0.0))
    return Now(
        tracks.ids.astype(np.int64),
        np.array(tracks.positions, np.float64),
        np.array(tracks.velocities, np.float64),
        np.array(tracks.radii, np.float64),
        unsure,
        np.zeros(len(tracks.ids), np.int64),
        np.empty((len(tracks.ids), len(AGES), 4)),
    )


def blank_histories(slots: int) -> Histories:
    """Return room for the ways of so many tracks."""
    return Histories(
        np.full(slots, -1),
        np.zeros(slots, np.int64),
        np.zeros((slots, KEPT)),
        np.zeros((slots, KEPT, 4)),
        np.full(slots, -inf),
        np.zeros(slots),
    )


def grown(histories: Histories, slots: int) -> Histories:
    """Return the same ways with room for more."""
    wider = blank_histories(slots)
    for old, new in zip(histories, wider, strict=True):
        new[: len(old)] = old
    return wider


def ground_of(grid: OccupancyGrid) -> Ground:
    """Return a map as rays read it; meant for ``grid.derive(ground_of)``."""
    field = distance_field(grid.occupied, grid.resolution).astype(np.float32)
    pose = grid.origin
    return Ground(field, pose.x, pose.y, float(np.cos(pose.theta)), float(np.sin(pose.theta)), grid.resolution)


OPEN = Ground(np.full((2, 2), np.inf, np.float32), 0.0, 0.0, 1.0, 0.0, 1.0)


@borrowing
def note_tracks(histories: Histories, now: Now, stamp: float) -> None:
    """Take in where tracks are; one that is new takes the place of the one unseen for longest."""
    for k in range(len(now.ids)):
        slot = _slot_of(histories, now.ids[k])
        if slot < 0:
            slot = _oldest_slot(histories)
            histories.ids[slot], histories.counts[slot], histories.began[slot] = now.ids[k], 0, stamp
        now.slots[k] = slot
        histories.seen[slot] = stamp
        x, y, vx, vy = now.places[k, 0], now.places[k, 1], now.velocities[k, 0], now.velocities[k, 1]
        if not (isfinite(x) and isfinite(y) and isfinite(vx) and isfinite(vy)):
            continue
        count = histories.counts[slot]
        if count and stamp - histories.stamps[slot, (count - 1) % KEPT] < SPACING:
            continue
        entry = count % KEPT
        histories.stamps[slot, entry] = stamp
        states = histories.states
        states[slot, entry, 0], states[slot, entry, 1] = x, y
        states[slot, entry, 2], states[slot, entry, 3] = vx, vy
        histories.counts[slot] = count + 1


@inner
def _slot_of(histories: Histories, number: int) -> int:
    for slot in range(len(histories.ids)):
        if histories.ids[slot] == number and histories.seen[slot] > -inf:
            return slot
    return -1


@inner
def _oldest_slot(histories: Histories) -> int:
    oldest = 0
    for slot in range(len(histories.ids)):
        if histories.seen[slot] < histories.seen[oldest]:
            oldest = slot
    return oldest


@borrowing
def encode_tracks(histories: Histories, now: Now, stamp: float, ground: Ground, told: Told) -> None:
    """Write what a network is told of each track, and the frame that it is told in."""
    frames = told.frames
    for k in range(len(now.ids)):
        frames[k, 3] = 1.0 if isfinite(now.places[k, 0] + now.places[k, 1] + _sum_of(now.velocities, k)) else 0.0
        if frames[k, 3] > 0.0:
            _recall(histories, now, k, stamp)
    for k in range(len(now.ids)):
        if frames[k, 3] == 0.0:
            frames[k, 0], frames[k, 1], frames[k, 2] = 1.0, 0.0, SLOWEST
            continue
        _write_frame(now, k, frames)
        _write_body(histories, now, k, stamp, told)
        _write_history(now, k, told)
        _write_walls(now, k, ground, told)
        _write_neighbours(now, k, told)


@inner
def _sum_of(vectors: Floats, k: int) -> float:
    return float(vectors[k, 0] + vectors[k, 1])


@inner
def _recall(histories: Histories, now: Now, k: int, stamp: float) -> None:
    """Write states of a track at AGES, its way prolonged straight back to before it was seen."""
    slot, earlier = now.slots[k], now.earlier
    count = histories.counts[slot]
    last = max(count - KEPT, 0)
    later, entry = stamp, count - 1
    x, y, vx, vy = now.places[k, 0], now.places[k, 1], now.velocities[k, 0], now.velocities[k, 1]
    for i in range(len(AGES)):
        when = stamp - AGES[i]
        while entry >= last and histories.stamps[slot, entry % KEPT] > when:
            state = histories.states[slot, entry % KEPT]
            later, x, y, vx, vy = histories.stamps[slot, entry % KEPT], state[0], state[1], state[2], state[3]
            entry -= 1
        if entry < last:
            lapse = later - when
            earlier[k, i, 0], earlier[k, i, 1] = x - lapse * vx, y - lapse * vy
            earlier[k, i, 2], earlier[k, i, 3] = vx, vy
            continue
        before, state = histories.stamps[slot, entry % KEPT], histories.states[slot, entry % KEPT]
        share = (when - before) / max(later - before, 1e-9)
        earlier[k, i, 0], earlier[k, i, 1] = state[0] + share * (x - state[0]), state[1] + share * (y - state[1])
        earlier[k, i, 2], earlier[k, i, 3] = state[2] + share * (vx - state[2]), state[3] + share * (vy - state[3])


@inner
def _write_frame(now: Now, k: int, frames: Floats) -> None:
    """Write which way a track heads, or the nearest other one is where it stands, and how fast it has gone."""
    x, y, vx, vy = now.places[k, 0], now.places[k, 1], now.velocities[k, 0], now.velocities[k, 1]
    hx = 0.5 * (vx + (x - now.earlier[k, RECENT, 0]) / AGES[RECENT])
    hy = 0.5 * (vy + (y - now.earlier[k, RECENT, 1]) / AGES[RECENT])
    fastest = vx * vx + vy * vy
    for i in range(len(AGES)):
        fastest = max(fastest, now.earlier[k, i, 2] ** 2 + now.earlier[k, i, 3] ** 2)
    length = hypot(hx, hy)
    if length < 1e-3:
        nearest, hx, hy = inf, 1.0, 0.0
        for j in range(len(now.ids)):
            dx, dy = now.places[j, 0] - x, now.places[j, 1] - y
            if j != k and 1e-6 < hypot(dx, dy) < nearest:
                nearest, hx, hy = hypot(dx, dy), dx, dy
        length = hypot(hx, hy)
    frames[k, 0], frames[k, 1], frames[k, 2] = hx / length, hy / length, max(sqrt(fastest), SLOWEST)


@inner
def _frame_of(told: Told, k: int) -> tuple[float, float, float]:
    return told.frames[k, 0], told.frames[k, 1], told.frames[k, 2]


@inner
def _or_zero(value: float) -> float:
    return value if isfinite(value) else 0.0


@inner
def _write_body(histories: Histories, now: Now, k: int, stamp: float, told: Told) -> None:
    numbers, (c, s, scale) = told.numbers, _frame_of(told, k)
    vx, vy = now.velocities[k, 0], now.velocities[k, 1]
    numbers[k, 0] = log(scale)
    numbers[k, 1] = min(stamp - histories.began[now.slots[k]], 3.0) - 1.5
    numbers[k, 2] = min(_or_zero(now.unsure[k, 0]) / 0.1, 5.0)
    numbers[k, 3] = min(_or_zero(now.unsure[k, 1]) / scale, 5.0)
    numbers[k, 4] = _or_zero(now.radii[k]) / 0.3
    numbers[k, 5], numbers[k, 6] = (c * vx + s * vy) / scale, (c * vy - s * vx) / scale
    numbers[k, 7] = 0.3 / scale


@inner
def _write_history(now: Now, k: int, told: Told) -> None:
    numbers, at, (c, s, scale) = told.numbers, BODY_SIZE, _frame_of(told, k)
    for i in range(len(AGES)):
        x, y, vx, vy = now.earlier[k, i, 0], now.earlier[k, i, 1], now.earlier[k, i, 2], now.earlier[k, i, 3]
        way = scale * AGES[i]
        dx, dy = (now.places[k, 0] - x) / way, (now.places[k, 1] - y) / way
        numbers[k, at], numbers[k, at + 1] = _cut(c * dx + s * dy), _cut(c * dy - s * dx)
        numbers[k, at + 2], numbers[k, at + 3] = _cut((c * vx + s * vy) / scale), _cut((c * vy - s * vx) / scale)
        at += 4


@inner
def _cut(value: float) -> float:
    return min(max(value, -4.0), 4.0)


@inner
def _write_walls(now: Now, k: int, ground: Ground, told: Told) -> None:
    """Write how far the body is from walls on each ray, near ones in metres and far ones in time."""
    numbers, frames = told.numbers, told.frames
    at, radius = BODY_SIZE + HISTORY_SIZE, _or_zero(now.radii[k])
    row, column = in_cells(ground, now.places[k, 0], now.places[k, 1])
    c = (frames[k, 0] * ground.cosine + frames[k, 1] * ground.sine) / ground.cell  # the heading, in cells a metre
    s = (frames[k, 1] * ground.cosine - frames[k, 0] * ground.sine) / ground.cell
    for i in range(RAYS):
        u, v = c * RAY_COSINES[i] - s * RAY_SINES[i], s * RAY_COSINES[i] + c * RAY_SINES[i]
        free = max(_free_way(ground, row, column, v, u) - radius, 0.0)
        numbers[k, at], numbers[k, at + 1] = exp(-free), exp(-0.7 * free / frames[k, 2])
        at += 2


@inner
def _free_way(ground: Ground, row: float, column: float, rows: float, columns: float) -> float:
    """Return how far it is from a cell to a wall, RAY_RANGE at most; a metre is ``rows`` and ``columns``."""
    done, last_row, last_column = 0.0, ground.field.shape[0] - 1, ground.field.shape[1] - 1
    while done < RAY_RANGE:
        i = min(max(int(row + done * rows), 0), last_row)
        j = min(max(int(column + done * columns), 0), last_column)
        free = float(ground.field[i, j]) - ground.cell
        if free <= 0.0:
            return done
        done += max(free, RAY_STEP)
    return RAY_RANGE


@inner
def _write_neighbours(now: Now, k: int, told: Told) -> None:
    """Write the nearest others, each in the frame of the track."""
    after = -1.0
    last = -1
    for place in range(NEIGHBOURS):
        nearest, chosen = NEIGHBOUR_RANGE, -1
        for j in range(len(now.ids)):
            if j == k:
                continue
            away = hypot(now.places[j, 0] - now.places[k, 0], now.places[j, 1] - now.places[k, 1])
            beyond = away > after or (away == after and j > last)
            if away < nearest and beyond and told.frames[j, 3] > 0.0:
                nearest, chosen = away, j
        if chosen < 0:
            return
        after, last = nearest, chosen
        _write_neighbour(now, k, chosen, told, OWN_SIZE + place * NEIGHBOUR_SIZE)


@inner
def _write_neighbour(now: Now, k: int, j: int, told: Told, at: int) -> None:
    row, (c, s, scale) = told.numbers[k], _frame_of(told, k)
    dx, dy = now.places[j, 0] - now.places[k, 0], now.places[j, 1] - now.places[k, 1]
    ux, uy = now.velocities[j, 0] - now.velocities[k, 0], now.velocities[j, 1] - now.velocities[k, 1]
    wx = (now.places[j, 0] - now.earlier[j, RECENT, 0]) / AGES[RECENT]
    wy = (now.places[j, 1] - now.earlier[j, RECENT, 1]) / AGES[RECENT]
    speed2 = ux * ux + uy * uy
    soonest = min(max(-(dx * ux + dy * uy) / max(speed2, 1e-6), 0.0), 5.0)
    closest = hypot(dx + soonest * ux, dy + soonest * uy)
    bodies = _or_zero(now.radii[j]) + _or_zero(now.radii[k])
    row[at] = 1.0
    row[at + 1], row[at + 2] = (c * dx + s * dy) / 3.0, (c * dy - s * dx) / 3.0
    row[at + 3], row[at + 4] = _cut((c * ux + s * uy) / scale), _cut((c * uy - s * ux) / scale)
    row[at + 5], row[at + 6] = _cut((c * wx + s * wy) / scale), _cut((c * wy - s * wx) / scale)
    row[at + 7] = exp(-max(hypot(dx, dy) - bodies, 0.0))
    row[at + 8] = exp(-max(closest - bodies, 0.0) / 0.5)
    row[at + 9] = soonest / 2.0
    row[at + 10] = bodies / 0.6
    row[at + 11] = min(sqrt(speed2) * soonest / 3.0, 3.0)
