"""Draw speed over density, measured and simulated: ``python -m arena_pedsim PICTURE.png [TRAJECTORIES...]``."""

from __future__ import annotations

import argparse
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from numpy.typing import NDArray

from arena_core import load_registry
from arena_pedsim.fundamental_diagram import Area, binned, measure, read_trajectories, weidmann
from arena_pedsim.ring_corridor import MEASURED, RATE, people, walk_round

NUMBERS = (6, 15, 30, 45, 60, 75, 90, 105, 120, 140, 160)
FREE_SPEED, RADIUS = 1.48, 0.2  # m/s and m: of the recorded people at low density; shoulders are 0.4 m wide
RECORDED = Area(0.0, 1.8, -1.0, 3.0)  # m, the middle of the recorded corridor
BIN, LEAST = 0.25, 16  # 1/m^2, instants


def simulated(**social: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return binned density and speed of the ring corridor over crowds of all NUMBERS; ``social`` replaces numbers of that group."""
    preset: Any = yaml.safe_load((files("arena_pedsim.conf") / "pedestrians" / "social_force.yaml").read_text())
    model = load_registry().build("pedestrians", {**preset, "social": {**preset["social"], **social}})
    walks = [walk_round(model, people(number, FREE_SPEED, RADIUS, number), 40.0, 20.0) for number in NUMBERS]
    densities, speeds = zip(*(measure(walk, RATE, MEASURED) for walk in walks), strict=True)
    return binned(np.concatenate(densities), np.concatenate(speeds), BIN, LEAST)


def draw(picture: Path, recordings: list[Path]) -> None:
    """Write the picture."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.0, 4.5), layout="constrained")
    axes = figure.subplots()
    for recording in recordings:
        axes.plot(
            *binned(*measure(*read_trajectories(recording), RECORDED), BIN, LEAST), "s", label=f"recorded: {recording.name.split('.')[0]}"
        )
    axes.plot(*simulated(), "o-", label="social_force")
    axes.plot(*simulated(rear_weight=1.0), "o--", color="0.6", label="social_force, rear_weight = 1")
    grid = np.linspace(0.1, 3.0, 100)
    axes.plot(grid, weidmann(grid), "k-", linewidth=1, label="Weidmann 1993, free speed 1.34 m/s")
    axes.plot(grid, weidmann(grid, FREE_SPEED), "k:", linewidth=1, label=f"the same scaled to {FREE_SPEED} m/s")
    axes.set(xlabel="density [1/m²]", ylabel="speed [m/s]", xlim=(0.0, 3.0), ylim=(0.0, 1.8))
    axes.legend(fontsize="small")
    figure.savefig(picture, dpi=110)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(prog="python -m arena_pedsim", description=__doc__)
    parser.add_argument("picture", type=Path)
    parser.add_argument("recordings", type=Path, nargs="*")
    arguments = parser.parse_args()
    draw(arguments.picture, arguments.recordings)
