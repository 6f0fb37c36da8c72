"""What a picture needs of a recorded episode: where the robot, people and their legs are at any time."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from arena_core import EpisodeRecord
from arena_core.hosting import compose, to_plain
from arena_kernels.compiled import borrowing
from arena_kernels.legs import STANDING, Gait, legs_of, smooth_velocity, step_length

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class SceneState:
    """One moment, in ``map``: ``pose`` (3,), and the calmer ``heading`` of a camera behind it.

    Of people ``positions`` (P, 2), m, NaN where absent, ``states`` (P,), the way they ``face`` (P, 2) and their
    ``feet`` (P, 2, 2), m. ``path`` (M, 2) is the global path that holds, ``trail`` (K, 2) where the robot has been,
    ``scan`` (B,) ranges, if they were kept. ``doors_open`` (D,) are the doors that are open, ``mates`` (M, 3) the poses
    of teammates.
    """

    stamp: float
    pose: Floats
    heading: float
    positions: Floats
    states: NDArray[np.int64]
    face: Floats
    feet: Floats
    path: Floats
    trail: Floats
    scan: NDArray[np.float32] | None
    doors_open: NDArray[np.bool_]
    mates: Floats


class SceneStates:
    """A recorded episode that can be asked for any moment; between two control steps everything moves evenly."""

    def __init__(self, record: EpisodeRecord, calm: float) -> None:
        self.record = record
        self._stamp = np.asarray(record["stamp"], np.float64)
        self._pose = np.column_stack((record["pose"][:, :2], np.unwrap(record["pose"][:, 2])))
        self._heading = _smooth_headings(self._stamp, self._pose[:, 2], calm)
        mates = record.teammate_poses()
        self._mates = np.concatenate((mates[..., :2], np.unwrap(mates[..., 2:], axis=0)), axis=2)
        self._people = np.asarray(record["pedestrian_positions"], np.float64)
        self.radii = np.asarray(record["pedestrian_radii"], np.float64)
        self._doors_open = np.asarray(record.arrays.get("doors_open", np.zeros((len(self._stamp), 0), np.bool_)))
        self._feet = np.full((*self._people.shape[:2], 2, 2), np.nan)
        self._face = np.zeros((*self._people.shape[:2], 2))
        if len(self.radii):
            _write_feet(_record_gait(record.meta), self._stamp, self._people, self.radii, self._feet, self._face)

    @property
    def end(self) -> float:
        """Return when the episode ends, s."""
        return float(self._stamp[-1])

    def at(self, stamp: float) -> SceneState:
        """Return the moment ``stamp``, s."""
        last = len(self._stamp) - 1
        row = int(np.clip(np.searchsorted(self._stamp, stamp, side="right") - 1, 0, max(last - 1, 0)))
        after = min(row + 1, last)
        span = self._stamp[after] - self._stamp[row]
        share = float(np.clip((stamp - self._stamp[row]) / span, 0.0, 1.0)) if span > 0.0 else 0.0
        record = self.record
        scans = record.arrays.get("scan_ranges")
        return SceneState(
            stamp,
            _interpolate_rows(self._pose, row, after, share),
            float(_interpolate_rows(self._heading, row, after, share)),
            _interpolate_rows(self._people, row, after, share),
            np.asarray(record["pedestrian_states"][row], np.int64),
            self._face[row],
            _interpolate_rows(self._feet, row, after, share),
            self._planned_path(stamp),
            np.vstack((self._pose[: row + 1, :2], _interpolate_rows(self._pose, row, after, share)[None, :2])),
            None if scans is None or not len(scans) else scans[min(row, len(scans) - 1)],
            self._doors_open[row],
            _interpolate_rows(self._mates, row, after, share),
        )

    def _planned_path(self, stamp: float) -> Floats:
        """Return the points of the latest path that was planned until then."""
        planned = np.flatnonzero(self.record["path_stamps"] <= stamp + 1e-9)
        if not len(planned):
            return np.empty((0, 2))
        first, end = self.record["path_offsets"][planned[-1] : planned[-1] + 2]
        return np.asarray(self.record["path_poses"][first:end, :2], np.float64)


def _interpolate_rows(rows: Floats, row: int, after: int, share: float) -> Any:
    return rows[row] + share * (rows[after] - rows[row])


def _smooth_headings(stamp: Floats, heading: Floats, calm: float) -> Floats:
    """Return headings averaged over ``calm`` s before and after, so that a camera behind the
    robot does not swing with every turn.
    """
    if len(stamp) < 2:
        return heading
    width = max(1, round(calm / float(np.median(np.diff(stamp)))))
    padded = np.pad(heading, width, mode="edge")
    return np.convolve(padded, np.full(2 * width + 1, 1.0 / (2 * width + 1)), mode="valid")


def _record_gait(meta: Mapping[str, Any]) -> Gait:
    """Return how people walk: as the record says, or as adults do."""
    said = (meta["config"].get("pedestrians") or {}).get("gait") or to_plain(compose(["+gait=adult"]))["gait"]
    return Gait(**{name: float(said[name]) for name in Gait._fields})


@borrowing
def _write_feet(gait: Gait, stamp: Floats, people: Floats, radii: Floats, feet: Floats, face: Floats) -> None:
    """Fill ``feet`` (T, P, 2, 2) with where the left and the right foot of people (T, P, 2) are, in step with the way
    that they cover.

    ``face`` (T, P, 2) is the velocity that they have taken up, which never vanishes.
    """
    for person in range(people.shape[1]):
        velocity, steps = (STANDING, 0.0), 0.37 * person
        for row in range(people.shape[0]):
            x, y = people[row, person, 0], people[row, person, 1]
            if row > 0 and not np.isnan(x) and not np.isnan(people[row - 1, person, 0]):
                dt = stamp[row] - stamp[row - 1]
                dx, dy = x - people[row - 1, person, 0], y - people[row - 1, person, 1]
                if dt > 0.0:
                    velocity = smooth_velocity(gait, velocity, (dx / dt, dy / dt), dt)
                way = np.sqrt(dx * dx + dy * dy)
                steps += way / step_length(gait, np.sqrt(velocity[0] * velocity[0] + velocity[1] * velocity[1]))
            face[row, person, 0], face[row, person, 1] = velocity
            if not np.isnan(x):
                left_x, left_y, right_x, right_y, _ = legs_of(gait, x, y, radii[person], velocity, steps)
                feet[row, person, 0, 0], feet[row, person, 0, 1] = left_x, left_y
                feet[row, person, 1, 0], feet[row, person, 1, 1] = right_x, right_y
