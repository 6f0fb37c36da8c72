"""The dynamic window approach of Fox, Burgard and Thrun (1997), in the manner of ROS's dwa_local_planner."""

from __future__ import annotations

import math
from typing import ClassVar

import numpy as np

from arena_core import Candidate, EpisodeStart, NoValidCommand, Observation, Planner, Robot, Twist
from arena_dwa.approach import ClosingSpeeds
from arena_dwa.arrival import Arrival
from arena_dwa.candidates import SearchInputs, arc_candidates
from arena_dwa.columns import COST, THETA, VELOCITY, VX, VY, X, Y
from arena_dwa.manoeuvre import Manoeuvre
from arena_dwa.map_grid import map_grids
from arena_dwa.obstacles import REJECTED, obstacle_cost
from arena_dwa.oscillation import OscillationFlags
from arena_dwa.parameters import (
    ApproachParameters,
    CriticParameters,
    FootprintParameters,
    GoalParameters,
    LimitParameters,
    OscillationParameters,
    RollOutParameters,
    TurnParameters,
    WayOutParameters,
)
from arena_dwa.passage import padding_along
from arena_dwa.search import cheapest_sample
from arena_dwa.settings import BodyOnWindow, FieldArray, FloatArray, Settings, make_settings
from arena_dwa.stuck_detection import StuckDetector
from arena_dwa.trajectory import planar_pose
from arena_dwa.turning import TurnInPlace
from arena_dwa.way_out import EscapeInputs, WayOut
from arena_dwa.window import dynamic_window
from arena_kernels.compiled import TypedDispatch
from arena_kernels.costmap_window import CLOSE, CostmapWindow, outline_clearance, window_of
from arena_kernels.escape import keeps_gap
from arena_kernels.passage import AHEAD


class DwaPlanner(Planner):
    """Samples velocities of the dynamic window, follows each for ``sim_time`` and drives the
    cheapest that does not collide.
    """

    compiles: ClassVar[bool] = True

    def __init__(
        self,
        robot: Robot,
        limits: LimitParameters,
        roll_out: RollOutParameters,
        footprint: FootprintParameters,
        critics: CriticParameters,
        approach: ApproachParameters,
        oscillation: OscillationParameters,
        goal: GoalParameters,
        turn_in_place: TurnParameters,
        way_out: WayOutParameters,
    ) -> None:
        self._own = self._settings = make_settings(robot, limits, roll_out, footprint, critics, approach)
        self._passage_padding = footprint.passage_padding
        in_force = self._own.limits
        self._closing = ClosingSpeeds(approach.lapse, approach.speed_min, approach.speed_max)
        self._oscillation = OscillationFlags(oscillation, still_below=in_force.trans_min)
        self._turn = TurnInPlace(turn_in_place, in_force.alpha_max, differential=robot.kinematics == "differential")
        self._standing = StuckDetector(way_out.patience)
        self._steered = robot.kinematics == "ackermann"  # which cannot turn on the spot
        least = footprint.padding if footprint.passage_padding is None else footprint.passage_padding
        self._way_out = (
            Manoeuvre(least, in_force) if self._steered else WayOut(way_out.reach, in_force, sideways=robot.holonomic)
        )
        self._rehearsed = False
        self._arrival = Arrival(goal, in_force)
        self._period = robot.control_period
        self._sim_period = roll_out.sim_period
        self._map_grids, self._cheapest_sample = TypedDispatch(map_grids), TypedDispatch(cheapest_sample)
        self._state: FloatArray | None = None
        self._searched: SearchInputs | None = None
        self._driven_at: FloatArray | None = None

    def reset(self, episode: EpisodeStart) -> None:
        """Forget the directions driven before."""
        self._period = episode.control_period
        self._oscillation.clear()
        self._closing.clear()
        self._turn.clear()
        self._arrival.clear()
        self._standing.clear()
        self._way_out.clear()
        self._settings, self._state = self._own, None

    def considered(self) -> list[Candidate]:
        """Return arcs of the window that was searched last, with what they cost; those that collide are refused."""
        return (
            []
            if self._state is None
            else arc_candidates(self._state, self._searched, self._driven_at, self._period, self._settings)
        )

    def compute_velocity(self, observation: Observation) -> Twist:
        """Return the cheapest admissible velocity of the window; raise NoValidCommand when every one is rejected."""
        window, state = window_of(observation.local_map), _state_vector(observation)
        self._state, self._searched, self._driven_at = state, None, None
        path = np.ascontiguousarray(observation.path.poses, np.float64)
        if len(path) == 0:
            raise NoValidCommand("dwa: the path is empty")
        lapse = self._period if self._sim_period is None else self._sim_period
        at_goal = self._arrival.target_velocity(observation.pose, state[VELOCITY:], path, observation.goal.theta, lapse)
        if at_goal is not None:
            if not self._is_free(window, state, at_goal):
                raise NoValidCommand("dwa: stopping or turning at the goal would collide")
            self._driven_at = np.append(at_goal, math.nan)
            return Twist(*at_goal.tolist())
        own = self._own
        grids = self._map_grids(
            BodyOnWindow(window, own.body), path, (state[X], state[Y]), own.scales.forward_point_distance
        )
        speeds = self._closing.update(observation.stamp, window)
        approached = _is_approached(speeds)
        settings = self._settings = own if approached else self._in_passage(window, path, state)
        reachable = dynamic_window(state[VELOCITY:], settings.limits, lapse)
        stuck = self._standing.is_stuck(observation.pose, observation.stamp)
        stuck = stuck or (self._steered and self._turn.is_behind(observation.pose, path))
        ground = EscapeInputs(window, settings.body, path, grids.goal)
        if not self._rehearsed:
            self._way_out.warm_up(observation.pose, ground)
            self._rehearsed = True
        if stuck and not approached and not self._way_out.is_active:
            self._way_out.begin(observation.stamp, observation.pose, ground)
        out = None if approached else self._escape_velocity(observation, window, state, reachable)
        if out is not None:
            return self._record_command(observation, out)
        self._way_out.clear()
        turn = None if approached else self._turn.turn_window(reachable, observation.pose, observation.twist.wz, path)
        for velocities in (reachable,) if turn is None else (turn, reachable):
            only = self._oscillation.only
            self._searched = SearchInputs(window, grids, speeds, path, velocities, only.copy())
            best = self._cheapest_sample(window, grids, speeds, path, state, velocities, self._period, settings, only)
            if math.isfinite(best[COST]):
                return self._record_command(observation, best[:COST], float(best[COST]))
        raise NoValidCommand("dwa: every velocity of the window collides, oscillates or is too slow")

    def _in_passage(self, window: CostmapWindow, path: FloatArray, state: FloatArray) -> Settings:
        """Return the settings, with less padding where the path leads through a passage that leaves no more."""
        own, least = self._own, self._passage_padding
        if least is None or least >= own.body.padding:
            return own
        ahead = max(AHEAD, math.hypot(state[VELOCITY + VX], state[VELOCITY + VY]) * own.roll_out.sim_time)
        padding = padding_along(BodyOnWindow(window, own.body), path, (state[X], state[Y]), ahead, least)
        return own._replace(body=own.body._replace(padding=padding))

    def _record_command(self, observation: Observation, velocity: FloatArray, cost: float = math.nan) -> Twist:
        """Return a velocity (3,) as a command, and remember its direction."""
        command, self._driven_at = Twist(*velocity.tolist()), np.append(velocity, cost)
        self._oscillation.record_command(observation.stamp, observation.pose, command)
        return command

    def _escape_velocity(
        self, observation: Observation, window: CostmapWindow, state: FloatArray, reachable: FloatArray
    ) -> FloatArray | None:
        """Return the velocity (3,) that leads out of a local minimum, None where none does."""
        out = self._way_out.target_velocity(observation.stamp, observation.pose, reachable, self._own.roll_out.sim_time)
        if out is None or not isinstance(self._way_out, Manoeuvre):
            return out if out is not None and self._is_free(window, state, out) else None
        limits, body = self._own.limits, self._own.body
        time = self._period + self._own.roll_out.stop_time_buffer  # the curve bends otherwise then
        free = keeps_gap(
            window, body.outline, state[:VELOCITY], out, time, limits.alpha_max, self._way_out.least, CLOSE
        )
        return self._way_out.hold_if_blocked(observation.stamp, out, free=free)

    def _is_free(self, window: CostmapWindow, state: FloatArray, velocity: FloatArray) -> bool:
        """Return whether a velocity (3,) collides with nothing for as long as samples are followed."""
        limits, roll_out, body, scales, _ = self._settings
        start, (vx, vy, wz) = planar_pose(state[X], state[Y], state[THETA]), velocity.tolist()
        gap = outline_clearance(window, body.outline, start, body.padding)
        cost = obstacle_cost(
            BodyOnWindow(window, body),
            limits,
            roll_out,
            self._period,
            start,
            (vx, vy, wz),
            gap,
            scales.occdist_mean,
            math.inf,
        )
        return bool(cost != REJECTED)


def _is_approached(speeds: FieldArray) -> bool:
    """Return whether something comes nearer to the robot, which stands in the middle of the window."""
    rows, columns = speeds.shape
    return bool(speeds[rows // 2, columns // 2] > 0.0)


def _state_vector(observation: Observation) -> FloatArray:
    pose, twist = observation.pose, observation.twist
    return np.array((pose.x, pose.y, pose.theta, twist.vx, twist.vy, twist.wz))
