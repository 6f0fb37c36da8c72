"""Optimal reciprocal collision avoidance of van den Berg, Guy, Lin and Manocha (2011), for one
robot among tracked people.
"""

from __future__ import annotations

import math
from dataclasses import asdict
from typing import ClassVar

import numpy as np

from arena_core import ConfigurationError, EpisodeStart, NoValidCommand, Observation, Planner, Robot, Twist
from arena_kernels.costmap_window import CostmapWindow, footprint_outline, window_of, without_discs
from arena_kernels.half_planes import FloatArray
from arena_orca.columns import RADIUS
from arena_orca.escape import StuckDetector, escape_command
from arena_orca.gear_changes import GearSelector
from arena_orca.parameters import (
    ACKERMANN,
    DIFFERENTIAL,
    OMNIDIRECTIONAL,
    Body,
    DriveRules,
    Driving,
    Limits,
    People,
    PersonRules,
    Settings,
    Speeds,
    StaticRules,
    Statics,
)
from arena_orca.step import choose_command

KINEMATICS = {"omnidirectional": OMNIDIRECTIONAL, "differential": DIFFERENTIAL, "ackermann": ACKERMANN}
SOON = 0.5  # s, over which a velocity is at least taken
ESCAPE_TIME = 1.0  # s that an escape is looked ahead


class OrcaPlanner(Planner):
    """Drives the velocity nearest to the path's that every tracked person and every
    wall nearby leaves free for a while.
    """

    compiles: ClassVar[bool] = True

    def __init__(self, robot: Robot, speeds: Speeds, people: People, statics: Statics, driving: Driving) -> None:
        if robot.kinematics not in KINEMATICS:
            raise ConfigurationError(
                f"orca: robot {robot.name} is {robot.kinematics}; allowed: {', '.join(KINEMATICS)}"
            )
        self._outline = footprint_outline(robot.footprint)
        self._settings = Settings(
            _make_body(robot, driving.centre_ahead),
            _make_limits(robot, speeds),
            PersonRules(people.horizon, people.reciprocity, people.margin, people.overlap_time, people.greatest_number),
            StaticRules(statics.horizon, statics.margin, statics.padding, people.overlap_time),
            DriveRules(
                driving.reach_time, driving.lookahead, driving.turn_time, driving.goal_time, robot.control_period
            ),
        )
        self._erase_margin = people.erase_margin
        self._patience = StuckDetector(driving.patience, driving.escape_time)
        self._gears = GearSelector(driving.lookahead, reversible=robot.kinematics == "ackermann")

    def reset(self, episode: EpisodeStart) -> None:
        """Begin an episode in the forward gear."""
        self._settings = self._settings._replace(
            drive=self._settings.drive._replace(period=float(episode.control_period))
        )
        self._gears.clear()
        self._patience.clear()

    def compute_velocity(self, observation: Observation) -> Twist:
        """Return the command of this step; raise NoValidCommand without a path, or
        when not even braking keeps clear.
        """
        path = np.ascontiguousarray(observation.path.poses, dtype=np.float64)
        if len(path) == 0:
            raise NoValidCommand("orca: the path is empty")
        window, state = window_of(observation.local_map), _state_vector(observation)
        if self._patience.is_stuck(observation.stamp, observation.pose):
            escape = self._find_escape(window, state)
            if escape is not None:
                return escape
        people = nearest_people(observation, state, self._settings)
        standing = without_discs(window, people[:, :2].copy(), people[:, RADIUS].copy(), self._erase_margin)
        for gear in self._gears.gear_order(observation.pose):
            valid, vx, vy, wz = choose_command(
                window, standing, self._outline, path, state, people, self._settings, gear
            )
            if valid and self._gears.accept_command(observation.pose, gear, vx, observation.twist.vx):
                return Twist(vx, vy, wz)
        if valid:
            return Twist(vx, vy, wz)
        raise NoValidCommand("orca: not even braking keeps the footprint clear of what stands around")

    def _find_escape(self, window: CostmapWindow, state: FloatArray) -> Twist | None:
        """Return the command that leads to more room, None if there is none."""
        found, vx, vy, wz = escape_command(window, self._outline, state, self._settings, ESCAPE_TIME)
        return Twist(vx, vy, wz) if found else None


def nearest_people(observation: Observation, state: FloatArray, settings: Settings) -> FloatArray:
    """Return rows (x, y, vx, vy, radius) of the tracks nearest to the robot, nearest first.

    Velocities lead to where each is expected when the robot could have met them, within the horizon: a velocity
    obstacle is all of a future that this planner can take in.
    """
    tracks, people = observation.tracks, settings.people
    gaps = np.hypot(*(tracks.positions - state[:2]).T) - tracks.radii
    chosen = np.argsort(gaps, kind="stable")[: people.greatest_number]
    speeds = settings.limits.vx_max + np.hypot(*tracks.velocities[chosen].T)
    meeting = np.clip(gaps[chosen] / speeds, min(SOON, people.horizon), people.horizon)
    velocities = observation.predictions.take(chosen).mean_velocities(meeting)
    return np.column_stack((tracks.positions[chosen], velocities, tracks.radii[chosen])).astype(np.float64)


def _make_body(robot: Robot, centre_ahead: float) -> Body:
    """Return the effective centre's place and the discs about it that hold the footprint and its front half."""
    footprint, kinematics = robot.footprint, KINEMATICS[robot.kinematics]
    if kinematics == OMNIDIRECTIONAL:
        return Body(kinematics, 0.0, footprint.radius, footprint.radius)
    if footprint.is_circle:
        return Body(
            kinematics, centre_ahead, footprint.radius + centre_ahead, math.hypot(footprint.radius, centre_ahead)
        )
    corners = footprint.vertices_xy - (centre_ahead, 0.0)
    whole = float(np.hypot(*corners.T).max())
    half_width = float(np.abs(corners[:, 1]).max())
    front = np.vstack((corners[corners[:, 0] > -centre_ahead], [(-centre_ahead, half_width)]))
    return Body(kinematics, centre_ahead, whole, float(np.hypot(*front.T).max()))


def _make_limits(robot: Robot, speeds: Speeds) -> Limits:
    own = robot.limits_with(**asdict(speeds))
    return Limits(
        own.vx_min, own.vx_max, own.vy_max, own.wz_max, own.ax_max, own.ay_max, own.alpha_max, robot.turn_radius
    )


def _state_vector(observation: Observation) -> FloatArray:
    pose, twist = observation.pose, observation.twist
    return np.array((pose.x, pose.y, pose.theta, twist.vx, twist.vy, twist.wz))
