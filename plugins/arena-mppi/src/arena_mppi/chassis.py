"""The motion models, with the limits that a robot and its tuning allow."""

from __future__ import annotations

import math
from dataclasses import asdict

import numpy as np

from arena_core import ConfigurationError, Robot
from arena_mppi.motion_model import MotionModel
from arena_mppi.parameters import Chassis
from arena_mppi.settings import SpeedLimits

MODELS: dict[str, tuple[MotionModel, ...]] = {
    "differential": ("DiffDrive", "Ackermann"),
    "omnidirectional": ("Omni", "DiffDrive", "Ackermann"),
    "ackermann": ("Ackermann",),
}


def motion_model_of(robot: Robot, chosen: MotionModel | None) -> MotionModel:
    """Return the chosen motion model, or the robot's own; raise ConfigurationError
    for one that the robot cannot follow.
    """
    possible = MODELS[robot.kinematics]
    if chosen is not None and chosen not in possible:
        raise ConfigurationError(
            f"mppi: motion_model is {chosen}; allowed for {robot.name} ({robot.kinematics}): {', '.join(possible)}"
        )
    return chosen or possible[0]


def chassis_of(
    robot: Robot, model: MotionModel, limits: SpeedLimits, turning_radius: float | None, dt: float
) -> Chassis:
    """Return the limits of a motion model with a step of ``dt`` s; raise ConfigurationError when
    an arc needs more than it has.
    """
    own = robot.limits_with(**asdict(limits))
    sideways = model == "Omni"
    return Chassis(
        np.float32(own.vx_min),
        np.float32(own.vx_max),
        np.float32(own.vy_max if sideways else 0.0),
        np.float32(own.wz_max),
        np.float32(own.ax_max * dt),
        np.float32(own.ay_max * dt if sideways else 0.0),
        np.float32(own.alpha_max * dt),
        np.float32(0.0 if model == "Ackermann" else math.inf),
        np.float32(_max_curvature(robot, turning_radius) if model == "Ackermann" else 0.0),
    )


def _max_curvature(robot: Robot, turning_radius: float | None) -> float:
    """Return the greatest curvature, 1/m, of the steering or of ``turning_radius``, whichever is less."""
    steering = math.tan(robot.steering_max) / robot.wheelbase if robot.kinematics == "ackermann" else math.inf
    if not turning_radius and math.isinf(steering):
        raise ConfigurationError(
            f"mppi: turning_radius is {turning_radius}; allowed: > 0 (m) for {robot.name} with motion_model Ackermann"
        )
    return min(steering, 1.0 / turning_radius) if turning_radius else steering
