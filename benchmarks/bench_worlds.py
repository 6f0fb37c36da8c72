"""Time the generation of 25 x 25 m at 0.05 m, each kind, against its plain twin: the same hall, and free
space checked by scipy alone.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import count
from statistics import median
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage
from timing import interleave

from arena_core import FREE, OCCUPIED, OccupancyGrid
from arena_core.testing import component
from arena_worlds.commands.measures import measures_of
from arena_worlds.generators.canvas import Canvas
from arena_worlds.generators.generated import Generated

KINDS, GOAL_MS, REPEATS = ("indoor", "outdoor", "rooms", "cellular"), 150.0, 15
SIZE = ("world.width=25", "world.height=25", "world.resolution=0.05")


def our_worlds(source: Generated, seeds: Iterator[int]) -> Callable[[], None]:
    """Return the generation of one new world."""
    return lambda: source.world(next(seeds), 0) and None


def plain_worlds(source: Generated, seeds: Iterator[int]) -> Callable[[], None]:
    """Return the same with distances by scipy, and places filled one after the other until one is left."""

    def run() -> None:
        canvas = source.draw(np.random.default_rng(next(seeds)))
        _keep_largest(canvas, source.robot_radius, source.resolution)
        canvas.grid()

    return run


def _keep_largest(canvas: Canvas, radius: float, resolution: float) -> None:
    while True:
        labels, places = ndimage.label(_distance_field(canvas.inside == FREE, resolution) >= radius + 0.5 * resolution)
        if places <= 1:
            return
        sizes = [int((labels == k).sum()) for k in range(1, places + 1)]
        smallest = labels == 1 + int(np.argmin(sizes))
        canvas.inside[_distance_field(~smallest, resolution) < radius] = OCCUPIED


def _distance_field(free: NDArray[np.bool_], resolution: float) -> NDArray[np.float64]:
    return np.asarray(ndimage.distance_transform_edt(np.pad(free, 1))[1:-1, 1:-1] * resolution)


def measure() -> list[dict[str, Any]]:
    """Return the median time of a world of each kind, easy and hard, and of its measures."""
    rows = []
    for kind in KINDS:
        for difficulty in (0.5, 1.0):
            source = component("world", kind, [*SIZE, f"world.difficulty={difficulty}"])
            times = interleave({"ours": our_worlds(source, count()), "plain": plain_worlds(source, count())}, REPEATS)
            rows.append(
                _make_row(
                    f"world of 25 x 25 m, {kind}, difficulty {difficulty:g}",
                    *(1e3 * median(times[k]) for k in ("ours", "plain")),
                )
            )
    grid: OccupancyGrid = component("world", "rooms", list(SIZE)).world(0, 0).grid
    seconds = interleave({"measures": lambda: measures_of(grid, 0.35) and None}, REPEATS)["measures"]
    rows.append({**_make_row("measures of 25 x 25 m, rooms", 1e3 * median(seconds), None), "goal": None})
    return rows


def _make_row(what: str, ours_ms: float, peer_ms: float | None) -> dict[str, Any]:
    ratio = None if peer_ms is None else ours_ms / peer_ms
    peer = None if peer_ms is None else "scipy alone"
    return {
        "what": what,
        "ours_ms": ours_ms,
        "peer": peer,
        "peer_ms": peer_ms,
        "ratio": ratio,
        "goal": GOAL_MS,
        "unit": "ms",
    }


if __name__ == "__main__":
    for row in measure():
        against = "" if row["ratio"] is None else f", {row['peer']} {row['peer_ms']:.1f} ms, ratio {row['ratio']:.2f}"
        print(f"{row['what']}: {row['ours_ms']:.1f} ms{against}")
