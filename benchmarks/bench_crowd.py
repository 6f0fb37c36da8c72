"""Time one step of a crowd (10, 100 and 1,000 people at the same density) against
pysocialforce and navground's ORCA.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Mapping
from dataclasses import replace
from importlib.util import find_spec
from statistics import median
from typing import Any

import numpy as np
from numpy.typing import NDArray
from timing import interleave

from arena_core import OccupancyGrid, PedestrianSpec, Pose, RobotBatch, Scenario, World
from arena_core.config.configuration import compose, to_plain
from arena_core.hosting import load_registry

PEOPLE = (10, 100, 1000)
SIDE = 20.0  # m for ten people; others have the same density
RADIUS, SPEED, STEP, SIGHT = 0.3, 1.3, 0.05, 5.0  # m, m/s, s, m
REPEATS = 7
GOALS = {"pysocialforce": {1000: 1 / 500}}
BATCH, BATCH_GOAL = 64, 1 / 300  # ten people of one world among so many, against pysocialforce
CALLS = {  # a repeat lasts some tenths of a second
    "ours": {10: 4000, 100: 1000, 1000: 100},
    "pysocialforce": {10: 50, 100: 30, 1000: 1},
    "navground ORCA": {10: 2000, 100: 200, 1000: 10},
}
Floats = NDArray[np.float64]


def crossing(people: int) -> tuple[float, Floats, Floats, Floats]:
    """Return the side of a square of four rooms (m), its ten walls (x, y, x, y), and starts (P,
    2) and goals (P, 2) of people.
    """
    side = SIDE * np.sqrt(people / 10)
    random = np.random.default_rng(people)
    rows = int(np.ceil(np.sqrt(people)))
    lattice = np.stack(np.divmod(np.arange(people), rows), axis=1) + random.uniform(0.3, 0.7, (people, 2))
    starts, goals = lattice * (side - 2.0) / rows + 1.0, random.uniform(2.0, side - 2.0, (people, 2))
    for places in (starts, goals):  # off the walls in the middle
        places[np.abs(places - side / 2) < 0.6] += 1.2
    return side, _make_walls(side), starts, goals


def _make_walls(side: float) -> Floats:
    """Return the border and two walls with two doors of 1.5 m each, (10, 4)."""
    border = [(0, 0, side, 0), (0, side, side, side), (0, 0, 0, side), (side, 0, side, side)]
    stretches = [(0.0, side / 4 - 0.75), (side / 4 + 0.75, 3 * side / 4 - 0.75), (3 * side / 4 + 0.75, side)]
    inner = [(side / 2, low, side / 2, high) for low, high in stretches] + [
        (low, side / 2, high, side / 2) for low, high in stretches
    ]
    return np.array(border + inner)


def hall(people: int) -> Scenario:
    """Return the square with its walls on a map, each person walking between its goal and its start."""
    side, walls, starts, goals = crossing(people)
    data = np.zeros((round(side / 0.1) + 1,) * 2, np.int8)
    for left, bottom, right, top in np.floor(walls / 0.1).astype(int):
        data[bottom : top + 1, left : right + 1] = 100
    specs = [PedestrianSpec(k, starts[k], np.stack((goals[k], starts[k])), SPEED, RADIUS) for k in range(people)]
    here = Pose(1.0, 1.0)
    return Scenario(
        "crowd", 0, World("hall", OccupancyGrid(data, 0.1, Pose(0.0, 0.0))), here, here, tuple(specs), (), 0.3, 180.0
    )


def our_steps(people: int, worlds: int = 1, preset: str = "social_force") -> Callable[[], None]:
    """Return steps of the social-force crowd in so many worlds, each with random numbers of its own."""
    scenario = hall(people)
    scenarios = [replace(scenario, seed=seed) for seed in range(worlds)]
    node: Any = to_plain(compose([], f"pedestrians/{preset}").pedestrians)
    model = load_registry().build("pedestrians", node)
    crowd = model.reset(np.arange(worlds), scenarios, worlds)
    robots, ticks = RobotBatch(np.zeros((worlds, 3)), np.zeros((worlds, 2)), 0.2), np.zeros(worlds, np.int64)

    def run() -> None:
        nonlocal crowd, ticks
        for _ in range(CALLS["ours"][people] // worlds):
            crowd = model.step(crowd, robots, ticks, STEP)
            ticks = ticks + 1

    return run


def pysocialforce_steps(people: int) -> Callable[[], None]:
    """Return steps of pysocialforce without groups."""
    import pysocialforce as psf

    logging.getLogger().setLevel(logging.WARNING)  # it turns on everybody's debug messages
    _, walls, starts, goals = crossing(people)
    velocities = SPEED * (goals - starts) / np.linalg.norm(goals - starts, axis=1, keepdims=True)
    simulator = psf.Simulator(np.hstack((starts, velocities, goals)), obstacles=walls[:, [0, 2, 1, 3]].tolist())

    def run() -> None:
        for _ in range(CALLS["pysocialforce"][people]):
            simulator.step(1)
            simulator.peds.ped_states.clear()  # it keeps every state
            simulator.peds.group_states.clear()

    return run


def navground_steps(people: int) -> Callable[[], None]:
    """Return steps of navground's ORCA; people see as far as ours do."""
    from navground import core, sim

    _, walls, starts, goals = crossing(people)
    world = sim.World()
    for left, bottom, right, top in walls:
        world.add_wall(sim.Wall(np.array((left, bottom)), np.array((right, top))))
    for start, goal in zip(starts, goals, strict=True):
        agent = sim.Agent(radius=RADIUS, control_period=STEP)
        agent.kinematics = core.kinematics.OmnidirectionalKinematics(SPEED)
        agent.behavior = core.Behavior.make_type("ORCA")
        agent.behavior.optimal_speed = SPEED
        agent.state_estimation = sim.state_estimations.BoundedStateEstimation(range=SIGHT)
        agent.task = sim.tasks.WaypointsTask([goal, start], loop=True, tolerance=0.5)
        agent.position = start
        world.add_agent(agent)

    def run() -> None:
        for _ in range(CALLS["navground ORCA"][people]):
            world.update(STEP)

    return run


PEERS = {"pysocialforce": ("pysocialforce", pysocialforce_steps), "navground ORCA": ("navground", navground_steps)}


def measure() -> list[dict[str, Any]]:
    """Return a row for each number of people and each peer that is installed, and one for a batch of 64 worlds."""
    installed = {name: make for name, (module, make) in PEERS.items() if find_spec(module)}
    rows = []
    for people in PEOPLE:
        runs = {"ours": our_steps(people), **{name: make(people) for name, make in installed.items()}}
        times = interleave(runs, REPEATS)
        ms = {name: 1e3 * median(times[name]) / CALLS[name][people] for name in runs}
        what = f"crowd step, {people} people"
        rows += [
            _make_row(what, ms["ours"], peer, ms[peer], GOALS.get(peer, {}).get(people)) for peer in installed
        ] or [_make_row(what, ms["ours"])]
    rows += _preset_rows(installed, 10, BATCH, f"crowd step, 10 people, a world of a batch of {BATCH}", BATCH_GOAL)
    return rows + _preset_rows(installed, 1000, 1, "crowd step, 1000 people", GOALS["pysocialforce"][1000])[1:]


def _preset_rows(
    installed: Mapping[str, Callable[[int], Callable[[], None]]], people: int, worlds: int, what: str, goal: float
) -> list[dict[str, Any]]:
    """Return the rows of people whose states never change, and of lively ones, in
    worlds that are stepped in one call.
    """
    peer = "pysocialforce" if "pysocialforce" in installed else None
    runs = {preset: our_steps(people, worlds, preset) for preset in ("social_force", "social_force_lively")}
    times = interleave({**runs, **({peer: installed[peer](people)} if peer else {})}, REPEATS)
    peer_ms = 1e3 * median(times[peer]) / CALLS[peer][people] if peer else None
    ms = {preset: 1e3 * median(times[preset]) / (CALLS["ours"][people] // worlds * worlds) for preset in runs}
    lively = f"{what}, social states"
    return [_make_row(text, ms[preset], peer, peer_ms, goal) for text, preset in zip((what, lively), runs, strict=True)]


def _make_row(
    what: str, ours_ms: float, peer: str | None = None, peer_ms: float | None = None, goal: float | None = None
) -> dict[str, Any]:
    ratio = None if peer_ms is None else ours_ms / peer_ms
    return {
        "what": what,
        "ours_ms": ours_ms,
        "peer": peer,
        "peer_ms": peer_ms,
        "ratio": ratio,
        "goal": goal,
        "unit": "x peer",
    }


if __name__ == "__main__":
    for row in measure():
        print(f"{row['what']}: {row['ours_ms']:.4f} ms", end="")
        print("" if row["peer"] is None else f", {row['peer']} {row['peer_ms']:.4f} ms, 1/{1 / row['ratio']:.1f}")
