"""NAVREP: a world model that sees and remembers, and a small policy on top of it."""

from typing import Literal

from arena_core import Robot
from arena_policies.planner import PolicyPlanner


class Navrep(PolicyPlanner):
    """Drive by a controller that reads a world model's code and memory (Dugas et al. 2021).

    ``policy`` is an ONNX file with its card and the world model's networks beside it; None takes the one of this
    package that was trained for the robot as ``variant`` says: with memory, on vision alone, or as released, end to end
    on the scan.
    """

    def __init__(
        self, robot: Robot, variant: Literal["navrep", "navrep_v_only", "navrep_as_released"], policy: str | None
    ) -> None:
        super().__init__(variant, robot, policy, f"pkg://arena_navrep/policies{variant.removeprefix('navrep')}")
