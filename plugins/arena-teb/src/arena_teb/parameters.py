"""The planner's parameters as its YAML groups them; every key has its unit and source there."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from arena_core.parameters import Fraction, NonNegative, NonNegativeInt, Positive, PositiveInt


@dataclass(frozen=True, slots=True)
class Limits:
    """What the robot may do; null is the robot's own limit."""

    max_vel_x: Positive | None
    max_vel_x_backwards: NonNegative | None
    max_vel_y: NonNegative | None
    max_vel_theta: Positive | None
    acc_lim_x: Positive | None
    acc_lim_y: NonNegative | None
    acc_lim_theta: Positive | None
    min_turning_radius: NonNegative | None


@dataclass(frozen=True, slots=True)
class Trajectory:
    """How a band is sampled, where it leads and when it is begun again."""

    dt_ref: Positive
    dt_hysteresis: NonNegative
    min_samples: PositiveInt
    max_samples: PositiveInt
    max_spacing: Positive | None
    max_global_plan_lookahead_dist: Positive
    goal_heading: Literal["free", "path", "goal"]
    free_goal_vel: bool
    global_plan_viapoint_sep: Positive | None
    allow_init_with_backwards_motion: bool
    force_reinit_new_goal_dist: Positive
    force_reinit_new_goal_angular: Positive
    feasibility_check_no_poses: PositiveInt


@dataclass(frozen=True, slots=True)
class Obstacles:
    """Which gaps are wanted, and how moving obstacles count."""

    min_obstacle_dist: NonNegative
    least_gap: NonNegative
    inflation_dist: NonNegative
    dynamic_min_obstacle_dist: NonNegative
    dynamic_obstacle_inflation_dist: NonNegative
    footprint_model: Literal["body", "point"]
    obstacle_association_force_inclusion_factor: NonNegative
    obstacle_association_cutoff_factor: Positive
    costmap_converter: Literal["polygons"] | None
    include_dynamic_obstacles: bool
    static_below: NonNegative
    prediction_time: NonNegative | None
    track_margin: NonNegative
    max_tracks: NonNegativeInt
    proximity_ratio_max_vel: Fraction
    proximity_lower_bound: NonNegative
    proximity_upper_bound: Positive


@dataclass(frozen=True, slots=True)
class Polygons:
    """How cells become polygons, where ``obstacles.costmap_converter`` is polygons."""

    cluster_max_distance: Positive
    cluster_min_pts: PositiveInt
    cluster_max_pts: PositiveInt
    min_pt_separation: NonNegative


@dataclass(frozen=True, slots=True)
class Optimisation:
    """How much is iterated."""

    no_inner_iterations: PositiveInt
    no_outer_iterations: PositiveInt
    tolerance: Positive
    penalty_epsilon: NonNegative
    obstacle_cost_exponent: Positive
    weight_adapt_factor: Positive


@dataclass(frozen=True, slots=True)
class Weights:
    """What each term weighs; 0 takes it out."""

    max_vel_x: NonNegative
    max_vel_y: NonNegative
    max_vel_theta: NonNegative
    acc_lim_x: NonNegative
    acc_lim_y: NonNegative
    acc_lim_theta: NonNegative
    kinematics_nh: NonNegative
    kinematics_nh_holonomic: NonNegative
    kinematics_forward_drive: NonNegative
    kinematics_turning_radius: NonNegative
    optimaltime: Positive
    shortest_path: NonNegative
    obstacle: NonNegative
    inflation: NonNegative
    dynamic_obstacle: NonNegative
    dynamic_obstacle_inflation: NonNegative
    viapoint: NonNegative
    prefer_rotdir: NonNegative


@dataclass(frozen=True, slots=True)
class Homotopy:
    """How many topologies are kept, where new ones are looked for, and how one is chosen."""

    max_number_classes: PositiveInt
    max_clusters: PositiveInt
    roadmap_graph_no_samples: NonNegativeInt
    roadmap_graph_area_width: Positive
    obstacle_heading_threshold: Fraction
    selection_cost_hysteresis: Positive
    selection_prefer_initial_plan: Positive
    selection_obst_cost_scale: Positive
    switching_blocking_period: NonNegative
    max_ratio_detours_duration_best_duration: Positive


@dataclass(frozen=True, slots=True)
class Recovery:
    """What is done when nothing is feasible, and when the robot swings to and fro."""

    shrink_horizon_backup: bool
    shrink_horizon_min_duration: NonNegative
    escape_after: NonNegative | None
    escape_speed: Fraction
    oscillation_recovery: bool
    oscillation_v_eps: Fraction
    oscillation_omega_eps: Fraction
    oscillation_filter_duration: Positive
    oscillation_recovery_min_duration: NonNegative
