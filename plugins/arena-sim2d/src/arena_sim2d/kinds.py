"""The types of robots that worlds hold, as the kernels read them."""

from __future__ import annotations

from typing import NamedTuple

from arena_core import Robot
from arena_kernels.motion import Chassis, chassis_of
from arena_sim2d.odometry import Wheels, wheels_of
from arena_sim2d.scanning import Scanner, scanner_of


class Kind(NamedTuple):
    """How a type of robot moves, counts its wheels and scans."""

    chassis: Chassis
    wheels: Wheels
    device: Scanner


def kind_of(robot: Robot, inner_step: float) -> Kind:
    """Return what the kernels need to know of a type of robot."""
    wheels = wheels_of(robot.odometry, inner_step, holonomic=robot.holonomic)
    return Kind(chassis_of(robot), wheels, scanner_of(robot.lidar, inner_step))
