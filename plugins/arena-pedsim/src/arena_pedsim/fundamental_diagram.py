"""How walking speed falls with density: measured alike on recorded trajectories and on the model."""

from __future__ import annotations

import gzip
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arena_core import InputFileError

Floats = NDArray[np.float64]

SPAN = 0.3  # s before and after an instant over which a speed is taken: shorter spans measure the swaying of heads


class Area(NamedTuple):
    """A rectangle, m."""

    left: float
    right: float
    bottom: float
    top: float

    def contains(self, positions: Floats) -> NDArray[np.bool_]:
        """Tell which positions (..., 2) lie inside."""
        x, y = positions[..., 0], positions[..., 1]
        return (x > self.left) & (x < self.right) & (y > self.bottom) & (y < self.top)


def measure(positions: Floats, rate: float, area: Area) -> tuple[Floats, Floats]:
    """Return density (1/m^2) and mean speed (m/s) in the area at each instant with somebody in it.

    ``positions`` (T, P, 2) m, NaN where somebody is absent, ``rate`` in 1/s. Density is the number of people in the area over its size, as
    method A and B of Zhang et al., Transitions in pedestrian fundamental diagrams of straight corridors and T-junctions, J. Stat. Mech.
    P06004, 2011, have it; a speed is somebody's displacement from SPAN before to SPAN after.
    """
    span = round(SPAN * rate)
    middle = positions[span:-span]
    speeds = np.linalg.norm(positions[2 * span :] - positions[: -2 * span], axis=-1) * rate / (2 * span)
    inside = area.contains(middle) & np.isfinite(speeds)
    counts = inside.sum(axis=1)
    some = counts > 0
    means = np.where(inside, speeds, 0.0)[some].sum(axis=1) / counts[some]
    return counts[some] / ((area.right - area.left) * (area.top - area.bottom)), means


def binned(densities: Floats, speeds: Floats, width: float, least: int) -> tuple[Floats, Floats]:
    """Return mean density and mean speed of each bin of this width (1/m^2) that holds at least so many instants."""
    bins = (densities / width).astype(np.int64)
    kept = [bins == k for k in np.unique(bins) if (bins == k).sum() >= least]
    return np.array([densities[k].mean() for k in kept]), np.array([speeds[k].mean() for k in kept])


def weidmann(densities: Floats, free_speed: float = 1.34) -> Floats:
    """Return the speed (m/s) at these densities after Weidmann, Transporttechnik der Fussgaenger, ETH Zuerich 1993."""
    return free_speed * (1.0 - np.exp(-1.913 * (1.0 / densities - 1.0 / 5.4)))


def read_trajectories(path: Path, rate: float = 16.0) -> tuple[Floats, float]:
    """Read rows of (person, frame, x, y, z) in cm, plain or gzipped; return positions (T, P, 2) m, NaN when absent, and ``rate`` (1/s)."""
    opened = gzip.open if path.suffix == ".gz" else open
    try:
        with opened(path, "rt") as file:
            rows = np.array([line.split() for line in file], np.float64)
        people, frames = rows[:, 0].astype(np.int64), rows[:, 1].astype(np.int64)
        positions = np.full((int(np.ptp(frames)) + 1, int(np.ptp(people)) + 1, 2), np.nan)
        positions[frames - frames.min(), people - people.min()] = rows[:, 2:4] / 100.0
    except (OSError, ValueError, IndexError) as error:
        raise InputFileError(f"{path}: {error}; allowed: rows of person, frame, x, y, z in cm") from error
    return positions, rate
