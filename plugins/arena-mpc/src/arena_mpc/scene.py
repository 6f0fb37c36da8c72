"""What a plan must keep away from at one control step."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from arena_core import Observation
from arena_kernels.costmap_window import CostmapWindow, window_of, without_discs
from arena_kernels.foreseen import Foreseen
from arena_mpc.arrays import FloatArray
from arena_mpc.corridor import boundary_cells

NOBODY = Foreseen.straight(np.empty((0, 2)), np.empty((0, 2))), np.empty(0)


class Scene(NamedTuple):
    """The window without what moves, the centres (P, 2) of its obstacles' outermost cells, and what moves: discs with
    ``radii`` (K,) that go where they are ``foreseen``.
    """

    window: CostmapWindow
    cells: FloatArray
    foreseen: Foreseen
    radii: FloatArray


def scene_of(observation: Observation, margin: float, *, moving: bool) -> Scene:
    """Divide what an observation shows into what stands still and what moves; cells within
    ``margin`` m of a track are the track's.
    """
    window, (foreseen, radii) = window_of(observation.local_map), foreseen_tracks(observation) if moving else NOBODY
    window = without_discs(window, np.ascontiguousarray(foreseen.places[:, 0]), radii, margin)
    cells = boundary_cells(window.costs, window.resolution, window.origin_x, window.origin_y)
    return Scene(window, cells, foreseen, radii)


def foreseen_tracks(observation: Observation) -> tuple[Foreseen, FloatArray]:
    """Return where the tracks that are known will be, and their radii (K,)."""
    tracks, predictions = observation.tracks, observation.predictions
    known = np.isfinite(tracks.positions).all(axis=1) & np.isfinite(tracks.velocities).all(axis=1)
    if not known.all():
        predictions = predictions.take(np.flatnonzero(known))
    radii: FloatArray = np.ascontiguousarray(tracks.radii[known], np.float64)
    return Foreseen.of(predictions.times, predictions.means, predictions.legs()), radii
