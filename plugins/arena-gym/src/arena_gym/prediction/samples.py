"""What a network is fitted to: numbers of tracks, and where their people then were."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from arena_core import Tracks
from arena_prediction.drives import Drive, load_drive, true_tracks
from arena_prediction.features import SIZE, TrackMemory
from arena_prediction.hypotheses import SCALE_TIME

Singles = NDArray[np.float32]
SAME = 0.6  # m between a track and the person that it follows, at most


@dataclass(frozen=True, slots=True, eq=False)
class Samples:
    """N tracks at an instant: ``numbers`` (N, SIZE), and ``residuals`` (N, H, 2): how far the person was from the
    track's straight line at each time, in its own frame and on its scale; ``true`` (N,) whether the track erred in
    nothing.
    """

    numbers: Singles
    residuals: Singles
    true: NDArray[np.bool_]

    def take(self, rows: NDArray[np.int64]) -> Samples:
        """Return these samples."""
        return Samples(*(getattr(self, each.name)[rows] for each in fields(self)))

    def metres(self, times: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the residuals at ``times`` (H,) in m."""
        scale = np.exp(self.numbers[:, :1].astype(np.float64)) * (times + SCALE_TIME)
        return np.asarray(self.residuals * scale[..., None])


def load_samples(files: Sequence[Path], times: NDArray[np.float64], every: float) -> Samples:
    """Return the samples of drives, every ``every`` s of each track, of the tracker's tracks and of true ones."""
    parts = [part for path in files for part in _samples_of(load_drive(path), times, every)]
    if not parts:
        empty = np.empty((0, len(times), 2), np.float32)
        return Samples(np.empty((0, SIZE), np.float32), empty, np.empty(0, np.bool_))
    return Samples(*(np.concatenate([getattr(part, each.name) for part in parts]) for each in fields(Samples)))


def _samples_of(driven: Drive, times: NDArray[np.float64], every: float) -> Iterator[Samples]:
    for true, tracks in ((False, driven.tracks), (True, true_tracks(driven))):
        memory = TrackMemory()
        memory.reset(driven.grid)
        begin = driven.stamps[0]
        for row, (stamp, seen) in enumerate(zip(driven.stamps, tracks, strict=True)):
            numbers, frames = memory.encode(seen, float(stamp))
            if round((stamp - begin) / 0.1) % round(every / 0.1) or not len(numbers):
                continue
            residuals = _residuals(driven, row, seen, frames, times)
            kept = np.isfinite(residuals).all(axis=(1, 2)) & (frames[:, 3] > 0.0)
            yield Samples(numbers[kept], residuals[kept].astype(np.float32), np.full(kept.sum(), true))


def _residuals(
    driven: Drive, row: int, seen: Tracks, frames: NDArray[np.float64], times: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return how far from its straight line each track's person is at ``times``; NaN where no one knows."""
    rows = np.searchsorted(driven.stamps, driven.stamps[row] + times - 1e-3)
    if rows[-1] >= len(driven.stamps) or abs(driven.stamps[rows[-1]] - driven.stamps[row] - times[-1]) > 0.05:
        return np.full((len(seen.ids), len(times), 2), np.nan)
    away = np.hypot(*np.moveaxis(seen.positions[:, None] - driven.people[row], 2, 0))
    away = np.where(np.isfinite(away), away, np.inf)
    if not away.size:
        return np.full((len(seen.ids), len(times), 2), np.nan)
    whose = away.argmin(axis=1)
    off = driven.people[rows][:, whose].swapaxes(0, 1) - seen.positions[:, None]
    off -= seen.velocities[:, None] * times[:, None]
    off[away.min(axis=1) > SAME] = np.nan
    c, s, scale = frames[:, 0, None], frames[:, 1, None], frames[:, 2, None]
    own = np.stack((c * off[..., 0] + s * off[..., 1], c * off[..., 1] - s * off[..., 0]), axis=2)
    return np.asarray(own / (scale * (times + SCALE_TIME))[..., None])
