"""ROSNAV: a policy from scan, waypoint and last command to velocity."""

from typing import Literal

from arena_core import Robot
from arena_policies.planner import PolicyPlanner


class Rosnav(PolicyPlanner):
    """Drive by a policy trained with proximal policy optimisation (Kaestner et al. 2022, section III).

    ``policy`` is an ONNX file with its card beside it; None takes the one that comes with this package for robot and
    ``recipe``.
    """

    def __init__(
        self, robot: Robot, policy: str | None, recipe: Literal["rosnav", "rosnav_as_paper"] = "rosnav"
    ) -> None:
        super().__init__(recipe, robot, policy, f"pkg://arena_rosnav/policies{recipe.removeprefix('rosnav')}")
