"""The optimiser's model, from the parameters and the robot."""

from __future__ import annotations

import math

import numpy as np

from arena_core import ConfigurationError, Robot
from arena_teb.association import Reach
from arena_teb.optimisation import Effort, Model
from arena_teb.parameters import Limits, Obstacles, Optimisation, Trajectory, Weights
from arena_teb.problem import FloatArray, Penalties, Shape
from arena_teb.resize import Sampling
from arena_teb.surroundings import Vicinity


def speed_limits(robot: Robot, limits: Limits) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return least and greatest speeds and accelerations, (3,) each: forward, left, turn."""
    backwards = limits.max_vel_x_backwards
    own = robot.limits_with(
        vx_min=None if backwards is None else -backwards,
        vx_max=limits.max_vel_x,
        vy_max=limits.max_vel_y,
        wz_max=limits.max_vel_theta,
        ax_max=limits.acc_lim_x,
        ay_max=limits.acc_lim_y,
        alpha_max=limits.acc_lim_theta,
    )
    least, most = (own.vx_min, -own.vy_max, -own.wz_max), (own.vx_max, own.vy_max, own.wz_max)
    return np.array(least), np.array(most), np.array((own.ax_max, own.ay_max, own.alpha_max))


def turning_radius(robot: Robot, limits: Limits) -> float:
    """Return the least turning radius, m: the robot's or a greater one."""
    own, wanted = robot.turn_radius, limits.min_turning_radius
    if wanted is not None and wanted < own:
        raise ConfigurationError(f"teb: limits.min_turning_radius is {wanted}; allowed: null or >= {own:.3f} (m)")
    return own if wanted is None else wanted


def make_model(
    robot: Robot,
    limits: Limits,
    trajectory: Trajectory,
    obstacles: Obstacles,
    optimisation: Optimisation,
    weights: Weights,
) -> Model:
    """Return the model; raise ConfigurationError where parameters contradict each other."""
    if trajectory.dt_hysteresis >= trajectory.dt_ref:
        raise ConfigurationError(
            f"teb: trajectory.dt_hysteresis is {trajectory.dt_hysteresis}; allowed: "
            f"below dt_ref {trajectory.dt_ref} (s)"
        )
    if not 3 <= trajectory.min_samples <= trajectory.max_samples:
        raise ConfigurationError(
            f"teb: trajectory.min_samples is {trajectory.min_samples}; allowed: "
            f"3 to max_samples {trajectory.max_samples}"
        )
    if obstacles.proximity_lower_bound >= obstacles.proximity_upper_bound:
        raise ConfigurationError(
            f"teb: obstacles.proximity_lower_bound is {obstacles.proximity_lower_bound}; "
            f"allowed: below proximity_upper_bound {obstacles.proximity_upper_bound} (m)"
        )
    spacing = math.inf if trajectory.max_spacing is None else trajectory.max_spacing
    sampling = Sampling(
        trajectory.dt_ref, trajectory.dt_hysteresis, trajectory.min_samples, trajectory.max_samples, spacing
    )
    shape = _footprint_shape(robot, obstacles)
    inscribed = robot.footprint.inscribed_radius if obstacles.footprint_model == "body" else 0.0
    slow = obstacles.proximity_lower_bound + inscribed, obstacles.proximity_upper_bound + inscribed
    vicinity = Vicinity(
        _association_reach(shape, obstacles, optimisation.penalty_epsilon), obstacles.proximity_ratio_max_vel, *slow
    )
    effort = Effort(
        optimisation.no_inner_iterations,
        optimisation.no_outer_iterations,
        optimisation.tolerance,
        optimisation.weight_adapt_factor,
    )
    return Model(_make_penalties(robot, limits, obstacles, optimisation, weights), shape, sampling, vicinity, effort)


def _footprint_shape(robot: Robot, obstacles: Obstacles) -> Shape:
    """Return what gaps are measured from: the robot's body, or its middle."""
    footprint = robot.footprint
    if obstacles.footprint_model == "point":
        return Shape(np.zeros((1, 2)), 0.0, 0.0, 0.0)
    if footprint.is_circle:
        return Shape(np.zeros((1, 2)), footprint.radius, footprint.radius, footprint.radius)
    return Shape(np.ascontiguousarray(footprint.vertices_xy), 0.0, footprint.radius, footprint.inscribed_radius)


def _association_reach(shape: Shape, obstacles: Obstacles, epsilon: float) -> Reach:
    """Return how far from the origin static points count (teb_local_planner: obstacle_association_...)."""
    least = obstacles.min_obstacle_dist
    penalised = max(least + epsilon, obstacles.inflation_dist)
    most = shape.radius + min(penalised, least * obstacles.obstacle_association_cutoff_factor)
    factor = obstacles.obstacle_association_force_inclusion_factor
    return Reach(most, min(most, shape.radius + least * factor) if factor > 0.0 else 0.0)


def _make_penalties(
    robot: Robot, limits: Limits, obstacles: Obstacles, optimisation: Optimisation, weights: Weights
) -> Penalties:
    epsilon = optimisation.penalty_epsilon
    least, most, acceleration = speed_limits(robot, limits)
    radius = turning_radius(robot, limits)
    holonomic = robot.holonomic
    return Penalties(
        speed_min=-_shrink_bounds(-least, epsilon),
        speed_max=_shrink_bounds(most, epsilon),
        acceleration=_shrink_bounds(acceleration, epsilon),
        root_speed=np.sqrt((weights.max_vel_x, weights.max_vel_y if holonomic else 0.0, weights.max_vel_theta)),
        root_acceleration=np.sqrt((weights.acc_lim_x, weights.acc_lim_y if holonomic else 0.0, weights.acc_lim_theta)),
        root_nonholonomic=math.sqrt(weights.kinematics_nh_holonomic if holonomic else weights.kinematics_nh),
        root_forward=math.sqrt(weights.kinematics_forward_drive),
        root_turn_radius=math.sqrt(weights.kinematics_turning_radius) if radius > 0.0 else 0.0,
        root_time=math.sqrt(weights.optimaltime),
        root_path=math.sqrt(weights.shortest_path),
        root_obstacle=math.sqrt(weights.obstacle),
        root_inflation=math.sqrt(weights.inflation),
        root_dynamic=math.sqrt(weights.dynamic_obstacle),
        root_dynamic_inflation=math.sqrt(weights.dynamic_obstacle_inflation),
        root_via=math.sqrt(weights.viapoint),
        root_rotation=math.sqrt(weights.prefer_rotdir),
        turn_radius=radius,
        near=obstacles.min_obstacle_dist + epsilon,
        inflated=obstacles.inflation_dist,
        dynamic_near=obstacles.dynamic_min_obstacle_dist + epsilon,
        dynamic_inflated=obstacles.dynamic_obstacle_inflation_dist,
        exponent=optimisation.obstacle_cost_exponent if obstacles.min_obstacle_dist > 0.0 else 1.0,
        unit=obstacles.min_obstacle_dist,
    )


def selection_penalties(penalties: Penalties, scale: float) -> Penalties:
    """Return the penalties by which topologies are compared: obstacles weigh ``scale`` times as much."""
    root = math.sqrt(scale)
    return penalties._replace(
        root_obstacle=root * penalties.root_obstacle,
        root_inflation=root * penalties.root_inflation,
        root_dynamic=root * penalties.root_dynamic,
        root_dynamic_inflation=root * penalties.root_dynamic_inflation,
    )


def _shrink_bounds(bounds: FloatArray, epsilon: float) -> FloatArray:
    """Return bounds a little inside, at most halved."""
    return np.asarray(bounds - np.minimum(epsilon, 0.5 * bounds))
