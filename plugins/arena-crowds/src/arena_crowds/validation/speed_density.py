"""How fast people walk at which density: recorded, after Weidmann, and in the models."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from arena_core import InputFileError, PedestrianModel
from arena_crowds.replay.recordings import read_recording
from arena_crowds.validation.findings import Findings
from arena_crowds.validation.floor_plan import Area
from arena_crowds.validation.fundamental_diagram import bin_speeds, measure_density_speed, weidmann_speed
from arena_crowds.validation.ring_corridor import MEASURED, RATE, spread_people, walk_ring

Curve = tuple[NDArray[np.float64], NDArray[np.float64]]

NUMBERS = (6, 15, 30, 45, 60, 75, 90, 105, 120, 140, 160)
DRAWS = 3  # crowds of each number: where a flow breaks down into stop and go is chance
FREE_SPEED, RADIUS = 1.48, 0.2  # m/s and m: of the recorded people at low density; shoulders are 0.4 m wide
RECORDED, FRAME_RATE = Area(0.0, 1.8, -1.0, 3.0), 16.0  # m, the middle of the recorded corridor; 1/s
BIN, LEAST = 0.25, 16  # 1/m^2, instants


def run(models: Mapping[str, PedestrianModel], recordings: Path | None) -> Findings:
    """Measure the models, and the recordings juelich/uo-*.txt where there are some."""
    found = sorted(recordings.glob("juelich/uo-*.txt*")) if recordings else []
    if recordings and not found:
        raise InputFileError(
            f"{recordings}: no juelich/uo-*.txt below it; allowed: the folder of the recordings, or none"
        )
    curves = {f"recorded: {path.name.split('.')[0]}": recorded_curve(path) for path in found}
    curves |= {name: simulated_curve(model) for name, model in models.items()}
    return Findings(_bin_rows(curves), lambda figure: _draw_figure(figure, curves))


def recorded_curve(path: Path) -> Curve:
    """Return binned density (1/m^2) and speed (m/s) of a recording."""
    return bin_speeds(
        *measure_density_speed(read_recording(path, "juelich").sample_positions(FRAME_RATE), FRAME_RATE, RECORDED),
        BIN,
        LEAST,
    )


def simulated_curve(model: PedestrianModel, numbers: tuple[int, ...] = NUMBERS) -> Curve:
    """Return binned density (1/m^2) and speed (m/s) in the ring corridor, over
    several crowds of so many people each.
    """
    seeds = [(number, number + 1000 * draw) for number in numbers for draw in range(DRAWS)]
    walks = [walk_ring(model, spread_people(number, FREE_SPEED, RADIUS, seed), 40.0, 20.0) for number, seed in seeds]
    densities, speeds = zip(*(measure_density_speed(walk, RATE, MEASURED) for walk in walks), strict=True)
    return bin_speeds(np.concatenate(densities), np.concatenate(speeds), BIN, LEAST)


def _bin_rows(curves: Mapping[str, Curve]) -> list[dict[str, Any]]:
    """Return a row a bin, with how far its speed is from Weidmann's for the same free speed."""
    rows = []
    for who, curve in curves.items():
        for density, speed in zip(*curve, strict=True):
            off = speed - float(weidmann_speed(np.array([density]), FREE_SPEED)[0])
            rows.append(
                {"who": who, "density_per_m2": float(density), "speed_m_per_s": float(speed), "off_weidmann": off}
            )
    return rows


def _draw_figure(figure: Any, curves: Mapping[str, Curve]) -> None:
    axes = figure.subplots()
    for who, curve in curves.items():
        axes.plot(*curve, "s" if who.startswith("recorded") else "o-", label=who)
    grid = np.linspace(0.1, 3.0, 100)
    axes.plot(grid, weidmann_speed(grid), "k-", linewidth=1, label="Weidmann 1993, free speed 1.34 m/s")
    axes.plot(grid, weidmann_speed(grid, FREE_SPEED), "k:", linewidth=1, label=f"the same scaled to {FREE_SPEED} m/s")
    axes.set(xlabel="density [1/m²]", ylabel="speed [m/s]", xlim=(0.0, 3.0), ylim=(0.0, 1.8))
    axes.legend(fontsize="small")
