"""The planner's parameters as its YAML groups them; every key has its unit and source there."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Literal

from arena_core.parameters import Bounds, Count, Horizon, NonNegative, Positive, Samples, Step


@dataclass(frozen=True, slots=True)
class LimitParameters:
    """What the robot may do; null is the robot's own limit."""

    vx_min: Annotated[float, Bounds(high=0.0)] | None
    vx_max: Positive | None
    vy_max: NonNegative | None
    wz_max: Positive | None
    trans_min: NonNegative
    trans_max: Positive | None
    theta_min: NonNegative
    ax_max: Positive | None
    ay_max: NonNegative | None
    alpha_max: Positive | None


@dataclass(frozen=True, slots=True)
class RollOutParameters:
    """Which velocities are tried, and how far each is followed."""

    sim_period: Positive | None
    sim_time: Horizon
    sim_granularity: Step
    angular_sim_granularity: Step
    vx_samples: Samples
    vy_samples: Count
    vth_samples: Samples
    stop_time_buffer: Annotated[float, Bounds(low=0.0, high=100.0)]


@dataclass(frozen=True, slots=True)
class FootprintParameters:
    """The gap that is kept around the robot's body."""

    padding: NonNegative
    passage_padding: NonNegative | None
    scaling_speed: NonNegative
    max_scaling_factor: NonNegative


@dataclass(frozen=True, slots=True)
class CriticParameters:
    """What the critics weigh; 0 takes one out."""

    path_distance_bias: NonNegative
    goal_distance_bias: NonNegative
    occdist_scale: NonNegative
    occdist_over: Literal["max", "mean"]
    forward_point_distance: NonNegative
    twirling_scale: NonNegative
    reverse_scale: NonNegative
    escape_scale: NonNegative


@dataclass(frozen=True, slots=True)
class ApproachParameters:
    """The critic of what comes nearer."""

    scale: NonNegative
    time: Positive
    margin: Positive
    lapse: Positive
    speed_min: NonNegative
    speed_max: NonNegative


@dataclass(frozen=True, slots=True)
class OscillationParameters:
    """When a change of direction may be taken back."""

    reset_dist: NonNegative
    reset_angle: NonNegative
    reset_time: Positive | None


@dataclass(frozen=True, slots=True)
class GoalParameters:
    """Stopping at the path's end and turning to the goal's heading."""

    xy_tolerance: Positive | None
    yaw_tolerance: Positive
    latch_xy_tolerance: bool


@dataclass(frozen=True, slots=True)
class TurnParameters:
    """Turning on the spot towards a path that lies behind."""

    begin: Positive | None
    end: NonNegative
    ahead: NonNegative


@dataclass(frozen=True, slots=True)
class WayOutParameters:
    """The turn and the straight line, or the curve of a car, that lead out of a local minimum."""

    patience: Positive | None
    reach: Positive
