"""What a robot is: how it moves, what it looks like, what it senses."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from arena_core.geometry import FloatArray, Footprint, Pose

Kinematics = Literal["differential", "omnidirectional", "ackermann"]


@dataclass(frozen=True, slots=True)
class VelocityLimits:
    """Speeds and the one set of accelerations of a robot, in ``base_link``.

    ``vy`` limits are zero unless the robot is omnidirectional. Accelerations are magnitudes, used
    for speeding up and for braking alike.
    """

    vx_min: float  # m/s, <= 0
    vx_max: float  # m/s
    vy_max: float  # m/s, symmetric
    wz_max: float  # rad/s, symmetric
    ax_max: float  # m/s^2
    ay_max: float  # m/s^2
    alpha_max: float  # rad/s^2


@dataclass(frozen=True, slots=True)
class Lidar:
    """A planar laser scanner: beams from ``angle_min`` by ``angle_increment``, counter-clockwise.

    ``mount`` is the sensor's pose in ``base_link``; ``period`` is in s; ``noise_std`` is the standard
    deviation of the Gaussian range noise, m.
    """

    beams: int
    angle_min: float
    angle_increment: float
    range_min: float
    range_max: float
    period: float
    noise_std: float
    mount: Pose

    def angles(self) -> FloatArray:
        """Return the beam angles in the sensor's frame, shape (beams,), rad."""
        return self.angle_min + self.angle_increment * np.arange(self.beams)


@dataclass(frozen=True, slots=True)
class OdometryModel:
    """Wheel odometry with the noise of Thrun, Burgard, Fox, Probabilistic Robotics, table 5.6.

    ``alpha1`` rotation from rotation, ``alpha2`` rotation from translation, ``alpha3`` translation
    from translation, ``alpha4`` translation from rotation; ``period`` in s.
    """

    period: float
    alpha1: float
    alpha2: float
    alpha3: float
    alpha4: float


@dataclass(frozen=True, slots=True)
class Robot:
    """One robot model; every planner, simulator and task reads its figures from here.

    ``wheelbase`` (m) and ``steering_max`` (rad) are zero unless the kinematics are Ackermann.
    ``control_period`` is in s.
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
        """Tell whether the robot can move sideways."""
        return self.kinematics == "omnidirectional"
