"""Pure pursuit: the specimen of a third-party planner."""

import math

from arena_core import Observation, Planner, Register, Robot, Twist, hookimpl
from arena_core.parameters import Positive


class PurePursuit(Planner):
    """Drive an arc through the waypoint, blind to obstacles (Coulter, CMU-RI-TR-92-01, 1992)."""

    def __init__(self, robot: Robot, speed: Positive | None, turn_in_place_from: Positive, gain: Positive) -> None:
        self.robot = robot
        self.speed = min(robot.limits_with(vx_max=speed).vx_max, robot.limits.vx_max)
        self.turn_in_place_from = turn_in_place_from
        self.gain = gain

    def compute_velocity(self, observation: Observation) -> Twist:
        """Turn towards a waypoint far aside, else follow the arc that leads through it."""
        target = observation.pose.relative(observation.waypoint)
        distance, bearing = math.hypot(target.x, target.y), math.atan2(target.y, target.x)
        limit = self.robot.limits.wz_max
        if abs(bearing) > self.turn_in_place_from and self.robot.kinematics != "ackermann":
            return Twist(0.0, 0.0, max(-limit, min(limit, self.gain * bearing)))
        curvature = 2.0 * target.y / max(distance, 1e-6) ** 2
        speed = min(self.speed, limit / max(abs(curvature), 1e-6))
        return Twist(speed, 0.0, speed * curvature)


@hookimpl
def register_planners(register: Register) -> None:
    """Offer pure pursuit."""
    register("pure_pursuit", PurePursuit)


@hookimpl
def config_package() -> str:
    """Name the configuration package."""
    return "arena_pure_pursuit.conf"
