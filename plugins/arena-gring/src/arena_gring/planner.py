"""GRING: a policy from scans and waypoints ahead to velocity."""

from dataclasses import replace

from arena_core import NoValidCommand, Observation, Path, Robot, Twist
from arena_core.parameters import Positive
from arena_policies.planner import PolicyPlanner, shipped_policy


class Gring(PolicyPlanner):
    """Drive by a policy trained with proximal policy optimisation (Guldenring, Goerner, Hendrich, Jacobsen and Zhang
    2020).

    ``policy`` is an ONNX file with its card beside it; None takes the one that is installed for robot and
    ``recipe``. With ``one_waypoint`` the policy is shown the one waypoint eight times in place of those ahead on the
    path, and turns are ``turn_factor`` as fast as it wants: what its deployment in the release of Arena-Bench did.
    """

    def __init__(
        self,
        robot: Robot,
        policy: str | None,
        recipe: str,
        turn_factor: Positive,
        *,
        one_waypoint: bool,
    ) -> None:
        super().__init__(recipe, robot, policy or shipped_policy("gring", recipe, robot))
        self._one_waypoint, self._turn_factor = one_waypoint, turn_factor
        self._wz_max = robot.limits.wz_max

    def compute_velocity(self, observation: Observation) -> Twist:
        """Return the policy's velocity; raise NoValidCommand where the observation is no number, or the path empty."""
        if not len(observation.path.poses):
            raise NoValidCommand("gring: the path is empty")
        if self._one_waypoint:
            observation = replace(observation, path=Path(observation.waypoint.array()[None]))
        wanted = super().compute_velocity(observation)
        turn = min(max(self._turn_factor * wanted.wz, -self._wz_max), self._wz_max)
        return replace(wanted, wz=turn)
