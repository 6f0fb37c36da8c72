"""Numbers that come with time, of one episode: eight bytes each, so that hours of a recording fit."""

from __future__ import annotations

from array import array
from bisect import bisect_right
from collections.abc import Iterable, Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from arena_core import wrap_angle

MOST_CELLS = 4_000_000  # people times rows of one episode


class Series:
    """Rows of equal width, each with a stamp in ns."""

    def __init__(self, width: int) -> None:
        self._width = width
        self._stamps = array("q")
        self._values = array("d")

    def __len__(self) -> int:
        return len(self._stamps)

    def add(self, stamp: int, *values: float) -> None:
        """Add a row."""
        self._stamps.append(stamp)
        self._values.extend(values)

    def extend(self, stamp: int, values: NDArray[np.float64]) -> None:
        """Add a row from an array."""
        self._stamps.append(stamp)
        self._values.frombytes(np.ascontiguousarray(values, np.float64).tobytes())

    @property
    def stamps(self) -> NDArray[np.int64]:
        """Return the stamps, (K,)."""
        return np.array(self._stamps, np.int64)

    @property
    def values(self) -> NDArray[np.float64]:
        """Return the rows, (K, width)."""
        return np.array(self._values, np.float64).reshape(-1, self._width)

    def sorted_rows(self) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
        """Return stamps that rise, (K,), and their rows, (K, width); of rows with one stamp the last."""
        stamps, order = np.unique(self.stamps[::-1], return_index=True)
        return stamps, self.values[::-1][order]

    def in_order(self) -> Series:
        """Return the rows with stamps that rise, of those with one stamp the last."""
        stamps = self.stamps
        return self if (np.diff(stamps) > 0).all() else _make_series(*self.sorted_rows())

    def where(self, kept: NDArray[np.bool_]) -> Series:
        """Return some of the rows."""
        return _make_series(self.stamps[kept], self.values[kept])

    def at(self, stamp: int) -> NDArray[np.float64] | None:
        """Return the pose (x, y, theta first) between two rows of rising stamps; None before the
        first and after the last.
        """
        after = bisect_right(self._stamps, stamp)
        if after == 0 or (after == len(self._stamps) and self._stamps[-1] < stamp):
            return None
        before, after = after - 1, min(after, len(self._stamps) - 1)
        first, last = (np.array(self._values[k * self._width : k * self._width + 3]) for k in (before, after))
        lapse = self._stamps[after] - self._stamps[before]
        turned = np.array((*(last - first)[:2], wrap_angle(last[2] - first[2])))
        pose: NDArray[np.float64] = first + turned * ((stamp - self._stamps[before]) / lapse if lapse > 0 else 0.0)
        return pose

    def newest(self, stamp: int) -> NDArray[np.float64] | None:
        """Return the newest row of rising stamps until then, the first one before it; None where there is none."""
        if not len(self._stamps):
            return None
        k = max(bisect_right(self._stamps, stamp) - 1, 0)
        return np.array(self._values[k * self._width : (k + 1) * self._width])

    def latest_at(self, stamps: NDArray[np.int64]) -> NDArray[np.float64]:
        """Return at each of some stamps the newest row until then; NaN before the first."""
        values = np.full((len(stamps), self._width), np.nan)
        if len(self):
            place = np.searchsorted(self.stamps, stamps, side="right") - 1
            values[place >= 0] = self.values[place[place >= 0]]
        return values

    def exact_at(self, stamps: NDArray[np.int64]) -> NDArray[np.float64]:
        """Return the rows that have just these stamps; NaN where there is none."""
        values = np.full((len(stamps), self._width), np.nan)
        if len(self):
            own = self.stamps
            place = np.clip(np.searchsorted(own, stamps, side="right") - 1, 0, None)
            there = own[place] == stamps
            values[there] = self.values[place[there]]
        return values

    def interpolate_at(self, stamps: NDArray[np.int64]) -> NDArray[np.float64]:
        """Return poses (x, y, theta first) interpolated at some stamps, the first and last held
        beyond; NaN where there is none.
        """
        from arena_ros.conversions import interpolate_poses

        if not len(self):
            return np.full((len(stamps), 3), np.nan)
        own, first = self.stamps, self.stamps[0]
        order = np.argsort(own, kind="stable")
        return interpolate_poses((stamps - first) * 1e-9, (own[order] - first) * 1e-9, self.values[order][:, :3])


def _make_series(stamps: NDArray[np.int64], values: NDArray[np.float64]) -> Series:
    series = Series(values.shape[1])
    for stamp, row in zip(stamps.tolist(), values, strict=True):
        series.extend(stamp, row)
    return series


class PersonSightings:
    """Who was seen when: any number at each stamp."""

    def __init__(self) -> None:
        self._stamps, self._counts, self._values = array("q"), array("q"), array("d")

    def __len__(self) -> int:
        return len(self._stamps)

    def add(self, stamp: int, seen: Iterable[Sequence[float]]) -> None:
        """Add those who are seen at a stamp: number, x, y, z, vx, vy."""
        before = len(self._values)
        for each in seen:
            self._values.extend(each)
        self._stamps.append(stamp)
        self._counts.append((len(self._values) - before) // 6)

    def with_rows(self, rows: NDArray[np.float64]) -> PersonSightings:
        """Return the same sightings with other rows, (N, 6)."""
        people = PersonSightings()
        people._stamps, people._counts, people._values = self._stamps, self._counts, array("d", rows.ravel().tolist())
        return people

    def iter_sightings(self) -> Iterator[tuple[int, NDArray[np.float64]]]:
        """Yield each stamp and who was seen then, (n, 6)."""
        stamps, counts, rows = self.rows()
        for stamp, count, end in zip(stamps.tolist(), counts.tolist(), np.cumsum(counts).tolist(), strict=True):
            yield stamp, rows[end - count : end]

    def rows(self) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.float64]]:
        """Return the stamps (K,), how many were seen at each, and all of them, (N, 6)."""
        return (
            np.array(self._stamps, np.int64),
            np.array(self._counts, np.int64),
            np.array(self._values, np.float64).reshape(-1, 6),
        )

    def table(
        self, stamps: NDArray[np.int64], oldest: int, ids: NDArray[np.int32] | None = None
    ) -> tuple[NDArray[np.int32], NDArray[np.float32]]:
        """Return ids (P,) and x, y, vx, vy (T, P, 4) as they were seen at most ``oldest`` ns before each of T stamps;
        NaN where not.

        Of more people than a table holds, those who were seen longest count.
        """
        own, counts, rows = self.rows()
        known = _longest_seen(rows[:, 0], MOST_CELLS // max(len(stamps), 1)) if ids is None else ids
        table = np.full((len(stamps), len(known), 4), np.nan, np.float32)
        if len(self) and len(known):
            ends = np.cumsum(counts)
            place = np.searchsorted(own, stamps, side="right") - 1
            column = {int(number): k for k, number in enumerate(known.tolist())}
            for t, k in enumerate(place.tolist()):
                if k < 0 or stamps[t] - own[k] > oldest:
                    continue
                for row in rows[ends[k] - counts[k] : ends[k]]:
                    if int(row[0]) in column:
                        table[t, column[int(row[0])]] = row[[1, 2, 4, 5]]
        return known, table


def _longest_seen(numbers: NDArray[np.float64], most: int) -> NDArray[np.int32]:
    known, counts = np.unique(numbers, return_counts=True)
    kept = np.sort(known[np.argsort(-counts, kind="stable")[:most]])
    return kept.astype(np.int32)
