"""Measure how the cost of a control step grows with beams, people, map and worlds; draw it, and print a table.

usage: .venv/bin/python benchmarks/cost_curves.py [--only beams people map worlds] [--to docs/images/cost.png]

Costs are CPU time of the process, the median over repeats whose sizes take turns, so that a machine's slow minutes meet
all sizes.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np
from bench_crowd import hall
from bench_lidar import rooms
from bench_simulator import STEP, robot, scenario

from arena_core import Scenario, Simulator, World
from arena_core.config.configuration import compose, to_plain
from arena_core.hosting import load_registry

HERE = Path(__file__).resolve().parents[1]
BEAMS, PEOPLE, SIDES, WORLDS = (
    (90, 180, 360, 720, 1440),
    (0, 3, 10, 30, 100, 300, 1000),
    (20, 50, 100, 200),
    (1, 4, 16, 64, 256, 1024),
)
REPEATS, WORLD_STEPS = 5, 64  # a repeat steps so many worlds in all, in as many calls as it takes
Curve = dict[float, float]


def make_simulator(beams: int, crowd: str) -> Simulator:
    """Return the simulator with a lidar of so many beams, as configured by default but without noise."""
    body = robot(0.0)
    body = replace(body, lidar=replace(body.lidar, beams=beams, angle_increment=2.0 * np.pi / beams))
    chosen = (
        to_plain(compose([], f"pedestrians/{crowd}").pedestrians),
        to_plain(compose([], "simulator/sim2d").simulator),
    )
    built: Simulator = load_registry().build(
        "simulator", chosen[1], robot=body, pedestrians=load_registry().build("pedestrians", chosen[0])
    )
    return built


def timed_steps(scenarios: Sequence[Scenario], beams: int = 360, crowd: str = "social_force") -> Callable[[], float]:
    """Return what steps these worlds and tells the CPU time of a control step of one of them, us."""
    built = make_simulator(beams, crowd)
    built.reset(scenarios)
    commands, ticks = np.tile((0.3, 0.0, 0.3), (len(scenarios), 1)), round(STEP / built.inner_step)
    calls = max(WORLD_STEPS // len(scenarios), 2)

    def run() -> float:
        began = time.process_time()
        for _ in range(calls):
            built.advance(commands, ticks)
        return 1e6 * (time.process_time() - began) / calls / len(scenarios)

    return run


def measure_in_turn(runs: Mapping[float, Callable[[], float]]) -> Curve:
    """Return the median of each size; all are run once to warm up, then in turn."""
    for run in runs.values():
        run()
    times: dict[float, list[float]] = {size: [] for size in runs}
    for _ in range(REPEATS):
        for size, run in runs.items():
            times[size].append(run())
    return {size: median(taken) for size, taken in times.items()}


def room_scenarios(worlds: int) -> list[Scenario]:
    """Return so many scenarios with ten people each in four rooms."""
    world = World("rooms", rooms())
    return [scenario(seed % 64, world) for seed in range(worlds)]


def density_scenario(people: int) -> Scenario:
    """Return four rooms with so many people at 40 m2 each, on a map of 20 m at least."""
    whole = hall(max(people, 10))
    return replace(whole, pedestrians=whole.pedestrians[:people])


def ten_people_scenario(side: float) -> Scenario:
    """Return four rooms of this side (m) in all, with ten people in them."""
    whole = hall(round(10 * (side / 20.0) ** 2))
    return replace(whole, pedestrians=whole.pedestrians[:10])


def measure_beams() -> dict[str, Curve]:
    """Measure steps by the number of beams."""
    return {"beams": measure_in_turn({count: timed_steps(room_scenarios(16), count) for count in BEAMS})}


def measure_people() -> dict[str, Curve]:
    """Measure steps by the number of people, of each crowd model."""
    models = ("social_force", "orca")
    return {
        f"people, {model}": measure_in_turn({n: timed_steps([density_scenario(n)], crowd=model) for n in PEOPLE})
        for model in models
    }


def measure_maps() -> dict[str, Curve]:
    """Measure steps by the side of the map, and its first reset, which makes the tables of the map (ms)."""
    first: Curve = {}
    for side in SIDES:
        began = time.process_time()
        make_simulator(360, "social_force").reset([ten_people_scenario(side)])
        first[side] = 1e3 * (time.process_time() - began)
    return {
        "map": measure_in_turn({side: timed_steps([ten_people_scenario(side)]) for side in SIDES}),
        "map, first reset": first,
    }


def measure_worlds() -> dict[str, Curve]:
    """Measure steps by the number of worlds in a batch."""
    return {"worlds": measure_in_turn({count: timed_steps(room_scenarios(count)) for count in WORLDS})}


PARTS: Mapping[str, Callable[[], dict[str, Curve]]] = {
    "beams": measure_beams,
    "people": measure_people,
    "map": measure_maps,
    "worlds": measure_worlds,
}
PANELS = {  # title: axis below, axis beside, curves
    "Beams": ("beams of the lidar", "µs a control step", ["beams"]),
    "People": ("people, 40 m² each", "µs a control step", ["people, social_force", "people, orca"]),
    "Map": ("side of the map, m", "µs a control step", ["map"]),
    "Map, once": ("side of the map, m", "ms, first reset", ["map, first reset"]),
    "Batch": ("worlds in a batch", "µs a step of one world", ["worlds"]),
}


def growth_exponent(curve: Curve) -> float:
    """Return the exponent of growth between the last two sizes: 1 is linear."""
    (size, cost), (larger, more) = list(curve.items())[-2:]
    return float(np.log(more / cost) / np.log(larger / size))


def draw_curves(curves: Mapping[str, Curve], target: Path) -> None:
    """Draw all curves that were measured, on logarithmic axes."""
    import matplotlib as mpl

    mpl.use("Agg")
    from matplotlib import pyplot as plt

    figure, axes = plt.subplots(2, 3, figsize=(11, 6.4), layout="constrained")
    for axis in axes.flat[len(PANELS) :]:
        axis.set_axis_off()
    for axis, (title, (below, beside, names)) in zip(axes.flat, PANELS.items(), strict=False):
        for name in names:
            curve = {size: cost for size, cost in curves.get(name, {}).items() if size > 0}
            axis.plot(list(curve), list(curve.values()), "o-", label=name.partition(", ")[2].replace("_", " ") or None)
        axis.set(title=title, xlabel=below, ylabel=beside, xscale="log", yscale="log")
        axis.grid(visible=True, which="major", alpha=0.3)
        sizes = sorted({size for name in names for size in curves.get(name, {}) if size > 0})
        axis.set_xticks(sizes, [f"{size:g}" for size in sizes])
        axis.xaxis.minorticks_off()
        low, high = axis.get_ylim()
        axis.set_ylim(low / 2.0, 2.0 * high)
        axis.yaxis.set_major_formatter("{x:g}")
        axis.yaxis.set_minor_formatter("")
        if len(names) > 1:
            axis.legend()
    target.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(target, dpi=110)


def curve_table(curves: Mapping[str, Curve]) -> str:
    """Return the curves as a Markdown table."""
    lines = ["| what | cost by size | growth |", "| --- | --- | --- |"]
    for name, curve in curves.items():
        costs = ", ".join(f"{size:g}: {cost:.3g}" for size, cost in curve.items())
        lines.append(f"| {name} | {costs} | {growth_exponent(curve):.2f} |")
    return "\n".join(lines)


def main(arguments: Sequence[str]) -> int:
    """Measure, keep what was measured, draw it, and print it."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", nargs="+", choices=PARTS, default=list(PARTS))
    parser.add_argument("--to", type=Path, default=HERE / "docs" / "images" / "cost.png")
    given = parser.parse_args(arguments)
    kept = HERE / "benchmarks" / "results" / "cost_curves.json"
    known: dict[str, Any] = json.loads(kept.read_text()) if kept.exists() else {}
    curves = {name: {float(size): cost for size, cost in curve.items()} for name, curve in known.items()}
    for part in given.only:
        curves |= PARTS[part]()
    kept.parent.mkdir(exist_ok=True)
    kept.write_text(json.dumps(curves, indent=1) + "\n")
    draw_curves(curves, given.to)
    print(curve_table(curves))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
