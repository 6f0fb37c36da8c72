"""Recorded walks: read from files, asked for positions at any time."""

from __future__ import annotations

import io
from array import array
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from arena_core import InputFileError
from arena_core.commands import one_line, print_notice
from arena_core.files import LIMITS, read_text
from arena_crowds.replay.scale import Unit, measured_rate, scale_of
from arena_kernels.compiled import compiled

Floats = NDArray[np.float64]
Format = Literal["frames", "obsmat", "juelich"]

SAME = 1e-6  # s, stamps nearer than this are one


class Columns(NamedTuple):
    """Where a format has what: the columns of frame, person, x and y, and how many columns there are, ``least`` ..

    ``most``.
    """

    frame: int
    person: int
    x: int
    y: int
    least: int
    most: int


FORMATS: Mapping[str, Columns] = {
    "frames": Columns(0, 1, 2, 3, 4, 4),
    "obsmat": Columns(0, 1, 2, 4, 8, 8),
    "juelich": Columns(1, 0, 2, 3, 4, 20),  # after z, or after y, whatever an experiment has
}
VELOCITY = {"obsmat": (5, 7)}  # the columns of a velocity, m/s
WALKING = (0.3, 2.5)  # m/s, between which people's median speed lies
LARGEST = 1e9  # of any number: ids are whole numbers of 32 bits
LONGEST = 1e5  # s, a day and more; known recordings have some minutes
# s, and of the usual time between samples: whoever is not seen for longer than either was not there
BREAK, BREAK_SAMPLES = 1.0, 5.0
STRIDE = 0.4  # s, over which a speed is measured: shorter ones are those of heads that sway


@dataclass(frozen=True, slots=True, eq=False)
class Recording:
    """P walks, packed: walk k is ``positions[first[k]:first[k + 1]]`` (S, 2) m at ``stamps`` (S,) s, which rise within
    a walk.

    ``ids`` (P,) are the recording's own numbers of the people. The earliest stamp of all is 0. Who is not seen for more
    than ``longest_gap`` s was not there.
    """

    ids: NDArray[np.int32]
    first: NDArray[np.int64]
    stamps: Floats
    positions: Floats
    longest_gap: float

    @property
    def begins(self) -> Floats:
        """Return when each person appears, s."""
        return self.stamps[self.first[:-1]]

    @property
    def ends(self) -> Floats:
        """Return when each person vanishes, s."""
        return self.stamps[self.first[1:] - 1]

    @property
    def duration(self) -> float:
        """Return when the last person vanishes, s."""
        return float(self.stamps.max())

    def median_speed(self) -> float | None:
        """Return how fast people walk, m/s: the median over all samples and the next STRIDE seconds; None
        where no one stays so long.
        """
        walks = np.repeat(np.arange(len(self.ids)), np.diff(self.first))
        # rise over all walks, so that one search serves them all
        keys = self.stamps + walks * (self.duration + 2.0 * STRIDE)
        later = np.searchsorted(keys, keys + STRIDE - SAME)
        there = later < np.append(self.first[1:], 0)[walks]
        if not there.any():
            return None
        ways = np.hypot(*(self.positions[later[there]] - self.positions[there]).T)
        return float(np.median(ways / (self.stamps[later[there]] - self.stamps[there])))

    def transform(self, offset_xy: Floats, rotation: float) -> Recording:
        """Return the recording turned about its origin, then shifted."""
        c, s = np.cos(rotation), np.sin(rotation)
        x, y = self.positions.T
        return replace(self, positions=np.stack((c * x - s * y, s * x + c * y), axis=1) + offset_xy)

    def sample_positions(self, rate: float) -> Floats:
        """Return positions (T, P, 2) m, ``rate`` times a second from 0 s on; NaN when absent."""
        times = np.arange(int(self.duration * rate + SAME) + 1) / rate
        walks = np.arange(len(self.ids))
        positions, _ = self.at(np.tile(walks, len(times)), np.repeat(times, len(walks)), cubic=False)
        return positions.reshape(len(times), len(walks), 2)

    def at(self, people: NDArray[np.int64], times: Floats, *, cubic: bool = True) -> tuple[Floats, Floats]:
        """Return positions and velocities, each (K, 2), of ``people`` (K,), indices of walks, at
        ``times`` (K,) s; NaN when absent.
        """
        positions, velocities = np.empty((len(people), 2)), np.empty((len(people), 2))
        interpolate_walks(
            self.first, self.stamps, self.positions, self.longest_gap, people, times, cubic, positions, velocities
        )
        return positions, velocities


def read_recording(path: Path, layout: Format, frame_rate: float | None = None, unit: Unit | None = None) -> Recording:
    """Read rows of numbers, plain or gzipped; ``frame_rate`` (1/s) and ``unit`` count where the file does not tell.

    Raises InputFileError, with the file, for rows of another format and where no one tells unit or frame rate. Tells of
    people who walk at no human pace.
    """
    columns = FORMATS[layout]
    comments, rows = _read_content(path, layout)
    rows = rows[np.lexsort((rows[:, columns.frame], rows[:, columns.person]))]
    persons, frames = rows[:, columns.person], rows[:, columns.frame]
    twice = (np.diff(persons) == 0) & (np.diff(frames) == 0)
    if (persons != np.rint(persons)).any():
        raise InputFileError(f"{path}: a person's number is no whole one; allowed: whole numbers")
    if twice.any():
        row = rows[int(np.argmax(twice))]
        raise InputFileError(
            f"{path}: person {row[columns.person]:g} is twice in frame {row[columns.frame]:g}; allowed: once a frame"
        )
    ids, first = np.unique(persons, return_index=True)
    places = rows[:, [columns.x, columns.y]]
    measured = measured_rate(persons, frames, places, rows[:, VELOCITY[layout]]) if layout in VELOCITY else None
    scale = scale_of(path, layout, comments, measured, unit, frame_rate)
    stamps = (frames - frames.min()) / scale.frame_rate
    gap = _longest_gap(np.diff(stamps)[np.diff(persons) == 0])
    recording = Recording(ids.astype(np.int32), np.append(first, len(rows)), stamps, places * scale.metres, gap)
    _check_extent(path, recording)
    _check_speed(path, recording)
    return recording


def _longest_gap(steps: Floats) -> float:
    """Return for how long a person may go unseen who is there all the same, s, by the times between
    samples, ``steps`` (S,) s.
    """
    return max(BREAK, BREAK_SAMPLES * float(np.median(steps))) if len(steps) else BREAK


def _check_extent(path: Path, recording: Recording) -> None:
    """Refuse what lasts or reaches farther than any recording: sampled, it would fill a memory."""
    if not (recording.duration <= LONGEST and (np.abs(recording.positions) <= LIMITS.number_largest).all()):
        raise InputFileError(
            f"{path}: lasts {recording.duration:g} s; allowed: up to {LONGEST:g} s, within {LIMITS.number_largest:g} m"
        )


def _check_speed(path: Path, recording: Recording) -> None:
    """Tell where people walk so slowly or so fast that unit or frame rate may be wrong."""
    speed = recording.median_speed()
    if speed is not None and not WALKING[0] <= speed <= WALKING[1]:
        low, high = WALKING
        print_notice(
            f"{path}: people walk at {speed:.2g} m/s (median), usual is {low:g} to {high:g}; "
            "is it the right unit and frame_rate?"
        )


def _read_content(path: Path, layout: Format) -> tuple[list[str], Floats]:
    """Return a file's comments and its rows, of which what the layout needs is there
    and finite; raise InputFileError.
    """
    columns = FORMATS[layout]
    wanted = f"{columns.least}" if columns.least == columns.most else f"at least {columns.least}"
    allowed = f"rows of {wanted} numbers for format {layout}"
    text = read_text(path, LIMITS.tracks_bytes, allowed)
    try:
        comments, rows = _parse_rows(text, columns)
    except ValueError as error:
        raise InputFileError(f"{path}: {one_line(str(error))}; allowed: {allowed}") from error
    if len(rows) == 0 or not (np.abs(rows) <= LARGEST).all():
        wrong = f"a number is beyond {LARGEST:g}" if np.isfinite(rows).all() else "a number is not finite"
        raise InputFileError(f"{path}: {wrong if len(rows) else 'no row'}; allowed: finite rows for format {layout}")
    return comments, rows


def _parse_rows(text: str, columns: Columns) -> tuple[list[str], Floats]:
    """Return the comments, and the rows as far as a format needs them."""
    needed = max(columns.least, columns.y + 1)
    comments, numbers, row = list[str](), array("d"), 0
    for line in io.StringIO(text):
        words = line.split()
        if not words:
            continue
        if words[0].startswith("#"):
            comments.append(line.strip())
            continue
        row += 1
        if not columns.least <= len(words) <= columns.most:
            raise ValueError(f"row {row} has {len(words)} numbers")
        if row > LIMITS.tracks_rows:
            raise ValueError(f"it has over {LIMITS.tracks_rows} rows")
        numbers.extend(map(float, words[:needed]))
    return comments, np.frombuffer(numbers, np.float64).reshape(-1, needed) if numbers else np.empty((0, needed))


@compiled
def interpolate_walks(
    first: NDArray[np.int64],
    stamps: Floats,
    places: Floats,
    longest: float,
    people: NDArray[np.int64],
    times: Floats,
    cubic: bool,
    positions: Floats,
    velocities: Floats,
) -> None:
    """Write where ``people`` are at ``times``, and how fast they go; NaN before the first and after the last sample of
    a walk, and between two samples that are more than ``longest`` s apart.

    At a stamp (to a microsecond) the position is the sample itself. Between samples it is linear, or a cubic whose
    velocity at a sample is that from the sample before to the one after (Catmull and Rom 1974).
    """
    for k in range(len(people)):
        low, high, t = first[people[k]], first[people[k] + 1] - 1, times[k]
        if not (stamps[low] - SAME <= t <= stamps[high] + SAME):
            positions[k, 0], positions[k, 1], velocities[k, 0], velocities[k, 1] = np.nan, np.nan, np.nan, np.nan
            continue
        before = low
        after = high
        while after - before > 1:
            middle = (before + after) // 2
            if stamps[middle] <= t + SAME:
                before = middle
            else:
                after = middle
        if stamps[after] <= t + SAME:
            before = after
        span = stamps[after] - stamps[before]
        share = (t - stamps[before]) / span if t - stamps[before] > SAME else 0.0
        if share > 0.0 and span > longest:
            positions[k, 0], positions[k, 1], velocities[k, 0], velocities[k, 1] = np.nan, np.nan, np.nan, np.nan
            continue
        for axis in range(2):
            p, q = places[before, axis], places[after, axis]
            leaving, arriving = (
                _sample_velocity(stamps, places, longest, before, low, high, axis),
                _sample_velocity(stamps, places, longest, after, low, high, axis),
            )
            if share == 0.0:
                positions[k, axis], velocities[k, axis] = p, leaving
            elif cubic:
                positions[k, axis], velocities[k, axis] = _hermite_value(
                    p, q, span * leaving, span * arriving, share, span
                )
            else:
                positions[k, axis], velocities[k, axis] = p + share * (q - p), (q - p) / span


@compiled
def _sample_velocity(stamps: Floats, places: Floats, longest: float, k: int, low: int, high: int, axis: int) -> float:
    """Return the velocity at a sample, from the sample before to the one after, of
    which neither lies beyond a break.
    """
    earlier, later = max(k - 1, low), min(k + 1, high)
    if stamps[k] - stamps[earlier] > longest:
        earlier = k
    if stamps[later] - stamps[k] > longest:
        later = k
    if later == earlier:
        return 0.0
    way = places[later, axis] - places[earlier, axis]
    return way / (stamps[later] - stamps[earlier])  # type: ignore[no-any-return]


@compiled
def _hermite_value(p: float, q: float, leaving: float, arriving: float, u: float, span: float) -> tuple[float, float]:
    """Return value and derivative at share ``u`` of a span."""
    value = p + u * (
        leaving + u * (3.0 * (q - p) - 2.0 * leaving - arriving + u * (2.0 * (p - q) + leaving + arriving))
    )
    slope = leaving + u * (
        2.0 * (3.0 * (q - p) - 2.0 * leaving - arriving) + 3.0 * u * (2.0 * (p - q) + leaving + arriving)
    )
    return value, slope / span
