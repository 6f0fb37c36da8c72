"""Poses, velocities and footprints: SI units, radians, frames after REP-103 and REP-105."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from arena_core.base.errors import ConfigurationError
from arena_core.base.frozen import freeze_array

FloatArray = NDArray[np.float64]


def wrap_angle(angle: ArrayLike) -> FloatArray:
    """Wrap angles to [-pi, pi)."""
    return (np.asarray(angle, dtype=np.float64) + math.pi) % (2.0 * math.pi) - math.pi


@dataclass(frozen=True, slots=True)
class Pose:
    """Position and heading, as a value; in the frame that the context names (``map`` unless said).

    Attributes:

    - ``x``, ``y``: m.
    - ``theta``: rad, counter-clockwise from x; not wrapped unless a method says so.

    ```python
    robot, goal = Pose(1.0, 0.0, math.pi / 2.0), Pose(1.0, 2.0)
    assert robot.distance(goal) == 2.0
    assert round(robot.relative(goal).x, 9) == 2.0  # the goal lies ahead
    ```
    """

    x: float
    y: float
    theta: float = 0.0

    def array(self) -> FloatArray:
        """Return (x, y, theta), shape (3,)."""
        return np.array((self.x, self.y, self.theta))

    @staticmethod
    def of(array: ArrayLike) -> Pose:
        """Build a pose from (x, y, theta)."""
        x, y, theta = np.asarray(array, dtype=np.float64).tolist()
        return Pose(x, y, theta)

    def distance(self, other: Pose) -> float:
        """Return the Euclidean distance between the two positions, m."""
        return math.hypot(self.x - other.x, self.y - other.y)

    def compose(self, relative: Pose) -> Pose:
        """Return the pose that ``relative``, given in this pose's frame, has in this pose's parent frame."""
        c, s = math.cos(self.theta), math.sin(self.theta)
        return Pose(
            self.x + c * relative.x - s * relative.y,
            self.y + s * relative.x + c * relative.y,
            _wrap_scalar(self.theta + relative.theta),
        )

    def relative(self, other: Pose) -> Pose:
        """Return ``other``, given in this pose's parent frame, in this pose's own frame."""
        c, s = math.cos(self.theta), math.sin(self.theta)
        dx, dy = other.x - self.x, other.y - self.y
        return Pose(c * dx + s * dy, -s * dx + c * dy, _wrap_scalar(other.theta - self.theta))


def _wrap_scalar(angle: float) -> float:
    return (angle + math.pi) % (2.0 * math.pi) - math.pi


@dataclass(frozen=True, slots=True)
class Twist:
    """Velocity in ``base_link``, as ROS's ``geometry_msgs/Twist`` in the plane: what a planner commands.

    Attributes:

    - ``vx``: forward, m/s.
    - ``vy``: to the left, m/s; 0 unless the robot is omnidirectional.
    - ``wz``: counter-clockwise, rad/s.

    ```python
    assert Twist(0.5).array().tolist() == [0.5, 0.0, 0.0]
    assert Twist.of((0.5, 0.0, 1.0)) == Twist(0.5, 0.0, 1.0)
    ```
    """

    vx: float
    vy: float = 0.0
    wz: float = 0.0

    def array(self) -> FloatArray:
        """Return (vx, vy, wz), shape (3,)."""
        return np.array((self.vx, self.vy, self.wz))

    @staticmethod
    def of(array: ArrayLike) -> Twist:
        """Build a twist from (vx, vy, wz)."""
        vx, vy, wz = np.asarray(array, dtype=np.float64).tolist()
        return Twist(vx, vy, wz)


@dataclass(frozen=True, slots=True, eq=False)
class Footprint:
    """Outline of a body in its own frame: a circle (``vertices_xy`` empty) or a convex polygon.

    ``vertices_xy`` has shape (V, 2), m, counter-clockwise. ``radius`` is the circle's radius, or the
    radius of the smallest circle about the origin that holds the polygon.
    """

    radius: float
    vertices_xy: FloatArray

    def __post_init__(self) -> None:
        object.__setattr__(self, "vertices_xy", freeze_array(self.vertices_xy))

    @staticmethod
    def circle(radius: float) -> Footprint:
        """Make a disc about the origin; raise ConfigurationError unless ``radius`` > 0 m."""
        if not (math.isfinite(radius) and radius > 0.0):
            raise ConfigurationError(f"footprint radius is {radius}; allowed: a finite number > 0 (m)")
        return Footprint(float(radius), np.empty((0, 2)))

    @staticmethod
    def polygon(vertices_xy: ArrayLike) -> Footprint:
        """Make a convex polygon from (V, 2) vertices; raise ConfigurationError if it is not
        convex or holds no origin.
        """
        vertices = np.asarray(vertices_xy, dtype=np.float64)
        if vertices.ndim != 2 or vertices.shape[1] != 2 or len(vertices) < 3:
            raise ConfigurationError("footprint polygon needs three or more [x, y] vertices (m)")
        edges = np.roll(vertices, -1, axis=0) - vertices
        turns = np.cross(np.pad(edges, ((0, 0), (0, 1))), np.pad(np.roll(edges, -1, axis=0), ((0, 0), (0, 1))))[:, 2]
        if (turns < 0).all():
            return Footprint.polygon(vertices[::-1])
        headings = np.arctan2(edges[:, 1], edges[:, 0])
        turning = wrap_angle(np.diff(headings, append=headings[0])).sum()
        if not ((turns > 0).all() and turning < 3.0 * math.pi):  # a star turns left throughout, but twice round
            raise ConfigurationError("footprint polygon must be convex, without repeated or collinear vertices")
        if _inscribed_radius(vertices) <= 0.0:
            raise ConfigurationError("footprint polygon must contain the origin of base_link")
        return Footprint(float(np.hypot(*vertices.T).max()), vertices)

    @property
    def is_circle(self) -> bool:
        """Return whether the outline is a disc."""
        return len(self.vertices_xy) == 0

    @property
    def inscribed_radius(self) -> float:
        """Return the radius of the largest disc about the origin inside the outline, m."""
        return self.radius if self.is_circle else _inscribed_radius(self.vertices_xy)

    @property
    def half_width(self) -> float:
        """Return how far the outline reaches to its wider side, m: half the width of a passage along its x axis
        that it just fits.
        """
        return self.radius if self.is_circle else float(np.abs(self.vertices_xy[:, 1]).max())


def _inscribed_radius(vertices: FloatArray) -> float:
    """Return the least signed distance from the origin to the edges of a counter-clockwise polygon."""
    edges = np.roll(vertices, -1, axis=0) - vertices
    normals = np.stack((edges[:, 1], -edges[:, 0]), axis=1) / np.hypot(*edges.T)[:, None]
    return float((normals * vertices).sum(axis=1).min())
