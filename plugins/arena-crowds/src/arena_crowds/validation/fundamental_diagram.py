"""How walking speed falls with density: measured alike on recorded trajectories and on the model."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from arena_crowds.validation.floor_plan import Area

Floats = NDArray[np.float64]

SPAN = 0.3  # s before and after an instant over which a speed is taken: shorter spans measure the swaying of heads


def measure_density_speed(positions: Floats, rate: float, area: Area) -> tuple[Floats, Floats]:
    """Return density (1/m^2) and mean speed (m/s) in the area at each instant with a person in it.

    ``positions`` (T, P, 2) m, NaN where a person is absent, ``rate`` in 1/s. Density is the number of people in the
    area over its size, as method A and B of Zhang et al., Transitions in pedestrian fundamental diagrams of straight
    corridors and T-junctions, J. Stat. Mech. P06004, 2011, have it; a speed is a person's displacement from SPAN before
    to SPAN after.
    """
    span = round(SPAN * rate)
    middle = positions[span:-span]
    speeds = np.linalg.norm(positions[2 * span :] - positions[: -2 * span], axis=-1) * rate / (2 * span)
    inside = area.contains(middle) & np.isfinite(speeds)
    counts = inside.sum(axis=1)
    some = counts > 0
    means = np.where(inside, speeds, 0.0)[some].sum(axis=1) / counts[some]
    return counts[some] / area.size, means


def bin_speeds(densities: Floats, speeds: Floats, width: float, least: int) -> tuple[Floats, Floats]:
    """Return mean density and mean speed of each bin of this width (1/m^2) that holds at least so many instants."""
    bins = (densities / width).astype(np.int64)
    kept = [bins == k for k in np.unique(bins) if (bins == k).sum() >= least]
    return np.array([densities[k].mean() for k in kept]), np.array([speeds[k].mean() for k in kept])


def weidmann_speed(densities: Floats, free_speed: float = 1.34) -> Floats:
    """Return the speed (m/s) at these densities after Weidmann, Transporttechnik der Fussgaenger, ETH Zuerich 1993."""
    return free_speed * (1.0 - np.exp(-1.913 * (1.0 / densities - 1.0 / 5.4)))
