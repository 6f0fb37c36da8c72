"""Time a step of the vectorised environment, with observation, reward and resets, against bare
steps of navground and ir-sim.
"""

from __future__ import annotations

from collections.abc import Callable
from importlib.util import find_spec
from statistics import median
from typing import Any

import numpy as np
from bench_simulator import CALLS, PEERS
from timing import interleave

from arena_gym.vector_environment import NavigationVectorEnv

WORLDS, STEPS, REPEATS = 64, 150, 7
GOALS = {"navground ORCA + lidar": 1.1, "ir-sim social force": 1 / 100}
LIKE_THE_PEERS = [  # a round robot, 360 beams of 10 m, no noise, people stepped once a control step
    "robot.lidar.range_max=10.0",
    "robot.lidar.noise_std=0.0",
    *(f"robot.odometry.alpha{k}=0.0" for k in range(1, 5)),
    "pedestrians.longest_step=0.1",
    "task.pedestrians=10",
]
EPISODES = [f"environment.worlds={WORLDS}", "environment.problems_per_world=2", "task.time_limit=10.0"]


def our_steps(observation: str, reward: str) -> tuple[Callable[[], None], dict[str, int]]:
    """Return steps of a TurtleBot3 at random in 64 worlds, and a count of episodes that ended;
    they end in turn, not all at once.
    """
    envs = NavigationVectorEnv(
        WORLDS, robot="turtlebot3", observation=observation, reward=reward, overrides=[*LIKE_THE_PEERS, *EPISODES]
    )
    envs.batch.parts.pool.fill()
    envs.reset(seed=0)
    actions = np.random.default_rng(0).uniform(-1.0, 1.0, (STEPS, WORLDS, 2)).astype(np.float32)
    ended = {"episodes": 0}
    for step in range(96):
        envs.step(actions[step])
        if step % 3 == 0:
            envs.batch.restart(np.arange(2) + 2 * step // 3)

    def run() -> None:
        for action in actions:
            _, _, terminated, truncated, _ = envs.step(action)
            ended["episodes"] += int((terminated | truncated).sum())

    return run, ended


def measure() -> list[dict[str, Any]]:
    """Return a row for each peer that is installed, and one for each other observation."""
    (sectors, ended), (beams, _) = our_steps("rosnav_sectors", "progress"), our_steps("rosnav", "smooth_driving")
    runs = {"sectors": sectors, "beams": beams}
    for name, (module, make) in PEERS.items():
        if find_spec(module):
            runs[name] = make()
        else:
            print(f"{module} is not installed: environment not compared with {name}")
    times = interleave(runs, REPEATS)
    calls = CALLS | {"sectors": STEPS * WORLDS, "beams": STEPS * WORLDS}
    ms = {name: 1e3 * median(times[name]) / calls[name] for name in runs}
    length = STEPS * WORLDS * (REPEATS + 1) / max(ended["episodes"], 1)
    what = f"step of one of {WORLDS} environments, 360 beams, 10 people, a reset every {length:.0f} steps"
    rows = [
        _make_row(f"{what}, rosnav_sectors, progress", ms["sectors"], name, ms[name]) for name in PEERS if name in ms
    ]
    return [*rows, _make_row(f"{what}, rosnav, smooth_driving", ms["beams"])]


def _make_row(what: str, ours_ms: float, peer: str | None = None, peer_ms: float | None = None) -> dict[str, Any]:
    ratio = None if peer_ms is None else ours_ms / peer_ms
    goal = None if peer is None else GOALS[peer]
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
        print(f"{row['what']}: {1e3 * row['ours_ms']:.1f} us, {1e3 / row['ours_ms']:.0f} steps/s", end="")
        print("" if row["peer"] is None else f", {row['peer']} {1e3 * row['peer_ms']:.1f} us, ratio {row['ratio']:.4f}")
