"""The timed elastic band planner of Roesmann et al. (2012 to 2017)."""

from __future__ import annotations

import math
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from arena_core import (
    Candidate,
    EpisodeStart,
    NoValidCommand,
    Observation,
    Planner,
    Pose,
    Predictions,
    Robot,
    Tracks,
    Twist,
)
from arena_kernels.costmap_window import CostmapWindow, close_gap, footprint_outline, window_of, without_discs
from arena_kernels.escape import escape_command, escape_commands, keeps_gap
from arena_kernels.foreseen import Foreseen
from arena_kernels.passage import AHEAD, KEPT, reduced_gap, room_along
from arena_teb.columns import TIME, VX, VY, WZ
from arena_teb.feasibility import free_poses
from arena_teb.local_plan import end_heading, local_plan
from arena_teb.model import make_model, speed_limits, turning_radius
from arena_teb.motion import first_velocity, saturate_velocity
from arena_teb.oscillation import OscillationDetector
from arena_teb.parameters import Homotopy, Limits, Obstacles, Optimisation, Polygons, Recovery, Trajectory, Weights
from arena_teb.polygons import NO_HULLS, hulls_of
from arena_teb.problem import Ends, FloatArray
from arena_teb.surroundings import Scene
from arena_teb.topologies import Topologies, Topology, Way

HEADING_OVER = 0.3  # m at the end of the local plan over which its direction is taken


class TebPlanner(Planner):
    """Optimises bands of several topologies from where the robot is to a local goal and drives
    the cheapest that it fits.
    """

    compiles: ClassVar[bool] = True

    def __init__(
        self,
        robot: Robot,
        limits: Limits,
        trajectory: Trajectory,
        obstacles: Obstacles,
        polygons: Polygons,
        optimisation: Optimisation,
        weights: Weights,
        homotopy: Homotopy,
        recovery: Recovery,
    ) -> None:
        self._least, self._most, _ = speed_limits(robot, limits)
        self._turn_radius = turning_radius(robot, limits)
        self._braking, self._turn_braking = robot.limits.ax_max, robot.limits.alpha_max
        self._close, self._holonomic = close_gap(self._turn_radius), robot.holonomic
        self._trajectory, self._obstacles, self._polygons, self._recovery = trajectory, obstacles, polygons, recovery
        self._horizon = math.inf if obstacles.prediction_time is None else obstacles.prediction_time
        self._outline = footprint_outline(robot.footprint)
        self._topologies = Topologies(
            homotopy, trajectory, make_model(robot, limits, trajectory, obstacles, optimisation, weights), self._outline
        )
        self._oscillation = OscillationDetector(recovery, float(self._most[VX]), float(self._most[WZ]))
        self._escapes = escape_commands(
            self._least, self._most, recovery.escape_speed, self._turn_radius, holonomic=self._holonomic
        )
        self._period = robot.control_period
        self._infeasible_since: float | None = None
        self._shrunk_until = -math.inf
        self._weighed: tuple[list[Topology], FloatArray | None] = [], None

    def reset(self, episode: EpisodeStart) -> None:
        """Forget all bands and troubles."""
        self._period = episode.control_period
        self._topologies.begin(episode.random)
        self._oscillation.clear(episode.control_period)
        self._infeasible_since, self._shrunk_until = None, -math.inf
        self._weighed = [], None

    def considered(self) -> list[Candidate]:
        """Return the bands that were optimised, with what they cost; those that run into something are refused."""
        topologies, driven = self._weighed
        costs = [math.inf if topology.blocked else topology.cost for topology in topologies]
        return [
            Candidate(one.band[:, :2], cost, one.band is driven) for one, cost in zip(topologies, costs, strict=True)
        ]

    def compute_velocity(self, observation: Observation) -> Twist:
        """Return the first velocity of the best feasible band; raise NoValidCommand when there is
        none and no way to back out.
        """
        pose, stamp, self._weighed = observation.pose, observation.stamp, ([], None)
        rows = nearest_tracks(observation, self._obstacles)
        tracks = _select_tracks(observation.tracks, rows)
        foreseen = foreseen_of(observation.predictions.take(rows))
        window = without_discs(
            window_of(observation.local_map), tracks.positions, tracks.radii, self._obstacles.track_margin
        )
        plan, complete = local_plan(
            observation.path.poses, pose, window, self._lookahead_distance(stamp), self._outline.inscribed_radius
        )
        goal = self._local_goal(plan, pose, observation.goal, complete=complete)
        scene = self._build_scene(window, foreseen, tracks.radii, plan)
        least_gap = self._least_gap(window, plan, pose)
        ends = self._band_ends(observation.twist, stamp, complete=complete)
        topologies = self._topologies.plan(Way(plan, pose.array(), goal), scene, ends, stamp)
        band = self._first_feasible(topologies, window, pose, observation.twist.array(), least_gap)
        self._weighed = topologies, band
        command = self._escape_command(pose, scene, least_gap, stamp) if band is None else self._drive_band(band)
        self._oscillation.record_command(command)
        return command

    def _build_scene(self, window: CostmapWindow, foreseen: Foreseen, radii: FloatArray, plan: FloatArray) -> Scene:
        hulls = NO_HULLS if self._obstacles.costmap_converter is None else hulls_of(window, self._polygons)
        return Scene(window, hulls, foreseen, radii, self._horizon, self._via_points(plan))

    def _lookahead_distance(self, stamp: float) -> float:
        """Return how far ahead the band reaches, m: half as far for some time after nothing was feasible."""
        full = self._trajectory.max_global_plan_lookahead_dist
        return 0.5 * full if stamp < self._shrunk_until else full

    def _local_goal(self, plan: FloatArray, pose: Pose, goal: Pose, *, complete: bool) -> FloatArray:
        given = complete and self._trajectory.goal_heading == "goal"
        return np.array((*plan[-1, :2], goal.theta if given else end_heading(plan, pose, HEADING_OVER)))

    def _band_ends(self, twist: Twist, stamp: float, *, complete: bool) -> Ends:
        stops = complete or not self._trajectory.free_goal_vel
        free = self._trajectory.goal_heading == "free"
        return Ends(twist.array(), np.zeros(3), float(stops), float(free), self._oscillation.preferred_turn(stamp))

    def _via_points(self, plan: FloatArray) -> FloatArray:
        """Return points of the plan at a distance of ``global_plan_viapoint_sep``, (V, 2)."""
        spacing = self._trajectory.global_plan_viapoint_sep
        if spacing is None:
            return np.empty((0, 2))
        along = np.concatenate(((0.0,), np.cumsum(np.hypot(*np.diff(plan[:, :2], axis=0).T))))
        at = np.arange(spacing, along[-1], spacing)
        return np.column_stack([np.interp(at, along, plan[:, axis]) for axis in range(2)])

    def _least_gap(self, window: CostmapWindow, plan: FloatArray, pose: Pose) -> float:
        """Return the gap to walls that the robot keeps here, m: less where its path has no more room."""
        return reduced_gap(
            self._obstacles.least_gap, room_along(window, self._outline, plan, (pose.x, pose.y), AHEAD), KEPT, 0.0
        )

    def _first_feasible(
        self, topologies: list[Topology], window: CostmapWindow, pose: Pose, twist: FloatArray, least_gap: float
    ) -> FloatArray | None:
        """Return the first band whose first poses the robot fits, and whose command it can drive.

        Else the one that is free longest, if the robot can stop in that time: at a goal beside a wall no pose may fit.
        None: there is none.
        """
        poses = self._trajectory.feasibility_check_no_poses
        longest, best = self._period + math.hypot(twist[VX], twist[VY]) / self._braking, None
        for topology in topologies:
            band = topology.band
            free = free_poses(band[:poses], window, self._outline, least_gap, self._close)
            if least_gap > 0.0 and not self._keeps_gap(band, window, pose, least_gap):
                continue
            if free >= min(poses, len(band)):
                return band
            if least_gap > 0.0 and float(band[: free - 1, TIME].sum()) > longest:
                longest, best = float(band[: free - 1, TIME].sum()), band
        return best

    def _keeps_gap(self, band: FloatArray, window: CostmapWindow, pose: Pose, least_gap: float) -> bool:
        """Return whether the command that a band begins with keeps the gap to walls."""
        command = self._band_command(band).array()
        return keeps_gap(
            window,
            self._outline,
            pose.array(),
            command,
            self._period,
            self._turn_braking,
            least_gap,
            self._close,
        )

    def _drive_band(self, band: FloatArray) -> Twist:
        self._infeasible_since = None
        return self._band_command(band)

    def _band_command(self, band: FloatArray) -> Twist:
        return saturate_velocity(
            first_velocity(band, self._period), self._least, self._most, self._turn_radius, holonomic=self._holonomic
        )

    def _escape_command(self, pose: Pose, scene: Scene, least_gap: float, stamp: float) -> Twist:
        """Begin again with a shorter horizon; after a while, return a slow way to where there is more room."""
        recovery = self._recovery
        self._topologies.clear()
        self._infeasible_since = stamp if self._infeasible_since is None else self._infeasible_since
        if recovery.shrink_horizon_backup:
            self._shrunk_until = stamp + recovery.shrink_horizon_min_duration
        if recovery.escape_after is not None and stamp - self._infeasible_since >= recovery.escape_after - 1e-9:
            moving = scene.foreseen, scene.radii
            found = escape_command(pose.array(), scene.window, self._outline, *moving, self._escapes, least_gap)
            if len(found):
                return Twist.of(found[0])
        raise NoValidCommand("teb: no band is feasible")


def nearest_tracks(observation: Observation, obstacles: Obstacles) -> NDArray[np.int64]:
    """Return the rows of the tracks that count, the nearest ones that are not so slow, now and as they are
    expected to go on, that they stay obstacles that stand.
    """
    tracks, pose = observation.tracks, observation.pose
    if not obstacles.include_dynamic_obstacles:
        return np.empty(0, np.int64)
    finite = np.isfinite(tracks.positions).all(axis=1) & np.isfinite(tracks.velocities).all(axis=1)
    finite &= observation.predictions.top_speeds() >= obstacles.static_below
    away = np.where(finite, np.hypot(*(tracks.positions - (pose.x, pose.y)).T), np.inf)
    return np.argsort(away, kind="stable")[: min(obstacles.max_tracks, int(finite.sum()))]


def foreseen_of(predictions: Predictions) -> Foreseen:
    """Return where tracks are expected."""
    return Foreseen.of(predictions.times, predictions.means, predictions.legs())


def _select_tracks(tracks: Tracks, rows: NDArray[np.int64]) -> Tracks:
    fields = (tracks.positions, tracks.velocities, tracks.radii)
    positions, velocities, radii = (np.ascontiguousarray(field[rows], np.float64) for field in fields)
    return Tracks(tracks.ids[rows], positions, velocities, radii, tracks.covariances[rows])
