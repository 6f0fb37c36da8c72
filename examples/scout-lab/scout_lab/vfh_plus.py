"""A planner after VFH+ (I.

Ulrich, J. Borenstein, VFH+: Reliable Obstacle Avoidance for Fast Mobile Robots, ICRA 1998).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from arena_core import (
    ConfigurationError,
    EpisodeStart,
    LaserScan,
    NoValidCommand,
    Observation,
    Planner,
    Robot,
    Twist,
    wrap_angle,
)
from arena_core.parameters import NonNegative, Positive, PositiveInt

Floats = NDArray[np.float64]

SLOWING = 2  # power of the cosine of the angle still to turn by which the robot drives slower
BRAKING = 1.0  # s, in which the way to the waypoint would be driven


@dataclass(frozen=True, slots=True)
class Weights:
    """What a direction costs by its angle to each of these."""

    waypoint: NonNegative
    heading: NonNegative
    last: NonNegative


class VfhPlus(Planner):
    """Turn to the cheapest free direction and drive there, slower the more the robot still has
    to turn and the less room there is.
    """

    def __init__(
        self,
        robot: Robot,
        speed: Positive | None,
        turn_gain: Positive,
        sectors: PositiveInt,
        margin: NonNegative,
        window: Positive,
        hysteresis: NonNegative,
        wide: PositiveInt,
        weights: Weights,
    ) -> None:
        if robot.kinematics == "ackermann":
            raise ConfigurationError(
                "planner vfh_plus needs a robot that can turn on the spot; robot.kinematics is ackermann"
            )
        self.limits, self.speed = robot.limits, min(speed or robot.limits.vx_max, robot.limits.vx_max)
        self.turn_gain, self.window, self.hysteresis, self.wide, self.weights = (
            turn_gain,
            window,
            hysteresis,
            wide,
            weights,
        )
        self.reach = robot.footprint.radius + margin
        self.directions: Floats = 2.0 * math.pi / sectors * np.arange(sectors, dtype=np.float64)
        self.blocked, self.last = np.zeros(sectors, bool), 0.0

    def reset(self, episode: EpisodeStart) -> None:
        """Forget which sectors were blocked, and the last choice."""
        self.blocked, self.last = np.zeros(len(self.directions), bool), 0.0

    def compute_velocity(self, observation: Observation) -> Twist:
        """Return the command; raise NoValidCommand when all directions are blocked."""
        distances, angles = points_of(observation.scan)
        rooms = room_in(self.directions, distances, angles, self.reach)
        target = observation.pose.relative(observation.waypoint)
        away, bearing = math.hypot(target.x, target.y), math.atan2(target.y, target.x)
        self.blocked = rooms < min(self.window, away + self.reach) + np.where(self.blocked, self.hysteresis, 0.0)
        if self.blocked.all():
            raise NoValidCommand("all directions are blocked")
        turn = self._cheapest(bearing, float(wrap_angle(self.last - observation.pose.theta)))
        self.last = observation.pose.theta + turn
        ahead = float(room_in(np.zeros(1), distances, angles, self.reach)[0])
        braking = math.sqrt(2.0 * self.limits.ax_max * max(ahead - self.reach, 0.0))
        speed = min(self.speed, braking, away / BRAKING) * max(math.cos(turn), 0.0) ** SLOWING
        return Twist(speed, 0.0, float(np.clip(self.turn_gain * turn, -self.limits.wz_max, self.limits.wz_max)))

    def _cheapest(self, bearing: float, last: float) -> float:
        """Return the angle to turn by, rad: to the cheapest candidate, or to the waypoint itself
        where that is in its sector.
        """
        candidates = self.directions[candidate_sectors(self.blocked, self.wide)]
        cost = self.weights.waypoint * np.abs(wrap_angle(candidates - bearing))
        cost += self.weights.heading * np.abs(wrap_angle(candidates)) + self.weights.last * np.abs(
            wrap_angle(candidates - last)
        )
        best = float(candidates[cost.argmin()])
        return float(wrap_angle(bearing if abs(wrap_angle(best - bearing)) <= math.pi / len(self.directions) else best))


def points_of(scan: LaserScan) -> tuple[Floats, Floats]:
    """Return how far from the robot's origin a scan's returns are, m, and in what directions, rad."""
    hit = np.flatnonzero(np.isfinite(scan.ranges))
    beams = scan.angle_min + scan.angle_increment * hit + scan.mount.theta
    x, y = scan.mount.x + scan.ranges[hit] * np.cos(beams), scan.mount.y + scan.ranges[hit] * np.sin(beams)
    return np.hypot(x, y), np.arctan2(y, x)


def room_in(directions: Floats, distances: Floats, angles: Floats, reach: float) -> Floats:
    """Return how far away the nearest point is that a disc of radius ``reach`` would meet on its way in
    each direction, m; inf: none.
    """
    halves = np.arcsin(np.minimum(reach / np.maximum(distances, 1e-6), 1.0))
    met = np.abs(wrap_angle(directions[:, None] - angles)) <= halves
    nearest: Floats = np.where(met, distances, np.inf).min(axis=1, initial=np.inf)
    return nearest


def candidate_sectors(blocked: NDArray[np.bool_], wide: int) -> NDArray[np.int64]:
    """Return the free sectors that may be chosen: at least half of ``wide`` from a valley's edge, or the
    middle of a narrower valley.
    """
    if not blocked.any():
        return np.arange(len(blocked))
    turned = np.arange(len(blocked)) + int(np.flatnonzero(blocked)[0])  # no valley spans the end of this order
    free = ~blocked[turned % len(blocked)]
    edges = np.flatnonzero(np.diff(np.concatenate(((0,), free.astype(np.int8), (0,)))))
    kept = [turned[_inside(first, end, wide)] for first, end in zip(edges[::2], edges[1::2], strict=True)]
    return np.concatenate(kept) % len(blocked)


def _inside(first: int, end: int, wide: int) -> slice:
    """Return what may be chosen of the valley of sectors ``first`` to ``end`` - 1."""
    if end - first < wide:
        return slice((first + end - 1) // 2, (first + end) // 2 + 1)
    return slice(first + wide // 2, end - wide // 2 + 1)
