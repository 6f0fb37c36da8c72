"""Pictures and films in 2-D by the suite's painter: a strip of moments for a paper, or an episode as it moves."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from arena_core import ConfigurationError, Footprint, Path
from arena_drawing.frames import FramePainter, Scene, Stage
from arena_viewer.document import Recorded

Frame = NDArray[np.uint8]
GAP = 6  # pixels between the moments of a strip
NOBODY = np.empty((0, 2))


class Moments:
    """Draws moments of one recorded episode; the longer side has ``side`` pixels."""

    def __init__(self, one: Recorded, side: int) -> None:
        if one.grid is None:
            raise ConfigurationError("the episode has no map; allowed: episodes of a known world")
        record, scenario = one.record, one.record.meta["scenario"]
        self._stamp = np.asarray(record["stamp"], np.float64)
        self._pose = np.asarray(record["pose"], np.float64)
        self._people = np.asarray(record["pedestrian_positions"], np.float64)
        self._radii = np.asarray(record["pedestrian_radii"], np.float64)
        offsets = record["path_offsets"]
        first = np.asarray(record["path_poses"], np.float64)[: int(offsets[1]) if len(offsets) > 1 else 0]
        start, goal = np.array(scenario["start"]), np.array(scenario["goal"])
        stage = Stage(one.grid, scenario["obstacles"], start, goal, Path(first) if len(first) else None)
        footprint = record.meta["robot"]["footprint"]
        vertices = np.asarray(footprint["vertices_xy"], np.float64).reshape(-1, 2)
        self._painter = FramePainter(stage, Footprint.polygon(vertices) if len(vertices) else Footprint.circle(footprint["radius"]), side)

    @property
    def end(self) -> float:
        """Return when the episode ends, s."""
        return float(self._stamp[-1])

    def at(self, stamp: float) -> Frame:
        """Return the picture (H, W, 3) of the control step that holds at ``stamp`` s."""
        row = max(0, int(np.searchsorted(self._stamp, stamp + 1e-9, side="right")) - 1)
        return self._painter.frame(Scene(self._pose[row], self._people[row], self._radii, NOBODY, float(self._stamp[row])))


def strip(one: Recorded, count: int, side: int) -> Frame:
    """Return ``count`` moments at even distances, the first and the last among them, side by side."""
    moments = Moments(one, side)
    frames = [moments.at(stamp) for stamp in np.linspace(0.0, moments.end, count)]
    gap = np.full((frames[0].shape[0], GAP, 3), 255, np.uint8)
    parts = [part for frame in frames for part in (gap, frame)][1:]
    return np.concatenate(parts, axis=1)


def frames(one: Recorded, stamps: Sequence[float], side: int) -> tuple[tuple[int, int], Iterator[Frame]]:
    """Return the size (width, height) of a film's frames, both even, and the frames at these times, s."""
    moments = Moments(one, side)
    height, width = (length - length % 2 for length in moments.at(0.0).shape[:2])
    return (width, height), (moments.at(stamp)[:height, :width] for stamp in stamps)
