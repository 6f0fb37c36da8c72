"""Time one step of a crowd of ORCA agents among walls against pyrvo (the authors' C++ library), 10, 100 and 1,000
people.

pyrvo finds no way round walls: its people are told their preferred velocities once; ours search routes and follow them.
"""

from __future__ import annotations

from collections.abc import Callable
from statistics import median
from typing import Any

import numpy as np
from bench_crowd import PEOPLE, RADIUS, SIGHT, SPEED, STEP, crossing, hall
from timing import interleave

from arena_core import RobotBatch
from arena_core.testing import component

NEIGHBOURS, HORIZON, WALL_HORIZON = 10, 2.0, 0.5  # as in the preset
REPEATS = 7
CALLS = {10: 2000, 100: 200, 1000: 20}  # a repeat lasts some hundredths of a second at least


def our_steps(people: int, worlds: int = 1) -> Callable[[], None]:
    """Return steps of arena-crowds' ORCA agents in so many equal worlds."""
    scenario = hall(people)
    model = component("pedestrians", "orca")
    crowd = model.reset(np.arange(worlds), [scenario] * worlds, worlds)
    robots, ticks = RobotBatch(np.zeros((worlds, 3)), np.zeros((worlds, 2)), 0.2), np.zeros(worlds, np.int64)

    def run() -> None:
        nonlocal crowd
        for _ in range(CALLS[people] // worlds):
            crowd = model.step(crowd, robots, ticks, STEP)

    return run


def pyrvo_steps(people: int) -> Callable[[], None]:
    """Return steps of pyrvo, walls included."""
    import pyrvo

    _, walls, starts, goals = crossing(people)
    simulator = pyrvo.RVOSimulator(STEP, SIGHT, NEIGHBOURS, HORIZON, WALL_HORIZON, RADIUS, SPEED)
    for left, bottom, right, top in walls.tolist():
        simulator.add_obstacle([(left, bottom), (right, top)])
    simulator.process_obstacles()
    ways = SPEED * (goals - starts) / np.linalg.norm(goals - starts, axis=1, keepdims=True)
    for start, way in zip(starts.tolist(), ways.tolist(), strict=True):
        simulator.set_agent_pref_velocity(simulator.add_agent(tuple(start)), tuple(way))

    def run() -> None:
        for _ in range(CALLS[people]):
            simulator.do_step()

    return run


def measure() -> list[dict[str, Any]]:
    """Return a row for each number of people."""
    rows = []
    for people in PEOPLE:
        times = interleave({"ours": our_steps(people), "pyrvo": pyrvo_steps(people)}, REPEATS)
        ms = {name: 1e3 * median(seconds) / CALLS[people] for name, seconds in times.items()}
        what = {
            "what": f"ORCA crowd step, {people} people",
            "ours_ms": ms["ours"],
            "peer": "pyrvo",
            "peer_ms": ms["pyrvo"],
        }
        rows.append({**what, "ratio": ms["ours"] / ms["pyrvo"], "goal": None, "unit": "x peer"})
    return rows


if __name__ == "__main__":
    for row in measure():
        print(f"{row['what']}: {row['ours_ms']:.4f} ms, pyrvo {row['peer_ms']:.4f} ms, ratio {row['ratio']:.2f}")
