"""Time a call of each learned planner's policy among ten people, with encoding and scaling, against its
bare networks in PyTorch.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from importlib import resources
from statistics import median
from typing import Any

import torch
from timing import interleave
from torch import nn

from arena_core import Twist, testing
from arena_policies.policy import load_policy

CALLS, REPEATS, GOAL = 500, 9, 0.25  # [-], [-], ms
ROBOTS = ("turtlebot3", "jackal", "robotino")
PLANNERS = ("rosnav", "gring", "navrep")
PEOPLE = testing.tracked(*((1.0 + 0.2 * k, 0.4 * k - 1.8, 0.0, 0.3) for k in range(10)))


def policy_calls(planner: str, robot: str) -> Callable[[], None]:
    """Return calls of a planner's policy for a robot."""
    body = testing.component("robot", robot)
    policy = load_policy(str(resources.files(f"arena_{planner}") / "policies" / f"{robot}.onnx"), planner, body)
    view, last = testing.observation(body=body, tracks=PEOPLE), Twist(0.1)

    def run() -> None:
        for _ in range(CALLS):
            policy.command(view, last)

    return run


class Peer(nn.Module):
    """A Jackal's networks as PyTorch runs them: convolutions over scans, a memory where there is
    one, and the policy's head.
    """

    def __init__(
        self, scans: int, convolutions: Sequence[tuple[int, int]], features: int, heads: Sequence[int], memory: int = 0
    ) -> None:
        super().__init__()
        layers: list[nn.Module] = []
        for channels, kernel in convolutions:
            layers += [nn.Conv1d(layers[-2].out_channels if layers else scans, channels, kernel, 2), nn.ReLU()]
        self.seen = nn.Sequential(*layers, nn.Flatten(), nn.LazyLinear(features))
        self.memory = nn.GRUCell(features + 4, memory) if memory else None  # what it saw, its speed and what it did
        self.foresight = nn.Linear(memory, 480) if memory else None  # where everything may be next
        self.head = nn.Sequential(
            *(layer for size in heads[:-1] for layer in (nn.LazyLinear(size), nn.ReLU())), nn.LazyLinear(heads[-1])
        )

    def forward(self, scan: torch.Tensor, state: torch.Tensor, past: torch.Tensor) -> torch.Tensor:
        """Return the action."""
        known = self.seen(scan)
        if self.memory is not None and self.foresight is not None:
            past = self.memory(torch.cat((known, state[:, :4]), 1), past)
            self.foresight(past)
            known = torch.cat((known, past), 1)
        action: torch.Tensor = self.head(torch.cat((known, state), 1))
        return action


PEERS: Mapping[str, Mapping[str, Any]] = {
    "rosnav": {"scans": 3, "convolutions": ((16, 5), (32, 5), (32, 3)), "features": 96, "heads": (64, 64, 2)},
    "gring": {"scans": 3, "convolutions": ((16, 5), (32, 3)), "features": 128, "heads": (64, 2)},
    "navrep": {
        "scans": 1,
        "convolutions": ((32, 5), (64, 5), (64, 3)),
        "features": 32,
        "memory": 64,
        "heads": (64, 64, 2),
    },
}


def network_calls(planner: str) -> Callable[[], None]:
    """Return calls of a planner's bare networks in PyTorch, without encoding and scaling."""
    torch.set_num_threads(1)
    peer = Peer(**PEERS[planner])
    scan, state, past = torch.zeros(1, PEERS[planner]["scans"], 90), torch.zeros(1, 7), torch.zeros(1, 64)

    def run() -> None:
        with torch.no_grad():
            for _ in range(CALLS):
                peer(scan, state, past)

    return run


def measure() -> list[dict[str, Any]]:
    """Return a row for each planner and robot; the goal is in ms."""
    runs = {f"{planner}, {robot}": policy_calls(planner, robot) for planner in PLANNERS for robot in ROBOTS}
    times = interleave({**runs, **{planner: network_calls(planner) for planner in PLANNERS}}, REPEATS)
    ms = {name: 1e3 * median(seconds) / CALLS for name, seconds in times.items()}
    return [
        {
            "what": f"policy call, {who} (goal {GOAL} ms)",
            "ours_ms": ms[who],
            "peer": "its networks alone in PyTorch",
            "peer_ms": ms[who.partition(",")[0]],
            "ratio": ms[who] / ms[who.partition(",")[0]],
            "goal": None,
        }
        for who in runs
    ]
