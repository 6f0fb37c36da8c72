"""The way out of a car: back along an arc, then forwards on a curve to the narrow place ahead on the path, aligned with
it.

An arc of one velocity aligns no car with a door to which it comes obliquely; several can.
"""

from __future__ import annotations

import math

import numpy as np

from arena_core import Pose, wrap_angle
from arena_dwa.columns import HIGH, LEG_CURVATURE, LOW, VX, WZ, X, Y
from arena_dwa.curves import pose_along_arc, shortest_dubins_path
from arena_dwa.entrance import ASIDE, HEADINGS, fitting_poses
from arena_dwa.settings import Body, BodyOnWindow, FloatArray, Limits
from arena_dwa.trajectory import compose_poses, planar_pose
from arena_dwa.way_out import EscapeInputs

BENDS = np.array((0.0, 0.5, -0.5, 1.0, -1.0))  # of the tightest curve, back
ROOM_TO_STEER = 1.15  # turning radii on which a curve is planned: the rest leads back to it
BACK = 1.2  # m that leads the other way about before the curve, at most: as far as a Jackal turns by 140 degrees
SPEED, CREEP = 0.3, 0.1  # m/s on the way and at its corners
SLOWING = 0.5  # s that what is left of a piece lasts at least
STEP = 0.01  # m between two poses of a way
LAG = 3  # poses that it drives in a control period: it steers by the curvature there
LOOK = 30  # poses ahead, among which is the nearest
SETTLED = 0.1  # m on which an error beside the way decays
ARRIVED = 0.02  # m
OFF_TRACK = 0.15  # m
PATIENCE = 1.0  # s that it stands before something on its way
RETRY = 0.2  # s from a search that finds no way until the next
FORGETFUL = 1.0  # s without a search, after which the next is the first
RELUCTANT = 2.0  # s of searches that find no way that ends forwards, after which one may end backwards


class Manoeuvre:
    """Keeps to one way until it is driven, or the robot is off it."""

    def __init__(self, least: float, limits: Limits) -> None:
        self.least = least
        self._first = BACK if limits.vx_min < 0.0 else 0.0
        self._limits = limits
        self._radius = ROOM_TO_STEER * limits.turn_radius
        self._failed = self._failing_since = -math.inf
        self.clear()

    def clear(self) -> None:
        """Drive no way."""
        self._legs: list[tuple[float, FloatArray]] = []
        self._place, self._free_at = 0, 0.0

    def _with_less_padding(self, body: Body) -> Body:
        return body._replace(padding=min(body.padding, self.least))

    @property
    def is_active(self) -> bool:
        """Whether a way is being driven."""
        return bool(self._legs)

    def warm_up(self, pose: Pose, ground: EscapeInputs) -> None:
        """Look for a way to nowhere, so that the search is compiled before a control step needs it."""
        self._find_path(pose, ground, 1.0)

    def begin(self, stamp: float, pose: Pose, ground: EscapeInputs) -> None:
        """Look for a way from ``pose`` (``map``)."""
        if 0.0 <= stamp - self._failed < RETRY:  # stamps begin again with an episode
            return
        if not 0.0 <= stamp - self._failed < FORGETFUL:
            self._failing_since = stamp
        pieces = self._find_path(pose, ground, 1.0)
        if not pieces.any() and self._first > 0.0 and stamp - self._failing_since > RELUCTANT:
            pieces = self._find_path(pose, ground, -1.0)
        self._legs, self._place, self._free_at = path_segments(pose, pieces), 0, stamp
        self._failed = -math.inf if self._legs else stamp

    def _find_path(self, pose: Pose, ground: EscapeInputs, gear: float) -> FloatArray:
        """Return the pieces (4, 2) of the shortest way in ``gear`` with the padding, of that with the least
        padding where there is none.
        """
        start, bends = planar_pose(pose.x, pose.y, pose.theta), BENDS / self._radius
        pieces = np.zeros((4, 2))
        for body in (ground.body, self._with_less_padding(ground.body)):
            ends = fitting_poses(
                BodyOnWindow(ground.window, body), ground.path, (pose.x, pose.y), gear, HEADINGS, ASIDE
            )
            pieces = shortest_dubins_path(
                BodyOnWindow(ground.window, body), start, ends, gear, self._radius, self._first, bends
            )
            if pieces.any():
                break
        return pieces

    def target_velocity(self, stamp: float, pose: Pose, velocities: FloatArray, time: float) -> FloatArray | None:
        """Return the velocity (3,) within the window ``velocities`` (3, 2) that
        follows the way; None when it is done.
        """
        while self._legs:
            sign, leg = self._legs[0]
            ahead = leg[self._place : self._place + LOOK]
            off = np.hypot(ahead[:, X] - pose.x, ahead[:, Y] - pose.y)
            self._place += int(off.argmin())
            left = len(leg) - 1 - self._place
            if off.min() > OFF_TRACK:
                self._legs = []
            elif left * STEP < ARRIVED:
                self._legs, self._place = self._legs[1:], 0
            else:
                return self._path_velocity(pose, sign, leg, velocities)
        return None

    def hold_if_blocked(self, stamp: float, velocity: FloatArray, *, free: bool) -> FloatArray | None:
        """Return the velocity where it is ``free``; else stand for a while: a noisy scan marks a
        cell that the next one may clear.
        """
        if free:
            self._free_at = stamp
            return velocity
        return np.zeros(3) if stamp - self._free_at < PATIENCE else None

    def _path_velocity(self, pose: Pose, sign: float, leg: FloatArray, velocities: FloatArray) -> FloatArray:
        x, y, theta, _ = leg[self._place].tolist()
        curvature = float(leg[min(self._place + LAG, len(leg) - 1), LEG_CURVATURE])
        aside, off = Pose(x, y, theta).relative(pose).y, float(wrap_angle(pose.theta - theta))
        tightest = 1.0 / self._limits.turn_radius
        curvature = min(max(curvature - aside / SETTLED**2 - 2.0 * sign * off / SETTLED, -tightest), tightest)
        speed = sign * min(SPEED, max(CREEP, (len(leg) - self._place) * STEP / SLOWING))
        vx = min(max(speed, float(velocities[VX, LOW])), float(velocities[VX, HIGH]))
        return np.array((vx, 0.0, min(max(vx * curvature, float(velocities[WZ, LOW])), float(velocities[WZ, HIGH]))))


def path_segments(pose: Pose, pieces: FloatArray) -> list[tuple[float, FloatArray]]:
    """Return the legs of a way of ``pieces`` (K, 2) from ``pose``: 1 or -1 for backwards, and poses with
    curvatures (N, 4), STEP apart.
    """
    found: list[tuple[float, FloatArray]] = []
    stand = planar_pose(pose.x, pose.y, pose.theta)
    for length, curvature in pieces.tolist():
        parts = round(abs(length) / STEP)
        rows = [
            (*compose_poses(stand, pose_along_arc(length * k / parts, curvature)), curvature)
            for k in range(1, parts + 1)
        ]
        if not rows:
            continue
        x, y, cosine, sine, curvatures = np.array(rows).T
        leg, sign = np.column_stack((x, y, np.arctan2(sine, cosine), curvatures)), math.copysign(1.0, length)
        if found and found[-1][0] == sign:
            leg = np.vstack((found.pop()[1], leg))
        found.append((sign, leg))
        stand = compose_poses(stand, pose_along_arc(length, curvature))
    return found
