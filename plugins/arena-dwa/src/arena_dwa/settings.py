"""What the compiled search is told: tuples of plain numbers and arrays, in SI units."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arena_core import ConfigurationError, Robot
from arena_dwa.parameters import (
    ApproachParameters,
    CriticParameters,
    FootprintParameters,
    LimitParameters,
    RollOutParameters,
)
from arena_kernels.costmap_window import CostmapWindow, Outline, footprint_outline

FloatArray = NDArray[np.float64]
FieldArray = NDArray[np.float32]


class Limits(NamedTuple):
    """Speeds (m/s, rad/s), accelerations (m/s^2, rad/s^2) and the least turning radius (m, 0 unless Ackermann).

    A sample slower than ``trans_min`` *and* turning slower than ``theta_min`` is not driven.
    """

    vx_min: float
    vx_max: float
    vy_max: float
    wz_max: float
    trans_min: float
    trans_max: float
    theta_min: float
    ax_max: float
    ay_max: float
    alpha_max: float
    turn_radius: float


class RollOut(NamedTuple):
    """How many velocities are tried and how far each is followed: s, m and rad between two poses, samples an axis."""

    sim_time: float
    sim_granularity: float
    angular_sim_granularity: float
    stop_time_buffer: float
    vx_samples: int
    vy_samples: int
    vth_samples: int


class Body(NamedTuple):
    """The robot's outline, and the padding (m) that it keeps.

    The outline grows with speed above ``scaling_speed`` (m/s), by the fraction ``max_scaling_factor`` at full speed.
    """

    outline: Outline
    padding: float
    scaling_speed: float
    max_scaling_factor: float


class BodyOnWindow(NamedTuple):
    """The costmap window, and the body that is moved over it."""

    window: CostmapWindow
    body: Body


class Scales(NamedTuple):
    """The weights of the critics, in the units of ROS's dwa_local_planner where it has them."""

    path_distance_bias: float
    goal_distance_bias: float
    occdist_scale: float
    occdist_mean: bool
    forward_point_distance: float
    twirling_scale: float
    reverse_scale: float
    escape_scale: float


class Approach(NamedTuple):
    """The approach critic: its weight, how far ahead it looks (s), and the gap it wants to keep (m)."""

    scale: float
    time: float
    margin: float


class Settings(NamedTuple):
    """All that does not change from step to step."""

    limits: Limits
    roll_out: RollOut
    body: Body
    scales: Scales
    approach: Approach


class MapGrids(NamedTuple):
    """Steps from the path, the local goal and the goal of the robot's front: the window's cells
    with a border of one, flat.
    """

    path: NDArray[np.int32]
    goal: NDArray[np.int32]
    goal_front: NDArray[np.int32]


def make_settings(
    robot: Robot,
    limits: LimitParameters,
    roll_out: RollOutParameters,
    footprint: FootprintParameters,
    critics: CriticParameters,
    approach: ApproachParameters,
) -> Settings:
    """Return the settings for a robot; raise ConfigurationError where parameters contradict each other."""
    return Settings(
        _make_limits(robot, limits),
        RollOut(
            sim_time=roll_out.sim_time,
            sim_granularity=roll_out.sim_granularity,
            angular_sim_granularity=roll_out.angular_sim_granularity,
            stop_time_buffer=roll_out.stop_time_buffer,
            vx_samples=roll_out.vx_samples,
            vy_samples=roll_out.vy_samples,
            vth_samples=roll_out.vth_samples,
        ),
        _make_body(robot, footprint),
        Scales(
            path_distance_bias=critics.path_distance_bias,
            goal_distance_bias=critics.goal_distance_bias,
            occdist_scale=critics.occdist_scale,
            occdist_mean=critics.occdist_over == "mean",
            forward_point_distance=critics.forward_point_distance,
            twirling_scale=critics.twirling_scale,
            reverse_scale=critics.reverse_scale,
            escape_scale=critics.escape_scale,
        ),
        Approach(approach.scale, approach.time, approach.margin),
    )


def _make_limits(robot: Robot, limits: LimitParameters) -> Limits:
    own = robot.limits_with(
        vx_min=limits.vx_min,
        vx_max=limits.vx_max,
        vy_max=limits.vy_max,
        wz_max=limits.wz_max,
        ax_max=limits.ax_max,
        ay_max=limits.ay_max,
        alpha_max=limits.alpha_max,
    )
    in_force = Limits(
        vx_min=own.vx_min,
        vx_max=own.vx_max,
        vy_max=own.vy_max,
        wz_max=own.wz_max,
        trans_min=limits.trans_min,
        trans_max=max(robot.limits.vx_max, robot.limits.vy_max) if limits.trans_max is None else limits.trans_max,
        theta_min=limits.theta_min,
        ax_max=own.ax_max,
        ay_max=own.ay_max,
        alpha_max=own.alpha_max,
        turn_radius=robot.turn_radius,
    )
    if in_force.trans_min > in_force.trans_max:
        allowed = f"at most trans_max {in_force.trans_max} (m/s)"
        raise ConfigurationError(f"dwa: limits.trans_min is {in_force.trans_min}; allowed: {allowed}")
    return in_force


def _make_body(robot: Robot, kept: FootprintParameters) -> Body:
    return Body(footprint_outline(robot.footprint), kept.padding, kept.scaling_speed, kept.max_scaling_factor)
