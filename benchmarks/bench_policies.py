"""Time a call of each learned planner's policy, encoding and scaling included, against a network of ROSNAV's size in PyTorch."""

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
PLANNERS = ("rosnav", "gring", "navrep")


def calls(planner: str, robot: str) -> Callable[[], None]:
    """Return calls of a planner's policy for a robot."""
    body = testing.component("robot", robot)
    policy = load_policy(str(resources.files(f"arena_{planner}") / "policies" / f"{robot}.onnx"), planner, body)
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
    """Return a row for each planner and robot; the goal is in ms."""
    runs = {f"{planner}, {robot}": calls(planner, robot) for planner in PLANNERS for robot in ROBOTS}
    times = interleave({**runs, "torch": network()}, REPEATS)
    ms = {name: 1e3 * median(seconds) / CALLS for name, seconds in times.items()}
    return [
        {
            "what": f"policy call, {who} (goal {GOAL} ms)",
            "ours_ms": ms[who],
            "peer": "network alone in PyTorch",
            "peer_ms": ms["torch"],
            "ratio": ms[who] / ms["torch"],
            "goal": None,
        }
        for who in runs
    ]
