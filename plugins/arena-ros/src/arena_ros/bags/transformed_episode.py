"""An episode in one frame: every place is taken there by the links that were heard, or left out."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from arena_core import InputFileError, Pose
from arena_ros.bags.episode_messages import EpisodeMessages
from arena_ros.bags.series import PersonSightings, Series
from arena_ros.bags.transform_tree import Floats, Link, Transforms, TransformTree, rotate_vectors
from arena_ros.frames import BASES

MAP = "map"  # after REP-105
FAR_ORIGIN = 1e4  # m from the origin, beyond which it is shifted: UTM's coordinates leave no digits for millimetres
FIRST = 9  # poses, by the median of which it is known where the robot starts
WHOLE = 1000.0  # m, by whole ones of which it is
REACH = 1e5  # m from the origin beyond which nothing is of this drive
Stamps = NDArray[np.int64]


@dataclass(frozen=True, slots=True, eq=False)
class TransformedEpisode:
    """An episode whose places are all in ``frame``, less ``shift`` m.

    ``truth`` says what ``motion`` is: ``reference``, ``estimated`` or ``odometry``. ``believed`` is empty where nothing
    says it.
    """

    gathered: EpisodeMessages
    frame: str
    shift: tuple[float, float]
    begin: int
    end: int
    why_ended: str
    truth: str
    goal: Pose | None
    motion: Series
    twists: Series
    believed: Series
    estimate: Series
    paths: list[tuple[int, Floats]]
    people: PersonSightings


@dataclass(frozen=True, slots=True, eq=False)
class TargetFrame:
    """The frame that an episode is taken to, by the links that were heard of the robot's ``base``."""

    name: str
    links: TransformTree
    base: str

    def is_own(self, source: str) -> bool:
        """Return whether what is in a frame stays where it is."""
        return source in ("", self.name)


class EpisodeTransformer:
    """Places episodes. ``said`` is the frame that the user chose, empty for none; ``note`` takes what is left out."""

    def __init__(self, said: str, note: Callable[[str], None]) -> None:
        self._said, self._note = said, note
        self._fixed = ""
        self._shift: tuple[float, float] | None = None

    def transform_episode(
        self, gathered: EpisodeMessages, grid_frame: str, goal: Pose | None
    ) -> TransformedEpisode | None:
        """Return an episode in one frame, with ``goal`` where it has none; None where nothing
        says where the robot was.
        """
        links = _with_odometry(gathered)
        frame = self._choose_frame(gathered, links, grid_frame)
        if frame is None:
            return None
        self._fixed = frame
        links = _with_estimate(gathered, links, frame)
        target = TargetFrame(frame, links, gathered.base)
        reference = self._transform_series(target, gathered.reference, 6, "reference poses are")
        believed, estimate = self._own_estimates(gathered, target)
        chain = _is_estimated(gathered, links, frame)
        if len(reference):
            truth, motion = "reference", reference
            links = links.with_link(Link.from_poses(frame, gathered.base, reference.stamps, reference.values[:, :3]))
            target = replace(target, links=links)
        elif len(believed):
            truth, motion = "estimated" if chain else "odometry", believed
        else:
            truth, motion = "estimated", estimate
        if not len(motion):
            return None
        placed = TransformedEpisode(
            gathered,
            frame,
            (0.0, 0.0),
            gathered.begin,
            int(motion.stamps.max()),
            gathered.why_ended,
            truth,
            self._transform_goal(gathered, target) or goal,
            motion,
            reference,
            believed if chain else Series(3),
            estimate,
            self._transform_paths(gathered, target),
            self._transform_people(gathered, target),
        )
        return self._within_reach(placed)

    def _choose_frame(self, gathered: EpisodeMessages, links: TransformTree, grid_frame: str) -> str | None:
        """Return the frame that all is taken to: the first in which it is known where the robot was."""
        heard = links.frames() | gathered.reference.keys() | gathered.estimate.keys()
        tops = [each for each in links.parent_chain(gathered.frame)[::-1] if each not in (gathered.base, *BASES)]
        goals = [gathered.goal[0]] if gathered.goal is not None else []
        usual = [self._fixed, MAP, grid_frame, *gathered.reference, *tops, *gathered.estimate, *goals, gathered.frame]
        for frame in [self._said] if self._said else usual:
            if frame and frame not in BASES and _is_located(gathered, links, frame):
                return frame
        if any("" in places for places in (gathered.reference, gathered.estimate)):
            return MAP
        if self._said:
            known = ", ".join(sorted(heard)) or "none, since no frame was recorded"
            raise InputFileError(f"map_frame is {self._said}, to which nothing links the robot; allowed: {known}")
        return None

    def _lookup_transforms(self, target: TargetFrame, source: str, stamps: Stamps, what: str) -> Transforms | None:
        """Return where a frame was in the chosen one at some stamps; None, and a note, where nothing links them."""
        if target.is_own(source):
            return Transforms.identity(len(stamps))
        known = target.base if source in BASES and source not in target.links.frames() else source
        found = target.links.at(target.name, known, stamps)
        if found is None:
            hint = f"map_frame={target.name},{source} takes them for one"
            self._note(f"{what} in the frame {source}, which nothing links to {target.name}; left out ({hint})")
        return found

    def _transform_series(self, target: TargetFrame, places: dict[str, Series], width: int, what: str) -> Series:
        merged = Series(width)
        for source, series in places.items():
            stamps, values = series.sorted_rows()
            if (found := self._lookup_transforms(target, source, stamps, what)) is not None:
                moved = values[:, :3] if target.is_own(source) else found.transform_poses(values[:, :3])
                for stamp, row in zip(stamps.tolist(), np.column_stack((moved, values[:, 3:])), strict=True):
                    merged.extend(stamp, row)
        return merged.in_order()

    def _own_estimates(self, gathered: EpisodeMessages, target: TargetFrame) -> tuple[Series, Series]:
        """Return where the robot believed to be by its transforms, as often as its
        base was told of, and by its estimate.
        """
        believed = Series(3)
        steps = target.links.path(target.name, target.base) or []
        moving = next((link.series for link, _ in reversed(steps) if not link.static), None)
        if moving is not None:
            stamps = moving.sorted_rows()[0]
            found = target.links.at(target.name, target.base, stamps)
            for stamp, pose in zip(stamps.tolist(), found.poses() if found is not None else (), strict=True):
                believed.extend(stamp, pose)
        return believed, self._transform_series(target, gathered.estimate, 12, "estimates are")

    def _transform_goal(self, gathered: EpisodeMessages, target: TargetFrame) -> Pose | None:
        if gathered.goal is None:
            return None
        source, goal = gathered.goal
        found = self._lookup_transforms(target, source, np.array([gathered.begin]), "a goal is")
        if found is None or target.is_own(source):
            return goal if found is not None else None
        return Pose.of(found.transform_poses(goal.array()[None])[0])

    def _transform_paths(self, gathered: EpisodeMessages, target: TargetFrame) -> list[tuple[int, Floats]]:
        placed = []
        for stamp, source, poses in gathered.paths:
            found = self._lookup_transforms(target, source, np.full(len(poses), stamp), "paths are")
            if found is not None:
                placed.append((stamp, poses if target.is_own(source) else found.transform_poses(poses)))
        return placed

    def _transform_people(self, gathered: EpisodeMessages, target: TargetFrame) -> PersonSightings:
        merged: list[tuple[int, Floats]] = []
        for source, people in gathered.people.items():
            stamps, counts, _ = people.rows()
            found = self._lookup_transforms(target, source, np.repeat(stamps, counts), "people are")
            if found is not None:
                merged += (people if target.is_own(source) else _transform_sightings(people, found)).iter_sightings()
        placed = PersonSightings()
        for stamp, seen in sorted(merged, key=lambda each: each[0]):
            placed.add(stamp, seen.tolist())
        return placed

    def _within_reach(self, placed: TransformedEpisode) -> TransformedEpisode:
        """Return an episode whose origin is near, without what lies beyond any drive."""
        if self._shift is None:
            start = np.median(placed.motion.values[:FIRST, :2], axis=0)
            far = bool(np.abs(start).max() > FAR_ORIGIN)
            self._shift = (
                (float(np.round(start[0] / WHOLE) * WHOLE), float(np.round(start[1] / WHOLE) * WHOLE))
                if far
                else (0.0, 0.0)
            )
            if far:
                self._note(
                    f"places lie far from the origin of {placed.frame}; shifted by {-self._shift[0]:.0f}, "
                    f"{-self._shift[1]:.0f} m"
                )
        x, y = self._shift
        goal = None if placed.goal is None else Pose(placed.goal.x - x, placed.goal.y - y, placed.goal.theta)
        if goal is not None and max(abs(goal.x), abs(goal.y)) > REACH:
            self._note(f"a goal that is {max(abs(goal.x), abs(goal.y)) / 1000.0:.0f} km away; left out")
            goal = None
        paths = [(stamp, poses - (x, y, 0.0)) for stamp, poses in placed.paths]
        paths = [(stamp, poses) for stamp, poses in paths if (np.abs(poses[:, :2]) < REACH).all()]
        return replace(
            placed,
            shift=self._shift,
            goal=goal,
            paths=paths,
            people=self._nearby_people(placed.people),
            motion=self._nearby_series(placed.motion),
            twists=self._nearby_series(placed.twists),
            believed=self._nearby_series(placed.believed),
            estimate=self._nearby_series(placed.estimate),
        )

    def _nearby_series(self, series: Series) -> Series:
        assert self._shift is not None
        stamps, values = series.stamps, series.values
        near = np.abs(values[:, :2] - self._shift).max(axis=1, initial=0.0) < REACH
        if near.all() and self._shift == (0.0, 0.0):
            return series
        if not near.all():
            self._note("poses that are more than 100 km away; left out")
        kept = Series(values.shape[1])
        for stamp, row in zip(stamps[near].tolist(), values[near], strict=True):
            kept.extend(stamp, np.concatenate((row[:2] - self._shift, row[2:])))
        return kept

    def _nearby_people(self, people: PersonSightings) -> PersonSightings:
        assert self._shift is not None
        kept, far = PersonSightings(), 0
        for stamp, seen in people.iter_sightings():
            rows = seen - (0.0, *self._shift, 0.0, 0.0, 0.0)
            near = np.abs(rows[:, 1:3]).max(axis=1, initial=0.0) < REACH
            far += int((~near).sum())
            kept.add(stamp, rows[near].tolist())
        if far:
            self._note("people who are more than 100 km away; left out")
        return kept


def _transform_sightings(people: PersonSightings, frames: Transforms) -> PersonSightings:
    """Return people, each of whom was seen in another frame than the chosen one."""
    rows = people.rows()[2]
    places = frames.places + rotate_vectors(frames.turns, rows[:, 1:4])
    speeds = rotate_vectors(frames.turns, np.column_stack((rows[:, 4:6], np.zeros(len(rows)))))
    return people.with_rows(np.column_stack((rows[:, :1], places, speeds[:, :2])))


def _with_odometry(gathered: EpisodeMessages) -> TransformTree:
    """Return the links with that of the odometry's messages, where transforms do not tell of it."""
    links = gathered.links
    if len(gathered.odometry) and links.path(gathered.frame, gathered.base) is None:
        stamps, values = gathered.odometry.sorted_rows()
        return links.with_link(Link.from_poses(gathered.frame, gathered.base, stamps, values[:, :3]))
    return links


def _with_estimate(gathered: EpisodeMessages, links: TransformTree, frame: str) -> TransformTree:
    """Return the links with that of odometry to the chosen frame after the robot's estimate, where
    transforms do not tell of it.
    """
    own = gathered.estimate.get(frame) or gathered.estimate.get("")
    if own is None or links.path(frame, gathered.base) is not None:
        return links
    stamps, values = own.sorted_rows()
    odometry = links.at(gathered.frame, gathered.base, stamps)
    if odometry is None:
        return links
    corrections = Transforms.from_poses(values[:, :3]).compose(odometry.inverse())
    return links.with_link(Link.from_poses(frame, gathered.frame, stamps, corrections.poses(), held=True))


def _is_located(gathered: EpisodeMessages, links: TransformTree, frame: str) -> bool:
    poses = [*gathered.reference, *gathered.estimate]
    return frame in poses or any(links.path(frame, source) is not None for source in (gathered.base, *poses))


def _is_estimated(gathered: EpisodeMessages, links: TransformTree, frame: str) -> bool:
    """Return whether something that moves lies between odometry's frame and the chosen one."""
    return any(not link.static for link, _ in links.path(frame, gathered.frame) or [])
