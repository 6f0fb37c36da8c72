"""Where frames were in one another when: the transforms of a recording, in space, so that a laser that
hangs upside down is one, too.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from arena_core import wrap_angle
from arena_ros.bags.series import Series

Floats = NDArray[np.float64]
LEAP = 1.0  # m between two rows that lies nothing between: a frame was set elsewhere


@dataclass(frozen=True, slots=True, eq=False)
class Transforms:
    """A frame in another at T times: places (T, 3) and quaternions (T, 4), x, y, z, w."""

    places: Floats
    turns: Floats

    @staticmethod
    def identity(count: int) -> Transforms:
        """Return what changes nothing, so often."""
        return Transforms(np.zeros((count, 3)), np.tile((0.0, 0.0, 0.0, 1.0), (count, 1)))

    @staticmethod
    def from_poses(poses: Floats) -> Transforms:
        """Return transforms in the plane from x, y, theta (T, 3)."""
        zeros, half = np.zeros(len(poses)), poses[:, 2] / 2.0
        return Transforms(
            np.column_stack((poses[:, :2], zeros)), np.column_stack((zeros, zeros, np.sin(half), np.cos(half)))
        )

    def compose(self, child: Transforms) -> Transforms:
        """Return where a frame is that is at ``child`` in this one."""
        return Transforms(
            self.places + rotate_vectors(self.turns, child.places), _multiply_quaternions(self.turns, child.turns)
        )

    def inverse(self) -> Transforms:
        """Return where the other frame is in this one."""
        back = self.turns * (-1.0, -1.0, -1.0, 1.0)
        return Transforms(-rotate_vectors(back, self.places), back)

    def poses(self) -> Floats:
        """Return x, y and the heading of the x axis as seen from above, (T, 3)."""
        ahead = rotate_vectors(self.turns, np.tile((1.0, 0.0, 0.0), (len(self.turns), 1)))
        return np.column_stack((self.places[:, :2], wrap_angle(np.arctan2(ahead[:, 1], ahead[:, 0]))))

    def transform_poses(self, poses: Floats) -> Floats:
        """Return poses (T, 3) that are given in the child's frame, in this one."""
        return self.compose(Transforms.from_poses(poses)).poses()


def rotate_vectors(turns: Floats, vectors: Floats) -> Floats:
    """Return vectors (T, 3) after turns (T, 4)."""
    axis, w = turns[:, :3], turns[:, 3:]
    twice = 2.0 * np.cross(axis, vectors)
    return vectors + w * twice + np.cross(axis, twice)


def _multiply_quaternions(first: Floats, second: Floats) -> Floats:
    a, b = first[:, :3], second[:, :3]
    imaginary = first[:, 3:] * b + second[:, 3:] * a + np.cross(a, b)
    return np.column_stack((imaginary, first[:, 3] * second[:, 3] - (a * b).sum(axis=1)))


class Link:
    """Where a frame was in its parent: rows of seven numbers, or one that always holds."""

    def __init__(self, parent: str, child: str, series: Series, *, held: bool = False, static: bool = False) -> None:
        self.parent, self.child, self.series, self.static, self._held = parent, child, series, static, held

    @staticmethod
    def from_poses(parent: str, child: str, stamps: NDArray[np.int64], poses: Floats, *, held: bool = False) -> Link:
        """Return a link from poses x, y, theta (T, 3)."""
        own, series = Transforms.from_poses(poses), Series(7)
        for stamp, place, turn in zip(stamps.tolist(), own.places, own.turns, strict=True):
            series.extend(stamp, np.concatenate((place, turn)))
        return Link(parent, child, series, held=held)

    def at(self, stamps: NDArray[np.int64]) -> Transforms:
        """Return the transforms at some stamps: between two rows, or the one before;
        beyond the first and last, those.
        """
        own, values = self.series.sorted_rows()
        if self._held or len(own) == 1:
            place = np.clip(np.searchsorted(own, stamps, side="right") - 1, 0, None)
            return Transforms(values[place, :3], values[place, 3:])
        after = np.clip(np.searchsorted(own, stamps, side="right"), 1, len(own) - 1)
        before, lapse = after - 1, np.maximum(own[after] - own[after - 1], 1)
        share = np.clip((stamps - own[before]) / lapse, 0.0, 1.0)[:, None]
        first, last = values[before], values[after]
        leapt = np.linalg.norm(last[:, :3] - first[:, :3], axis=1, keepdims=True) > LEAP
        share = np.where(leapt & (share < 1.0), 0.0, share)
        same = np.where((first[:, 3:] * last[:, 3:]).sum(axis=1, keepdims=True) < 0.0, -1.0, 1.0)
        turns = first[:, 3:] + share * (same * last[:, 3:] - first[:, 3:])
        turns /= np.linalg.norm(turns, axis=1, keepdims=True)
        return Transforms(first[:, :3] + share * (last[:, :3] - first[:, :3]), turns)


class TransformTree:
    """The links of an episode; the shortest way from frame to frame counts."""

    def __init__(self, links: Iterable[Link]) -> None:
        self._links = [link for link in links if len(link.series)]

    def with_link(self, link: Link) -> TransformTree:
        """Return these and one more, which goes before."""
        return TransformTree([link, *self._links])

    def frames(self) -> frozenset[str]:
        """Return all frames that are linked to another."""
        return frozenset(name for link in self._links for name in (link.parent, link.child))

    def parent_chain(self, frame: str) -> list[str]:
        """Return a frame and those above it, up to the root."""
        parents, found = {link.child: link.parent for link in reversed(self._links)}, [frame]
        while (parent := parents.get(found[-1])) is not None and parent not in found:
            found.append(parent)
        return found

    def path(self, target: str, source: str) -> list[tuple[Link, bool]] | None:
        """Return the links from a frame up or down to another, and whether each is followed from the child;
        None where there is none.
        """
        before: dict[str, tuple[str, Link, bool] | None] = {source: None}
        queue = deque([source])
        while queue and target not in before:
            frame = queue.popleft()
            for link in self._links:
                for near, far, up in ((link.child, link.parent, True), (link.parent, link.child, False)):
                    if near == frame and far not in before:
                        before[far] = (frame, link, up)
                        queue.append(far)
        if target not in before:
            return None
        steps, frame = list[tuple[Link, bool]](), target
        while (step := before[frame]) is not None:
            frame, link, up = step
            steps.append((link, up))
        return steps

    def at(self, target: str, source: str, stamps: NDArray[np.int64]) -> Transforms | None:
        """Return where a frame was in another at some stamps; None where no links lead there."""
        steps = self.path(target, source)
        if steps is None:
            return None
        found = Transforms.identity(len(stamps))
        for link, up in steps:
            own = link.at(stamps)
            found = found.compose(own if up else own.inverse())
        return found


class TransformBuffer:
    """The transforms that have come so far: the newest of all, and since an episode's begin
    those of frames that matter.
    """

    def __init__(self) -> None:
        self.static: dict[str, Link] = {}
        self._newest: dict[str, tuple[str, int, Floats]] = {}
        self._kept: dict[str, Link] = {}
        self._wanted: set[str] = set()

    def take_static(self, parent: str, child: str, values: Floats) -> None:
        """Take in a link that always holds."""
        series = Series(7)
        series.extend(0, values)
        self.static[child] = Link(parent, child, series, static=True)

    def take(self, parent: str, child: str, stamp: int, values: Floats) -> None:
        """Take in a link that holds at a stamp."""
        self._newest[child] = (parent, stamp, values)
        if child in self._wanted:
            self.track_frame(parent)
            kept = self._kept.get(child)
            if kept is None or kept.parent != parent:
                kept = self._kept[child] = Link(parent, child, Series(7))
            kept.series.extend(stamp, values)

    def track_frame(self, frame: str) -> None:
        """Keep from now on how a frame moves, and all frames above it."""
        while frame not in self._wanted:
            self._wanted.add(frame)
            if frame in self._newest:
                self._keep_newest(frame)
            frame = self._parent_frame(frame)

    def _parent_frame(self, frame: str) -> str:
        if frame in self._newest:
            return self._newest[frame][0]
        return self.static[frame].parent if frame in self.static else frame

    def _keep_newest(self, child: str) -> None:
        parent, stamp, values = self._newest[child]
        self.take(parent, child, stamp, values)

    def begin(self, stamp: int | None = None) -> None:
        """Begin an episode: what was heard last holds until it is heard again.

        ``stamp``: since when, if clocks began again.
        """
        self._kept = {}
        for child, (parent, own, values) in list(self._newest.items()):
            self._newest[child] = (parent, own if stamp is None else stamp, values)
            if child in self._wanted:
                self._keep_newest(child)

    def newest(self, frame: str) -> tuple[str, Transforms]:
        """Return the frame above all others of a frame, and where that one is in it by what was heard last."""
        found, seen = Transforms.identity(1), {frame}
        while (parent := self._parent_frame(frame)) not in seen:
            values = self._newest[frame][2] if frame in self._newest else self.static[frame].series.values[0]
            found = Transforms(values[None, :3], values[None, 3:]).compose(found)
            seen.add(parent)
            frame = parent
        return frame, found

    def links(self) -> TransformTree:
        """Return the links of the episode."""
        moving = {child: link for child, link in self._kept.items() if child not in self.static}
        for child, (parent, stamp, values) in self._newest.items():
            if child not in moving and child not in self.static:
                moving[child] = Link(parent, child, Series(7))
                moving[child].series.extend(stamp, values)
        return TransformTree([*moving.values(), *self.static.values()])
