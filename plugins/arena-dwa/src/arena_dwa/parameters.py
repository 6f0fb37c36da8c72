"""What the compiled search is told: tuples of plain numbers and arrays, in SI units."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arena_kernels.window import Outline

FloatArray = NDArray[np.float64]
FieldArray = NDArray[np.float32]


class Limits(NamedTuple):
    """Speeds (m/s, rad/s), accelerations (m/s^2, rad/s^2) and the least turning radius (m, 0 unless Ackermann).

    A sample slower than ``trans_min`` *and* turning slower than ``theta_min`` is not driven.
    """

    vx_min: float
    vx_max: float
    vy_max: float
    wz_max: float
    trans_min: float
    trans_max: float
    theta_min: float
    ax_max: float
    ay_max: float
    alpha_max: float
    turn_radius: float


class RollOut(NamedTuple):
    """How many velocities are tried and how far each is followed: s, m and rad between two poses, samples an axis."""

    sim_time: float
    sim_granularity: float
    angular_sim_granularity: float
    stop_time_buffer: float
    vx_samples: int
    vy_samples: int
    vth_samples: int


class Body(NamedTuple):
    """The robot's outline, and the padding (m) that it keeps.

    The outline grows with speed above ``scaling_speed`` (m/s), by the fraction ``max_scaling_factor`` at full speed.
    """

    outline: Outline
    padding: float
    scaling_speed: float
    max_scaling_factor: float


class Scales(NamedTuple):
    """The weights of the critics, in the units of ROS's dwa_local_planner where it has them."""

    path_distance_bias: float
    goal_distance_bias: float
    occdist_scale: float
    occdist_mean: bool
    forward_point_distance: float
    twirling_scale: float
    reverse_scale: float
    escape_scale: float


class Approach(NamedTuple):
    """The approach critic: its weight, how far ahead it looks (s), and the gap it wants to keep (m)."""

    scale: float
    time: float
    margin: float


class Settings(NamedTuple):
    """All that does not change from step to step."""

    limits: Limits
    roll_out: RollOut
    body: Body
    scales: Scales
    approach: Approach


class MapGrids(NamedTuple):
    """Steps from the path, the local goal and the goal of the robot's front: the window's cells with a border of one, flat."""

    path: NDArray[np.int32]
    goal: NDArray[np.int32]
    goal_front: NDArray[np.int32]
