"""What the controller is told, as its YAML groups it; SI units. A limit that is None is the robot's."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from typing import Annotated, Literal

from arena_core import ConfigurationError, Robot
from arena_core.parameters import Bounds, Fraction, NonNegative, NonNegativeInt, Positive, PositiveInt

Form = Literal["minimum_time", "quadratic"]
Association = Literal["half_planes", "cells"]
ModelName = Literal["unicycle", "bicycle", "omnidirectional"]
MODELS_OF: dict[str, tuple[ModelName, ...]] = {  # the robot's own model first
    "differential": ("unicycle",),
    "ackermann": ("bicycle",),
    "omnidirectional": ("omnidirectional", "unicycle"),
}


@dataclass(frozen=True, slots=True)
class Limits:
    """Speeds and accelerations that plans keep to."""

    vx_min: Annotated[float, Bounds(high=0.0)] | None
    vx_max: Positive | None
    vy_max: NonNegative | None
    wz_max: Positive | None
    ax_max: Positive | None
    ay_max: NonNegative | None
    alpha_max: Positive | None
    steering_rate_max: Positive


@dataclass(frozen=True, slots=True)
class Grid:
    """How a plan is divided in time: ``stages`` intervals of ``step`` s to begin with;
    minimum-time plans change both.
    """

    stages: PositiveInt
    stages_min: PositiveInt
    stages_max: PositiveInt
    resize_by: PositiveInt
    step: Positive
    step_min: Positive
    step_max: Positive
    hysteresis: Fraction
    outer_iterations: PositiveInt

    def __post_init__(self) -> None:
        if not self.stages_min <= self.stages <= self.stages_max:
            allowed = f"stages_min {self.stages_min} .. stages_max {self.stages_max}"
            raise ConfigurationError(f"mpc: grid.stages is {self.stages}; allowed: {allowed}")
        if not self.step_min <= self.step <= self.step_max:
            raise ConfigurationError(
                f"mpc: grid.step is {self.step}; allowed: step_min {self.step_min} .. step_max {self.step_max} (s)"
            )


@dataclass(frozen=True, slots=True)
class Weights:
    """The terms of the objective; those of the other form are ignored."""

    time: NonNegative
    state_position: NonNegative
    state_heading: NonNegative
    control_linear: NonNegative
    control_angular: NonNegative
    goal_position: NonNegative
    goal_heading: NonNegative
    path: NonNegative
    path_heading: NonNegative
    via_points: NonNegative
    acceleration_linear: NonNegative
    acceleration_angular: NonNegative
    slack: NonNegative
    slack_squared: NonNegative


@dataclass(frozen=True, slots=True)
class Obstacles:
    """What plans keep away from, and how far."""

    hard: bool
    association: Association
    min_distance: NonNegative
    least_gap: NonNegative
    cutoff: Positive
    forced_inclusion: NonNegative
    speed_distance: NonNegative
    planes: PositiveInt
    moving: NonNegativeInt
    moving_distance: NonNegative
    moving_growth: NonNegative
    moving_margin: NonNegative


@dataclass(frozen=True, slots=True)
class SolverSettings:
    """How the nonlinear program is solved: in one solution, and in all those of a control step together."""

    name: Literal["shooting", "fatrop", "ipopt"]
    max_iterations: PositiveInt
    solution_iterations: PositiveInt
    tolerance: Positive

    def __post_init__(self) -> None:
        if self.solution_iterations > self.max_iterations:
            allowed = f"at most max_iterations {self.max_iterations}"
            raise ConfigurationError(
                f"mpc: solver.solution_iterations is {self.solution_iterations}; allowed: {allowed}"
            )


def model_of(robot: Robot, model: ModelName | None) -> ModelName:
    """Return the model to plan with; raise ConfigurationError where the robot cannot be driven by it."""
    possible = MODELS_OF.get(robot.kinematics)
    if possible is None:
        raise ConfigurationError(f"mpc: robot.kinematics is {robot.kinematics}; allowed: {', '.join(MODELS_OF)}")
    if model is not None and model not in possible:
        raise ConfigurationError(
            f"mpc: model is {model}; allowed for {robot.kinematics} kinematics: {', '.join(possible)}, null"
        )
    return model or possible[0]


@dataclass(frozen=True, slots=True)
class Drive:
    """The limits in force, and a car's wheelbase (m) and steering (rad, rad/s)."""

    vx_min: float
    vx_max: float
    vy_max: float
    wz_max: float
    ax_max: float
    ay_max: float
    alpha_max: float
    wheelbase: float
    steering_max: float
    steering_rate_max: float


def drive_of(robot: Robot, limits: Limits) -> Drive:
    """Return the limits in force; raise ConfigurationError for limits with which no motion is possible."""
    values = asdict(limits)
    steering_rate_max = values.pop("steering_rate_max")
    own = asdict(robot.limits_with(**values))
    for name in ("vx_max", "wz_max", "ax_max", "alpha_max"):
        if not (math.isfinite(own[name]) and own[name] > 0.0):
            raise ConfigurationError(f"mpc: limits.{name} is {own[name]}; allowed: > 0")
    if own["vx_min"] > 0.0:
        raise ConfigurationError(f"mpc: limits.vx_min is {own['vx_min']}; allowed: <= 0 (m/s)")
    return Drive(**own, wheelbase=robot.wheelbase, steering_max=robot.steering_max, steering_rate_max=steering_rate_max)
