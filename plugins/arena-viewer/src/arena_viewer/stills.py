"""Pictures and films in 2-D by the suite's painter: a strip of moments for a paper, or episodes
as they move, side by side.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from arena_core import ConfigurationError, Footprint, Path
from arena_drawing.frames import FramePainter, SceneState, StaticScene, Window, free_window
from arena_viewer.document import RecordedEpisode

Frame = NDArray[np.uint8]
GAP = 6  # pixels between pictures
NO_PEOPLE = np.empty((0, 2))
LEAST = 14  # pixels of a robot's length, so that one sees where it looks
ROOM = 0.12  # of the longer side, around the drive: marks are whole, and one sees what it drove past
LEAST_ROOM = 1.5  # m
DRIVER = "driver"  # the event by which a switch says which of its members drives


class EpisodeStills:
    """Draws moments of one recorded episode; the longer side has ``side`` pixels, ``window`` is
    what is shown of the map.
    """

    def __init__(self, one: RecordedEpisode, side: int, window: Window | None = None, title: str = "") -> None:
        if one.grid is None:
            raise ConfigurationError("the episode has no map; allowed: episodes of a known world")
        record, scenario = one.record, one.record.meta["scenario"]
        self._title = title
        self._stamp = np.asarray(record["stamp"], np.float64)
        self._pose = np.asarray(record["pose"], np.float64)
        self._people = np.asarray(record["pedestrian_positions"], np.float64)
        self._radii = np.asarray(record["pedestrian_radii"], np.float64)
        self._contact_stamp = np.asarray(record["contact_stamp"], np.float64)
        self._contacts = np.asarray(record["contact_position"], np.float64).reshape(-1, 2)
        self._doors_open = np.asarray(record.arrays.get("doors_open", np.zeros((len(self._stamp), 0))), np.bool_)
        self._drivers = [
            (float(event["stamp"]), str(event["detail"])) for event in record.meta["events"] if event["kind"] == DRIVER
        ]
        path, start, goal = first_path(one), np.array(scenario["start"]), np.array(scenario["goal"])
        shown = window or view_bounds([one])
        doors = [door["vertices_xy"] for door in scenario.get("doors", ())]
        planned = Path(path) if len(path) else None
        self._mates = record.teammate_poses()
        mates = [(_footprint_of(mate["robot"]), np.array(mate["goal"])) for mate in record.teammates()]
        stage = StaticScene(one.grid, scenario["obstacles"], start, goal, planned, shown, doors, mates)
        self._painter = FramePainter(stage, _footprint_of(record.meta["robot"]), side, LEAST)

    @property
    def end(self) -> float:
        """Return when the episode ends, s."""
        return float(self._stamp[-1])

    def at(self, stamp: float) -> Frame:
        """Return the picture (H, W, 3) of the control step that holds at ``stamp`` s."""
        row = max(0, int(np.searchsorted(self._stamp, stamp + 1e-9, side="right")) - 1)
        now = float(self._stamp[row])
        touched = self._contacts[self._contact_stamp <= now + 1e-9]
        driven = self._pose[: row + 1, :2]
        return self._painter.frame(
            SceneState(
                self._pose[row],
                self._people[row],
                self._radii,
                NO_PEOPLE,
                now,
                driven,
                touched,
                self._title_text(now),
                self._doors_open[row].tolist(),
                self._mates[: row + 1],
            )
        )

    def _title_text(self, now: float) -> str:
        """Return the title, and which member of a switch drives now."""
        driver = next((name for stamp, name in reversed(self._drivers) if stamp <= now + 1e-9), "")
        return f"{self._title} ({driver})" if self._title and driver else self._title or driver


def first_path(one: RecordedEpisode) -> NDArray[np.float64]:
    """Return the poses of the first path that was planned; none where there was no path."""
    offsets = one.record["path_offsets"]
    return np.asarray(one.record["path_poses"], np.float64)[: int(offsets[1]) if len(offsets) > 1 else 0]


def view_bounds(episodes: Sequence[RecordedEpisode]) -> Window:
    """Return what is shown of the map: all that the robots drove and touched, their first paths, starts and goals, with
    room around.

    The shorter side is as long as the other, as far as the first map goes.
    """
    points = np.concatenate([_shown_points(one) for one in episodes])
    points = points[np.isfinite(points).all(axis=1)]
    low, high = points.min(axis=0), points.max(axis=0)
    room = max(LEAST_ROOM, ROOM * float((high - low).max()))
    (left, bottom), (right, top) = (low - room).tolist(), (high + room).tolist()
    if episodes[0].grid is None:
        return left, right, bottom, top
    whole, side = free_window(episodes[0].grid), max(right - left, top - bottom)
    return *_extend_interval(left, right, side, whole[:2]), *_extend_interval(bottom, top, side, whole[2:])


def _extend_interval(low: float, high: float, side: float, bounds: tuple[float, float]) -> tuple[float, float]:
    """Return an interval of the length ``side`` around another one, or what of it lies within bounds; never
    less than that other one.
    """
    begin = min(max((low + high - side) / 2.0, bounds[0]), max(bounds[1] - side, bounds[0]))
    return min(low, begin), max(high, min(begin + side, bounds[1]))


def _shown_points(one: RecordedEpisode) -> NDArray[np.float64]:
    record, scenario = one.record, one.record.meta["scenario"]
    parts: list[ArrayLike] = [record["pose"], first_path(one), [scenario["start"]], [scenario["goal"]]]
    parts += [record.teammate_poses().reshape(-1, 3), [mate["goal"] for mate in record.teammates()]]
    places = [
        np.asarray(part, np.float64).reshape(len(np.asarray(part)), -1)[:, :2]
        for part in parts
        if len(np.asarray(part))
    ]
    return np.concatenate([*places, np.asarray(record["contact_position"], np.float64).reshape(-1, 2)])


def _footprint_of(robot: Mapping[str, Any]) -> Footprint:
    """Return the outline of a robot as a record tells of it."""
    said = robot["footprint"]
    vertices = np.asarray(said["vertices_xy"], np.float64).reshape(-1, 2)
    return Footprint.polygon(vertices) if len(vertices) else Footprint.circle(said["radius"])


def strip_picture(episodes: Sequence[RecordedEpisode], count: int, side: int) -> Frame:
    """Return ``count`` moments at even distances, the first and the last among them, side by
    side; episodes below each other.
    """
    return _join_pictures([_moment_strip(moments, count) for moments in _all_moments(episodes, side)], 0)


def _moment_strip(moments: EpisodeStills, count: int) -> Frame:
    return _join_pictures([moments.at(stamp) for stamp in np.linspace(0.0, moments.end, count)], 1)


def film_frames(
    episodes: Sequence[RecordedEpisode], stamps: Sequence[float], side: int
) -> tuple[tuple[int, int], Iterator[Frame]]:
    """Return the size (width, height) of a film's frames, both even, and the frames at these times, s; episodes stand
    side by side.

    One that has ended stays as it was then.
    """
    moments = _all_moments(episodes, side)

    def frame(stamp: float) -> Frame:
        return _join_pictures([each.at(stamp) for each in moments], 1)

    height, width = (length - length % 2 for length in frame(0.0).shape[:2])
    return (width, height), (frame(stamp)[:height, :width] for stamp in stamps)


def _all_moments(episodes: Sequence[RecordedEpisode], side: int) -> list[EpisodeStills]:
    """Return the pictures of episodes on one scenario, all of the same stretch of the map; several are
    called by their planners.
    """
    window = view_bounds(episodes)
    return [EpisodeStills(one, side, window, one.name if len(episodes) > 1 else "") for one in episodes]


def _join_pictures(pictures: Sequence[Frame], axis: int) -> Frame:
    """Return pictures of one size with gaps between them, side by side (axis 1) or below each other (0)."""
    shape = list(pictures[0].shape)
    shape[axis] = GAP
    gap = np.full(shape, 255, np.uint8)
    return np.concatenate([part for picture in pictures for part in (gap, picture)][1:], axis=axis)
