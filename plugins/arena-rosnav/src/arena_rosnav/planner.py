"""ROSNAV: a policy from scan, waypoint and last command to velocity."""

from arena_core import Robot
from arena_policies.planner import PolicyPlanner, shipped_policy


class Rosnav(PolicyPlanner):
    """Drive by a policy trained with proximal policy optimisation (Kaestner et al. 2022, section III).

    ``policy`` is an ONNX file with its card beside it; None takes the one that is installed for robot and ``recipe``.
    """

    def __init__(self, robot: Robot, policy: str | None, recipe: str = "rosnav") -> None:
        super().__init__(recipe, robot, policy or shipped_policy("rosnav", recipe, robot))
