"""NAVREP: a world model that sees and remembers, and a small policy on top of it."""

from arena_core import Robot
from arena_policies.planner import PolicyPlanner, shipped_policy


class Navrep(PolicyPlanner):
    """Drive by a controller that reads a world model's code and memory (Dugas et al. 2021).

    ``policy`` is an ONNX file with its card and the world model's networks beside it; None takes the one that
    is installed for the robot and ``variant``, the recipe that it was trained by: with memory, or on vision alone.
    """

    def __init__(self, robot: Robot, variant: str, policy: str | None) -> None:
        super().__init__(variant, robot, policy or shipped_policy("navrep", variant, robot))
