"""How many people a second get out through a door, and whether hurry helps."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from arena_core import PedestrianModel, PedestrianSpec, Scenario
from arena_crowds.validation.findings import Findings
from arena_crowds.validation.floor_plan import Area, floor_world, make_scenario
from arena_crowds.validation.walks import simulate_walks

Floats = NDArray[np.float64]

SIDE, WALL = 8.0, 0.4  # m, of the room, and thickness of the wall with the door
PEOPLE, RADIUS = 80, 0.2  # and m
ROOM, OUTSIDE = Area(0.0, SIDE, 0.0, SIDE), Area(SIDE + WALL, SIDE + WALL + 8.0, -8.0, SIDE + 8.0)
START = Area(0.3, SIDE - 1.0, 0.3, SIDE - 0.3)
GOALS = Area(SIDE + WALL + 5.0, SIDE + WALL + 7.5, -7.5, SIDE + 7.5)
WIDTHS, SPEED = (0.8, 1.0, 1.2, 1.6, 2.0, 2.4), 1.34  # m and m/s
HURRIES, HURRIED_WIDTH = (0.6, 1.0, 1.34, 2.0, 3.0, 4.0), 1.0  # m/s and m
SPREAD = 0.15  # of a speed, standard deviation
SEEDS, SECONDS, RATE = 5, 150.0, 10.0  # , s, 1/s
STEADY = (10, 60)  # the people between whose passing the flow is taken: neither the first rush nor the last stragglers
LITERATURE = (1.3, 1.9)  # 1/(m s), from the SFPE handbook to Seyfried et al. 2009


def run(models: Mapping[str, PedestrianModel], recordings: Path | None) -> Findings:
    """Empty the room through doors of all WIDTHS, and through one door in all HURRIES, SEEDS
    times; recordings are not used.
    """
    cases = [(width, SPEED) for width in WIDTHS] + [(HURRIED_WIDTH, speed) for speed in HURRIES]
    problems = [evacuation_scenario(*case, seed) for case in cases for seed in range(SEEDS)]
    rows = []
    for name, model in models.items():
        times = passing_times(simulate_walks(model, problems, SECONDS, RATE)).reshape(len(cases), SEEDS, PEOPLE)
        rows += [_case_row(name, case, own) for case, own in zip(cases, times, strict=True)]
    return Findings(rows, lambda figure: _draw_figure(figure, list(models), rows), (9.5, 4.2))


def evacuation_scenario(width: float, speed: float, seed: int) -> Scenario:
    """Return people who leave a room through a door in the middle of its right wall, each to a
    place of its own outside.
    """
    random = np.random.default_rng((round(100 * width), round(100 * speed), seed))
    door = Area(SIDE - 0.1, SIDE + WALL + 0.1, SIDE / 2 - width / 2, SIDE / 2 + width / 2)
    starts, goals = START.places(PEOPLE, random), GOALS.places(PEOPLE, random)
    speeds = speed * np.clip(random.normal(1.0, SPREAD, PEOPLE), 0.5, 1.5)
    people = [PedestrianSpec(k, starts[k], goals[k : k + 1], float(speeds[k]), RADIUS) for k in range(PEOPLE)]
    return make_scenario(
        floor_world("door", (ROOM, door, OUTSIDE)), people, SECONDS, f"door/{width:g}/{speed:g}/{seed}"
    )


def passing_times(positions: Floats) -> Floats:
    """Return when the first, second, ... person is behind the wall, (N, P) s; inf for those who never are.

    ``positions`` (T, N, P, 2).
    """
    out = positions[..., 0] > SIDE + WALL
    return np.sort(np.where(out.any(axis=0), out.argmax(axis=0) / RATE, np.inf), axis=-1)


def door_flow(times: Floats) -> float:
    """Return the people a second between the first and the last of STEADY, of rising passing
    times; 0 if those never came out.
    """
    first, last = STEADY
    return float((last - first) / (times[last] - times[first])) if np.isfinite(times[last]) else 0.0


def _case_row(name: str, case: tuple[float, float], times: Floats) -> dict[str, Any]:
    """Return what came of one case over its seeds; ``seconds`` until nine in ten are out."""
    flows = np.array([door_flow(own) for own in times])
    most = times[:, round(0.9 * PEOPLE) - 1]
    return {
        "who": name,
        "width_m": case[0],
        "speed_m_per_s": case[1],
        "flow_per_s": float(flows.mean()),
        "flow_per_m_s": float(flows.mean() / case[0]),
        "spread_per_m_s": float(flows.std() / case[0]),
        "seconds": float(most.mean()),
        "left_inside": float(np.isinf(times).sum(axis=1).mean()),
    }


def _draw_figure(figure: Any, names: Sequence[str], rows: Sequence[Mapping[str, Any]]) -> None:
    over_width, over_speed = figure.subplots(1, 2)
    ends = np.array((0.7, 2.5))
    over_width.fill_between(
        ends, LITERATURE[0] * ends, LITERATURE[1] * ends, color="0.85", label="measured: 1.3 to 1.9 /(m s)"
    )
    for name in names:
        own = [row for row in rows if row["who"] == name]
        wide, hurried = own[: len(WIDTHS)], own[len(WIDTHS) :]
        over_width.plot(WIDTHS, [row["flow_per_s"] for row in wide], "o-", label=name)
        over_speed.plot(HURRIES, [row["seconds"] for row in hurried], "o-", label=name)
    over_width.set(
        xlabel="width of the door [m]", ylabel="flow [1/s]", ylim=(0.0, None), title=f"{PEOPLE} people, {SPEED} m/s"
    )
    over_speed.set(xlabel="desired speed [m/s]", ylabel="time until nine in ten are out [s]", ylim=(0.0, None))
    over_speed.set(title=f"door of {HURRIED_WIDTH:g} m")
    over_width.legend(fontsize="small")
