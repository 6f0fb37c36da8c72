"""Whether people who walk against each other through a corridor form lanes."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from arena_core import PedestrianModel, PedestrianSpec, Scenario
from arena_crowds.validation.findings import Findings
from arena_crowds.validation.floor_plan import Area, floor_world, make_scenario
from arena_crowds.validation.walks import simulate_walks

Floats = NDArray[np.float64]

WIDTH, LENGTH, ROOM = 4.0, 24.0, 10.0  # m, of the corridor, and side of the square room at each end
CORRIDOR = Area(ROOM, ROOM + LENGTH, (ROOM - WIDTH) / 2, (ROOM + WIDTH) / 2)
MEASURED = Area(ROOM + 4.0, ROOM + LENGTH - 4.0, CORRIDOR.bottom, CORRIDOR.top)
# of waypoints
LEFT, RIGHT = (
    Area(0.5, ROOM - 2.0, 0.5, ROOM - 0.5),
    Area(ROOM + LENGTH + 2.0, 2 * ROOM + LENGTH - 0.5, 0.5, ROOM - 0.5),
)
NUMBERS, SEEDS = (20, 40, 80, 120, 160), 3
SPEED, SPREAD, RADIUS = 1.34, 0.2, 0.2  # m/s and m (Weidmann 1993: 1.34 and 0.26)
SECONDS, SETTLING, RATE = 180.0, 60.0, 2.0  # s, s, 1/s
BAND = 0.5  # m, width of the strips in which directions are compared: a lane
SPAN = 5.0  # s, over which the picture's course is averaged
FEWEST = 3  # people in each direction, with fewer there is nothing to order


def run(models: Mapping[str, PedestrianModel], recordings: Path | None) -> Findings:
    """Let crowds of all NUMBERS walk to and fro, SEEDS times; recordings are not used."""
    world = floor_world("lanes", (Area(0, ROOM, 0, ROOM), CORRIDOR, Area(ROOM + LENGTH, 2 * ROOM + LENGTH, 0, ROOM)))
    problems = [_counterflow_scenario(world, number, seed) for number in NUMBERS for seed in range(SEEDS)]
    courses = {
        name: [measure_lanes(positions) for positions in _walk_problems(model, problems)]
        for name, model in models.items()
    }
    rows = [
        _lane_row(name, i, course[i * SEEDS : (i + 1) * SEEDS])
        for name, course in courses.items()
        for i in range(len(NUMBERS))
    ]
    return Findings(rows, lambda figure: _draw_figure(figure, courses, rows), (9.5, 4.2))


def _counterflow_scenario(world: Any, number: int, seed: int) -> Scenario:
    """Put half of the people in each room; everybody walks between a place in the one and a
    place in the other for ever.
    """
    random = np.random.default_rng((number, seed))
    left, right = LEFT.places((number + 1) // 2, random), RIGHT.places(number // 2, random)
    starts = np.concatenate((left, right))
    goals = np.concatenate((RIGHT.places(len(left), random), LEFT.places(len(right), random)))
    speeds = np.clip(random.normal(SPEED, SPREAD, number), 0.6, None)
    people = [
        PedestrianSpec(k, starts[k], np.stack((goals[k], starts[k])), float(speeds[k]), RADIUS) for k in range(number)
    ]
    return make_scenario(world, people, SECONDS, f"lanes/{number}/{seed}")


def _walk_problems(model: PedestrianModel, problems: list[Scenario]) -> list[Floats]:
    positions = simulate_walks(model, problems, SECONDS, RATE)
    return [positions[:, k, : len(problem.pedestrians)] for k, problem in enumerate(problems)]


def measure_lanes(positions: Floats) -> Floats:
    """Return (T, 4): density (1/m^2), mean speed along the corridor (m/s), lane order, and that of directions dealt out
    at random.

    All of the corridor's measured part; all but the density are NaN where fewer than FEWEST people walk one way.
    """
    along = np.gradient(positions[..., 0], 1.0 / RATE, axis=0)
    bands = ((positions[..., 1] - MEASURED.bottom) / BAND).astype(np.int64)
    rows = np.full((len(positions), 4), np.nan)
    for t, now in enumerate(MEASURED.contains(positions)):
        forward = along[t, now] > 0.0
        rows[t, 0] = len(forward) / MEASURED.size
        if min(forward.sum(), (~forward).sum()) >= FEWEST:
            rows[t, 1:] = np.abs(along[t, now]).mean(), *lane_order(forward, bands[t, now])
    return rows


def lane_order(forward: NDArray[np.bool_], bands: NDArray[np.int64]) -> tuple[float, float]:
    """Return the mean over people of the squared surplus of one direction in their band, and its expectation at random.

    The order parameter of Rex and Loewen, Phys. Rev. E 75, 051402, 2007, with bands as Nowak and Schadschneider,
    Quantitative analysis of pedestrian counterflow in a cellular automaton model, Phys. Rev. E 85, 066128, 2012, have
    it for people. The expectation is over all ways to deal out the same directions (hypergeometric).
    """
    people, share = len(forward), float(forward.mean())
    order, expected = 0.0, 0.0
    for band in np.unique(bands):
        there = forward[bands == band]
        n = len(there)
        order += n * (2.0 * there.mean() - 1.0) ** 2
        expected += n * (2.0 * share - 1.0) ** 2 + 4.0 * share * (1.0 - share) * (people - n) / (people - 1.0)
    return order / people, expected / people


def _lane_row(name: str, i: int, courses: list[Floats]) -> dict[str, Any]:
    """Return means over time and seeds after SETTLING; ``order`` is 0 at random and 1 for lanes without strangers."""
    settled = np.concatenate([course[round(SETTLING * RATE) :] for course in courses])
    density, speed, order, expected = _nan_mean(settled)
    return {
        "who": name,
        "people": NUMBERS[i],
        "density_per_m2": float(density),
        "speed_m_per_s": float(speed),
        "order": float(order),
        "at_random": float(expected),
        "lanes": float((order - expected) / (1.0 - expected)),
    }


def _nan_mean(values: Floats) -> Floats:
    """Return the means along the first axis of what is not NaN."""
    valid = np.isfinite(values)
    counts = np.where(valid.any(axis=0), valid.sum(axis=0), np.nan)
    return np.asarray(np.where(valid, values, 0.0).sum(axis=0) / counts)


def _draw_figure(figure: Any, courses: Mapping[str, list[Floats]], rows: list[dict[str, Any]]) -> None:
    over_time, over_density = figure.subplots(1, 2)
    shown = len(NUMBERS) // 2 * SEEDS
    for name, course in courses.items():
        mean = _nan_mean(np.array(course[shown : shown + SEEDS]))
        spans = np.array([_nan_mean(span) for span in np.array_split(mean, round(SECONDS / SPAN))])
        times = SPAN * (np.arange(len(spans)) + 0.5)
        line = over_time.plot(times, spans[:, 2], "o-", markersize=3, label=name)[0]
        over_time.plot(times, spans[:, 3], ":", color=line.get_color(), label=f"{name}, at random")
        own = [row for row in rows if row["who"] == name]
        over_density.plot([row["density_per_m2"] for row in own], [row["order"] for row in own], "o-", label=name)
        over_density.plot(
            [row["density_per_m2"] for row in own], [row["at_random"] for row in own], "o:", color=line.get_color()
        )
    over_time.set(xlabel="time [s]", ylabel="order", ylim=(0.0, 1.0), title=f"{NUMBERS[len(NUMBERS) // 2]} people")
    over_density.set(xlabel="density [1/m²]", ylim=(0.0, 1.0), title=f"means from {SETTLING:g} s on; dotted: at random")
    over_time.legend(fontsize="small")
