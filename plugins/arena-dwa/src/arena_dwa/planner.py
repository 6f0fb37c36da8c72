"""The dynamic window approach of Fox, Burgard and Thrun (1997), in the manner of ROS's dwa_local_planner."""

from __future__ import annotations

import math
from typing import Annotated, ClassVar, Literal

import numpy as np

from arena_core import (
    Bounds,
    ConfigurationError,
    EpisodeStart,
    NonNegative,
    NonNegativeInt,
    NoValidCommand,
    Observation,
    Planner,
    Positive,
    PositiveInt,
    Robot,
    Twist,
)
from arena_dwa.approach import ClosingSpeeds
from arena_dwa.arrival import Arrival, Tolerances
from arena_dwa.map_grid import map_grids
from arena_dwa.obstacles import REJECTED, obstacle_cost
from arena_dwa.oscillation import OscillationFlags
from arena_dwa.parameters import Approach, Body, FieldArray, FloatArray, Limits, RollOut, Scales, Settings
from arena_dwa.search import cheapest_sample
from arena_dwa.standing import Standing
from arena_dwa.trajectory import stand_at
from arena_dwa.turning import TurnInPlace
from arena_dwa.way_out import WayOut
from arena_dwa.window import dynamic_window
from arena_kernels.window import Window, clearance, outline_of

OUTLINE_SPACING = 0.05  # m, the side of a usual costmap cell: no cell slips between two points


class DwaPlanner(Planner):
    """Samples velocities of the dynamic window, follows each for ``sim_time`` and drives the cheapest that does not collide."""

    compiles: ClassVar[bool] = True

    def __init__(
        self,
        robot: Robot,
        vx_min: Annotated[float, Bounds(high=0.0)] | None,
        vx_max: Positive | None,
        vy_max: NonNegative | None,
        wz_max: Positive | None,
        trans_min: NonNegative,
        trans_max: Positive | None,
        theta_min: NonNegative,
        ax_max: Positive | None,
        ay_max: NonNegative | None,
        alpha_max: Positive | None,
        sim_period: Positive | None,
        sim_time: Positive,
        sim_granularity: Positive,
        angular_sim_granularity: Positive,
        vx_samples: PositiveInt,
        vy_samples: NonNegativeInt,
        vth_samples: PositiveInt,
        path_distance_bias: NonNegative,
        goal_distance_bias: NonNegative,
        occdist_scale: NonNegative,
        occdist_over: Literal["max", "mean"],
        forward_point_distance: NonNegative,
        twirling_scale: NonNegative,
        reverse_scale: NonNegative,
        escape_scale: NonNegative,
        approach_scale: NonNegative,
        approach_time: Positive,
        approach_margin: Positive,
        approach_lapse: Positive,
        approach_speed_min: NonNegative,
        approach_speed_max: NonNegative,
        stop_time_buffer: NonNegative,
        footprint_padding: NonNegative,
        scaling_speed: NonNegative,
        max_scaling_factor: NonNegative,
        oscillation_reset_dist: NonNegative,
        oscillation_reset_angle: NonNegative,
        oscillation_reset_time: Positive | None,
        xy_goal_tolerance: Positive | None,
        yaw_goal_tolerance: Positive,
        latch_xy_goal_tolerance: bool,
        turn_in_place_from: Positive | None,
        turn_in_place_until: NonNegative,
        turn_in_place_ahead: NonNegative,
        patience: Positive | None,
        way_out_reach: Positive,
    ) -> None:
        own = robot.limits
        limits = Limits(
            vx_min=_or(vx_min, own.vx_min),
            vx_max=_or(vx_max, own.vx_max),
            vy_max=_or(vy_max, own.vy_max) if robot.holonomic else 0.0,
            wz_max=_or(wz_max, own.wz_max),
            trans_min=trans_min,
            trans_max=_or(trans_max, max(own.vx_max, own.vy_max)),
            theta_min=theta_min,
            ax_max=_or(ax_max, own.ax_max),
            ay_max=_or(ay_max, own.ay_max),
            alpha_max=_or(alpha_max, own.alpha_max),
            turn_radius=_turn_radius(robot),
        )
        if trans_min > limits.trans_max:
            raise ConfigurationError(f"dwa: trans_min is {trans_min}; allowed: at most trans_max {limits.trans_max} (m/s)")
        roll_out = RollOut(sim_time, sim_granularity, angular_sim_granularity, stop_time_buffer, vx_samples, vy_samples, vth_samples)
        body = _body(robot, footprint_padding, scaling_speed, max_scaling_factor)
        scales = Scales(
            path_distance_bias,
            goal_distance_bias,
            occdist_scale,
            occdist_over == "mean",
            forward_point_distance,
            twirling_scale,
            reverse_scale,
            escape_scale,
        )
        self._settings = Settings(limits, roll_out, body, scales, Approach(approach_scale, approach_time, approach_margin))
        self._closing = ClosingSpeeds(approach_lapse, approach_speed_min, approach_speed_max)
        self._oscillation = OscillationFlags(oscillation_reset_dist, oscillation_reset_angle, oscillation_reset_time, trans_min)
        turns = turn_in_place_from if robot.kinematics == "differential" else None
        self._turn = TurnInPlace(turns, turn_in_place_until, turn_in_place_ahead, limits.alpha_max)
        self._standing = Standing(None if robot.kinematics == "ackermann" else patience)  # which cannot turn on the spot
        self._way_out = WayOut(way_out_reach, limits, robot.holonomic)
        self._rehearsed = False
        self._arrival = Arrival(Tolerances(xy_goal_tolerance, yaw_goal_tolerance, latch_xy_goal_tolerance), limits)
        self._period = robot.control_period
        self._sim_period = sim_period

    def reset(self, episode: EpisodeStart) -> None:
        """Forget the directions driven before."""
        self._period = episode.control_period
        self._oscillation.clear()
        self._closing.clear()
        self._turn.clear()
        self._arrival.clear()
        self._standing.clear()
        self._way_out.clear()

    def compute_velocity(self, observation: Observation) -> Twist:
        """Return the cheapest admissible velocity of the window; raise NoValidCommand when every one is rejected."""
        window, state, path = _window(observation), _state(observation), observation.path.poses
        if len(path) == 0:
            raise NoValidCommand("dwa: the path is empty")
        lapse = _or(self._sim_period, self._period)
        at_goal = self._arrival.velocity(observation.pose, state[3:], path, observation.goal.theta, lapse)
        if at_goal is not None:
            if not self._is_free(window, state, at_goal):
                raise NoValidCommand("dwa: stopping or turning at the goal would collide")
            return Twist(*at_goal.tolist())
        settings = self._settings
        grids = map_grids(window, settings.body, path, state[0], state[1], settings.scales.forward_point_distance)
        speeds = self._closing.update(observation.stamp, observation.local_map)
        reachable = dynamic_window(state[3:], settings.limits, lapse)
        too_long = self._standing.too_long(observation.pose, observation.stamp)
        approached = _approached(speeds)
        if not self._rehearsed:
            self._way_out.rehearse(observation.pose, window, settings.body, grids.goal)
            self._rehearsed = True
        if too_long and not approached and not self._way_out.begun:
            self._way_out.begin(observation.stamp, observation.pose, window, settings.body, grids.goal)
        out = self._way_out.velocity(observation.stamp, observation.pose, reachable, settings.roll_out.sim_time)
        if out is not None and not approached and self._is_free(window, state, out):
            return self._driven(observation, out)
        self._way_out.clear()
        turn = None if approached else self._turn.narrowed(reachable, observation.pose, observation.twist.wz, path)
        for velocities in (reachable,) if turn is None else (turn, reachable):
            best = cheapest_sample(window, grids, speeds, path, state, velocities, self._period, settings, self._oscillation.only)
            if math.isfinite(best[3]):
                return self._driven(observation, best[:3])
        raise NoValidCommand("dwa: every velocity of the window collides, oscillates or is too slow")

    def _driven(self, observation: Observation, velocity: FloatArray) -> Twist:
        """Return a velocity (3,) as a command, and remember its direction."""
        command = Twist(*velocity.tolist())
        self._oscillation.note(observation.stamp, observation.pose, command)
        return command

    def _is_free(self, window: Window, state: FloatArray, velocity: FloatArray) -> bool:
        """Tell whether a velocity (3,) collides with nothing for as long as samples are followed."""
        limits, roll_out, body, scales, _ = self._settings
        start, (vx, vy, wz) = stand_at(state[0], state[1], state[2]), velocity.tolist()
        gap = clearance(window, body.outline, *start, body.padding)
        cost = obstacle_cost(window, body, limits, roll_out, self._period, start, (vx, vy, wz), gap, scales.occdist_mean)
        return bool(cost != REJECTED)


def _approached(speeds: FieldArray) -> bool:
    """Tell whether something comes nearer to the robot, which stands in the middle of the window."""
    rows, columns = speeds.shape
    return bool(speeds[rows // 2, columns // 2] > 0.0)


def _or(value: float | None, otherwise: float) -> float:
    return float(otherwise if value is None else value)


def _turn_radius(robot: Robot) -> float:
    return robot.wheelbase / math.tan(robot.steering_max) if robot.kinematics == "ackermann" else 0.0


def _body(robot: Robot, padding: float, scaling_speed: float, max_scaling_factor: float) -> Body:
    footprint = robot.footprint
    vertices = None if footprint.is_circle else footprint.vertices_xy
    outline = outline_of(vertices, footprint.radius, footprint.inscribed_radius, OUTLINE_SPACING)
    return Body(outline, padding, scaling_speed, max_scaling_factor)


def _window(observation: Observation) -> Window:
    costmap = observation.local_map
    x, y = costmap.origin_xy.tolist()
    return Window(costmap.costs, costmap.distance, float(costmap.resolution), x, y)


def _state(observation: Observation) -> FloatArray:
    pose, twist = observation.pose, observation.twist
    return np.array((pose.x, pose.y, pose.theta, twist.vx, twist.vy, twist.wz))
