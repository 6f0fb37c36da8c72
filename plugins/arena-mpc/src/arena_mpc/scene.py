"""What a plan must keep away from at one control step."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from arena_core import NO_TRACKS, Observation, Tracks
from arena_kernels.costmap_window import CostmapWindow, window_of, without_discs
from arena_mpc.arrays import FloatArray
from arena_mpc.corridor import boundary_cells


class Scene(NamedTuple):
    """The window without what moves, the centres (P, 2) of its obstacles' outermost cells, and what moves."""

    window: CostmapWindow
    cells: FloatArray
    tracks: Tracks


def scene_of(observation: Observation, margin: float, *, moving: bool) -> Scene:
    """Divide what an observation shows into what stands still and what moves; cells within
    ``margin`` m of a track are the track's.
    """
    window, tracks = window_of(observation.local_map), observation.tracks if moving else NO_TRACKS
    known = np.isfinite(tracks.positions).all(axis=1) & np.isfinite(tracks.velocities).all(axis=1)
    if not known.all():
        tracks = Tracks(
            tracks.ids[known],
            tracks.positions[known],
            tracks.velocities[known],
            tracks.radii[known],
            tracks.covariances[known],
        )
    window = without_discs(window, tracks.positions, tracks.radii, margin)
    return Scene(window, boundary_cells(window.costs, window.resolution, window.origin_x, window.origin_y), tracks)
