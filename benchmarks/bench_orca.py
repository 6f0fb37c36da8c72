"""Speed of ORCA: half-planes and linear programmes against pyrvo (the authors' C++ library), and one whole control
step.

pyrvo's time holds its search for neighbours and one call from Python a step.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
import pyrvo
from timing import interleave

from arena_core import Costmap, LaserScan, NoValidCommand, Observation, Path, Pose, Tracks, Twist
from arena_core.testing import component
from arena_kernels.compiled import compiled
from arena_kernels.distance import distance_field
from arena_kernels.half_planes import put_person
from arena_kernels.linear_program import Wish, nearest_allowed, safest_velocity

AGENTS, RADIUS, HORIZON, PERIOD, SPEED = 11, 0.3, 3.0, 0.1, 1.5
STEPS = 120  # of a walk: the crowd then has just crossed
WALKS = 10  # a timing
CALLS = 50  # a timing


@compiled
def next_velocities(positions: np.ndarray, velocities: np.ndarray, wishes: np.ndarray, out: np.ndarray) -> None:
    """Write every agent's new velocity among all the others, who do their half of the avoiding."""
    others = len(positions) - 1
    lines, scratch = np.empty((others, 4)), np.empty((others, 4))
    for i in range(len(positions)):
        own, row = (velocities[i, 0], velocities[i, 1]), 0
        for j in range(len(positions)):
            if j != i:
                place = (
                    positions[j, 0] - positions[i, 0],
                    positions[j, 1] - positions[i, 1],
                    velocities[j, 0],
                    velocities[j, 1],
                )
                put_person(lines, row, place, own, 2.0 * RADIUS, (HORIZON, PERIOD, 0.5))
                row += 1
        kept, x, y = nearest_allowed(lines, others, SPEED, Wish((wishes[i, 0], wishes[i, 1]), False))
        if kept < others:
            x, y = safest_velocity(lines, 0, others, kept, SPEED, (x, y), scratch)
        out[i, 0], out[i, 1] = x, y


@compiled
def walk_agents(positions: np.ndarray, wishes: np.ndarray, steps: int) -> np.ndarray:
    """Return where the agents are after ``steps``, from rest."""
    positions, velocities, out = positions.copy(), np.zeros_like(positions), np.zeros_like(positions)
    for _ in range(steps):
        next_velocities(positions, velocities, wishes, out)
        velocities[:] = out
        positions += velocities * PERIOD
    return positions


def make_crowd() -> tuple[np.ndarray, np.ndarray]:
    """Return eleven agents on a circle of 6 m, and the velocities at which each would cross it."""
    angles = 2.0 * math.pi * np.arange(AGENTS) / AGENTS + 0.01 * np.arange(AGENTS)
    places = 6.0 * np.column_stack((np.cos(angles), np.sin(angles)))
    return places, -places / 6.0


def our_walk(steps: int) -> np.ndarray:
    """Let the crowd walk in our kernel."""
    return walk_agents(*make_crowd(), steps)


def pyrvo_walk(steps: int) -> np.ndarray:
    """Let the crowd walk in pyrvo."""
    simulator = pyrvo.RVOSimulator(PERIOD, 100.0, AGENTS, HORIZON, HORIZON, RADIUS, SPEED)
    for place, wish in zip(*make_crowd(), strict=True):
        agent = simulator.add_agent(tuple(place.tolist()))
        simulator.set_agent_pref_velocity(agent, tuple(wish.tolist()))
    for _ in range(steps):
        simulator.do_step()
    return np.array([simulator.get_agent_position(agent).to_tuple() for agent in range(AGENTS)])


def make_observation() -> Observation:
    """Return what a Jackal sees among ten people between boxes."""
    generator, lethal = np.random.default_rng(1), np.zeros((120, 120), np.bool_)
    for row, column in generator.integers(0, 112, (12, 2)):
        lethal[row : row + 8, column : column + 8] = True
    lethal[46:74, 46:120] = False
    positions = np.column_stack((generator.uniform(1.0, 3.0, 10), generator.uniform(-3.0, 3.0, 10)))
    tracks = Tracks(
        np.arange(10, dtype=np.int32),
        positions,
        generator.uniform(-0.3, 0.3, (10, 2)),
        np.full(10, 0.3),
        np.zeros((10, 4, 4)),
    )
    for x, y in positions:
        row, column = int((y + 3.0) / 0.05), int((x + 3.0) / 0.05)
        lethal[max(row - 3, 0) : row + 3, max(column - 5, 0) : column - 3] = True
    costmap = Costmap(
        np.where(lethal, 254, 0).astype(np.uint8), distance_field(lethal, 0.05), 0.05, np.array((-3.0, -3.0))
    )
    path = Path(np.column_stack((np.linspace(0.0, 8.0, 81), np.zeros(81), np.zeros(81))))
    scan = LaserScan(0.0, 0.0, 0.1, 0.12, 3.5, np.full(4, np.inf, np.float32), Pose(0.0, 0.0))
    goal = Pose(8.0, 0.0)
    return Observation(
        0.0, Pose(0.0, 0.0), np.zeros((3, 3)), Twist(0.5), scan, goal, goal, path, None, lambda: costmap, lambda: tracks
    )


def measure() -> list[dict[str, Any]]:
    """Return the median user CPU time of eleven agents' velocities, and of a Jackal's whole control step."""
    np.testing.assert_allclose(our_walk(20), pyrvo_walk(20), atol=1e-4)
    planner, view = (
        component("planner", "orca", ["planner.driving.patience=null"], "jackal", robot=component("robot", "jackal")),
        make_observation(),
    )
    functions = {
        "ours": partial(_repeat_walks, our_walk),
        "pyrvo": partial(_repeat_walks, pyrvo_walk),
        "step": partial(_repeat_calls, planner, view),
    }
    times = interleave(functions, repeats=11)
    ms = {name: float(np.median(seconds)) * 1e3 for name, seconds in times.items()}
    velocities = {
        "ours_ms": ms["ours"] / STEPS / WALKS,
        "peer": "pyrvo",
        "peer_ms": ms["pyrvo"] / STEPS / WALKS,
        "ratio": ms["ours"] / ms["pyrvo"],
    }
    whole = {"ours_ms": ms["step"] / CALLS, "peer": None, "peer_ms": None, "ratio": None}
    return [
        {"what": "ORCA velocities of 11 agents, 10 neighbours each", **velocities, "goal": 0.3, "unit": "x peer"},
        {"what": "ORCA control step, 10 people, 120 x 120 cells, at most", **whole, "goal": 0.5, "unit": "ms"},
    ]


def _repeat_walks(walk_on: Callable[[int], np.ndarray]) -> None:
    for _ in range(WALKS):
        walk_on(STEPS)


def _repeat_calls(planner: Any, view: Observation) -> None:
    for _ in range(CALLS):
        try:
            planner.compute_velocity(view)
        except NoValidCommand:
            raise AssertionError("the scene is meant to have a way") from None


if __name__ == "__main__":
    for row in measure():
        peer = f"{row['peer']} {row['peer_ms']:.4f} ms, ratio {row['ratio']:.3f}" if row["peer"] else ""
        print(f"{row['what']:56} {row['ours_ms']:.4f} ms  {peer:36} goal {row['goal']:.3f} {row['unit']}")
