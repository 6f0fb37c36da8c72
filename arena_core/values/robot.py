"""What a robot is: how it moves, what it looks like, what it senses."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Annotated, Literal

import numpy as np

from arena_core.base.errors import ConfigurationError
from arena_core.values.geometry import FloatArray, Footprint, Pose
from arena_core.values.parameters import Acceleration, Beams, Bounds, NonNegative, Positive, Speed

Kinematics = Literal["differential", "omnidirectional", "ackermann"]


@dataclass(frozen=True, slots=True)
class VelocityLimits:
    """Speeds and the one set of accelerations of a robot, in ``base_link``.

    ``vy`` limits are zero unless the robot is omnidirectional. Accelerations are magnitudes, used
    for speeding up and for braking alike.
    """

    vx_min: Annotated[float, Bounds(high=0.0)]  # m/s
    vx_max: Speed  # m/s
    vy_max: NonNegative  # m/s, symmetric
    wz_max: Speed  # rad/s, symmetric
    ax_max: Acceleration  # m/s^2
    ay_max: NonNegative  # m/s^2
    alpha_max: Acceleration  # rad/s^2


@dataclass(frozen=True, slots=True)
class Lidar:
    """A planar laser scanner: beams from ``angle_min`` by ``angle_increment``, counter-clockwise.

    ``mount`` is the sensor's pose in ``base_link``; ``period`` is in s; ``noise_std`` is the standard
    deviation of the Gaussian range noise, m.
    """

    beams: Beams
    angle_min: float
    angle_increment: Positive
    range_min: NonNegative
    range_max: Positive
    period: Positive
    noise_std: NonNegative
    mount: Pose

    def angles(self) -> FloatArray:
        """Return the beam angles in the sensor's frame, shape (beams,), rad."""
        return self.angle_min + self.angle_increment * np.arange(self.beams, dtype=np.float64)


@dataclass(frozen=True, slots=True)
class OdometryModel:
    """Wheel odometry with the noise of Thrun, Burgard, Fox, Probabilistic Robotics, table 5.6.

    ``alpha1`` rotation from rotation, ``alpha2`` rotation from translation, ``alpha3`` translation
    from translation, ``alpha4`` translation from rotation; ``period`` in s.
    """

    period: Positive
    alpha1: NonNegative
    alpha2: NonNegative
    alpha3: NonNegative
    alpha4: NonNegative


@dataclass(frozen=True, slots=True)
class Robot:
    """One robot model; every planner, simulator and task reads its figures from here.

    It comes from a YAML file through ``make_robot``, and never changes.

    Attributes:

    - ``name``: as ``robot=NAME`` says it.
    - ``kinematics``: ``differential``, ``omnidirectional`` or ``ackermann``.
    - ``footprint``: the outline in ``base_link``, m.
    - ``limits``: speeds and accelerations in ``base_link``, m/s, rad/s, m/s^2, rad/s^2.
    - ``lidar``, ``odometry``: the sensors.
    - ``control_period``: s between two commands.
    - ``wheelbase`` (m), ``steering_max`` (rad): 0 unless the kinematics are Ackermann.

    ```python
    def brakes_within(robot: Robot) -> float:
        return robot.limits.vx_max**2 / (2.0 * robot.limits.ax_max)  # m
    ```
    """

    name: str
    kinematics: Kinematics
    footprint: Footprint
    limits: VelocityLimits
    lidar: Lidar
    odometry: OdometryModel
    control_period: float
    wheelbase: float = 0.0
    steering_max: float = 0.0

    @property
    def holonomic(self) -> bool:
        """Return whether the robot can move sideways."""
        return self.kinematics == "omnidirectional"

    @property
    def turn_radius(self) -> float:
        """Return the least radius of the robot's turns, m; 0 unless it steers."""
        return self.wheelbase / math.tan(self.steering_max) if self.kinematics == "ackermann" else 0.0

    def limits_with(self, **wanted: float | None) -> VelocityLimits:
        """Return the limits to plan with: those wanted, by their names in VelocityLimits, and the robot's own for what
        is None.

        Whoever plans may count on more than the robot has: the simulator holds it to its own. Sideways moves only a
        robot that can.
        """
        given = {name: float(value) for name, value in wanted.items() if value is not None}
        return replace(self.limits, **given) if self.holonomic else replace(self.limits, **{**given, "vy_max": 0.0})


@dataclass(frozen=True, slots=True)
class FootprintShape:
    """A footprint as robots' YAML files write it: a ``radius`` (m) or convex ``vertices_xy`` (m), the other null."""

    radius: Positive | None
    vertices_xy: list[list[float]] | None


def make_robot(
    name: str,
    kinematics: Kinematics,
    footprint: FootprintShape,
    limits: VelocityLimits,
    lidar: Lidar,
    odometry: OdometryModel,
    control_period: Positive,
    wheelbase: NonNegative,
    steering_max: NonNegative,
) -> Robot:
    """Build a robot from its YAML; raise ConfigurationError where figures contradict each other."""
    if (footprint.radius is None) == (footprint.vertices_xy is None):
        raise ConfigurationError(f"robot {name}: footprint needs either radius or vertices_xy, the other null")
    if kinematics == "ackermann" and not (wheelbase > 0.0 and steering_max > 0.0):
        raise ConfigurationError(f"robot {name}: wheelbase and steering_max must be > 0 for ackermann kinematics")
    if kinematics != "omnidirectional" and limits.vy_max != 0.0:
        raise ConfigurationError(
            f"robot {name}: limits.vy_max is {limits.vy_max}; allowed: 0 for {kinematics} kinematics"
        )
    if lidar.range_min >= lidar.range_max:
        raise ConfigurationError(
            f"robot {name}: lidar.range_min is {lidar.range_min}; allowed: below range_max {lidar.range_max}"
        )
    shape = (
        Footprint.circle(footprint.radius)
        if footprint.radius is not None
        else Footprint.polygon(footprint.vertices_xy or [])
    )
    return Robot(name, kinematics, shape, limits, lidar, odometry, control_period, wheelbase, steering_max)
