"""Measure how hard generated worlds are at each difficulty; with a folder, also draw the figures of docs/worlds.md."""

from __future__ import annotations

import sys
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from arena_core.testing import component
from arena_worlds.commands.measures import Measures, measures_of
from arena_worlds.commands.portrait import FLOOR, WALL
from arena_worlds.generators.generated import Generated

KINDS, SEEDS = ("indoor", "outdoor", "rooms", "cellular"), 20
STEPS, SHOWN, SHOWN_SEED = (0.0, 0.2, 0.4, 0.6, 0.8, 1.0), (0.2, 0.5, 0.8), 3
FIGURES = {
    "mean_clearance": "mean clearance, m",
    "passage": "passage, m",
    "tortuosity": "tortuosity",
    "visibility": "visibility, m",
}


def main(folder: Path | None) -> None:
    """Print the means over SEEDS worlds of each kind and difficulty."""
    names = list(Measures.__dataclass_fields__)
    print("kind      difficulty  " + "  ".join(names))
    means = {}
    for kind in KINDS:
        source: Generated = component("world", kind)
        means[kind] = np.array([_mean_measures(source.at(difficulty)) for difficulty in STEPS])
        for difficulty, row in zip(STEPS, means[kind], strict=True):
            print(
                f"{kind:9} {difficulty:10}  " + "  ".join(f"{v:{len(n)}.2f}" for n, v in zip(names, row, strict=True))
            )
    if folder is not None:
        _save_figure(_draw_gallery(), folder / "worlds.png", 100)
        _save_figure(_draw_curves(means, names), folder / "world_measures.png", 90)


def _mean_measures(source: Generated) -> NDArray[np.float64]:
    found = [measures_of(source.world(seed, 0).grid, source.robot_radius) for seed in range(SEEDS)]
    return np.array([[value for _, value, _, _ in measures.rows()] for measures in found]).mean(axis=0)


def _draw_gallery() -> Figure:
    figure = Figure((6.6, 9.0), layout="constrained")
    for k, axes in enumerate(figure.subplots(len(KINDS), len(SHOWN)).flat):
        kind, difficulty = KINDS[k // len(SHOWN)], SHOWN[k % len(SHOWN)]
        source: Generated = component("world", kind)
        occupied = source.at(difficulty).world(SHOWN_SEED, 0).grid.occupied
        axes.imshow(
            np.where(occupied[..., None], np.uint8(WALL), np.uint8(FLOOR)), origin="lower", interpolation="hanning"
        )
        axes.set(xticks=[], yticks=[])
        axes.set_title(f"{kind}, {difficulty:g}", fontsize=10)
    return figure


def _draw_curves(means: dict[str, NDArray[np.float64]], names: list[str]) -> Figure:
    figure = Figure((9.0, 2.6), layout="constrained")
    axes: Axes
    for axes, (name, label) in zip(figure.subplots(1, len(FIGURES)), FIGURES.items(), strict=True):
        for kind, rows in means.items():
            axes.plot(STEPS, rows[:, names.index(name)], marker=".", label=kind)
        axes.set(xlabel="difficulty", title=label, ylim=(0.0 if name != "tortuosity" else 0.9, None))
        axes.spines[["top", "right"]].set_visible(False)
    axes.legend(frameon=False, fontsize=8)
    return figure


def _save_figure(figure: Figure, path: Path, dpi: int) -> None:
    with mpl.rc_context({"font.size": 9}):
        figure.savefig(path, dpi=dpi)


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else None)
