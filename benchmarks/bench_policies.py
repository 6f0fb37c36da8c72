"""Time a call of each policy that comes with ROSNAV, encoding and scaling included, against the same network in PyTorch."""

from __future__ import annotations

from collections.abc import Callable
from importlib import resources
from statistics import median
from typing import Any

import numpy as np
import torch
from timing import interleave
from torch import nn

from arena_core import Twist, testing
from arena_policies.policy import load_policy

CALLS, REPEATS, GOAL = 500, 9, 0.25  # [-], [-], ms
ROBOTS = ("turtlebot3", "jackal", "robotino")


def calls(robot: str) -> Callable[[], None]:
    """Return calls of a robot's policy."""
    body = testing.component("robot", robot)
    policy = load_policy(str(resources.files("arena_rosnav") / "policies" / f"{robot}.onnx"), "rosnav", body)
    view, last = testing.observation(body=body), Twist(0.1)

    def run() -> None:
        for _ in range(CALLS):
            policy.command(view, last)

    return run


def network() -> Callable[[], None]:
    """Return calls of a network of ROSNAV's size in PyTorch, without encoding and scaling."""
    torch.set_num_threads(1)
    beams = nn.Sequential(
        nn.Conv1d(1, 16, 5, 2), nn.ReLU(), nn.Conv1d(16, 32, 5, 2), nn.ReLU(), nn.Conv1d(32, 32, 3, 2), nn.ReLU(), nn.Flatten()
    )
    heads = nn.Sequential(nn.Linear(288, 96), nn.ReLU(), nn.Linear(96, 64), nn.ReLU(), nn.Linear(64, 64), nn.ReLU(), nn.Linear(64, 2))
    seen = torch.from_numpy(np.zeros((1, 1, 90), np.float32))

    def run() -> None:
        with torch.no_grad():
            for _ in range(CALLS):
                heads(beams(seen))

    return run


def measure() -> list[dict[str, Any]]:
    """Return a row for each robot; the goal is in ms."""
    times = interleave({**{robot: calls(robot) for robot in ROBOTS}, "torch": network()}, REPEATS)
    ms = {name: 1e3 * median(seconds) / CALLS for name, seconds in times.items()}
    return [
        {
            "what": f"policy call, {robot} (goal {GOAL} ms)",
            "ours_ms": ms[robot],
            "peer": "network alone in PyTorch",
            "peer_ms": ms["torch"],
            "ratio": ms[robot] / ms["torch"],
            "goal": None,
        }
        for robot in ROBOTS
    ]
