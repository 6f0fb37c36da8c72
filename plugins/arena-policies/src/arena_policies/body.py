"""The body that a policy was trained in, and how it followed commands, where it drives another one."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from arena_core import ConfigurationError, Footprint, Robot

SAME = 1e-3  # m, m/s^2, rad/s^2


class Body(NamedTuple):
    """What a policy grows used to: the circles about and within the footprint, and where the
    lidar sits in ``base_link``, m.
    """

    radius: float
    inscribed_radius: float
    lidar_x: float
    lidar_y: float

    def describe(self) -> str:
        """Return what a line says of it."""
        return f"a footprint of radius {self.radius:.3f} m and the lidar at ({self.lidar_x:g}, {self.lidar_y:g})"


class Accelerations(NamedTuple):
    """How a body follows commands, m/s^2 and rad/s^2."""

    ax_max: float
    ay_max: float
    alpha_max: float

    def describe(self) -> str:
        """Return what a line says of them."""
        sideways = f"{self.ay_max:g} m/s2 sideways, " if self.ay_max else ""
        return f"accelerations of {self.ax_max:g} m/s2, {sideways}{self.alpha_max:g} rad/s2"


def body_mismatch(name: str, training: Mapping[str, Any], robot: Robot) -> tuple[str, ...]:
    """Return a line where a card's ``training`` tells of another body than the robot's, and one where it tells of other
    accelerations; none where it does not tell.
    """
    body = _make_body(robot.footprint, robot.lidar.mount.x, robot.lidar.mount.y)
    limits = Accelerations(robot.limits.ax_max, robot.limits.ay_max, robot.limits.alpha_max)
    told = (_card_body(training), body), (_card_accelerations(training), limits)
    return tuple(
        f"{name}: trained with {then.describe()}, drives with {now.describe()}"
        for then, now in told
        if then is not None and not np.allclose(then, now, atol=SAME)
    )


def _card_body(training: Mapping[str, Any]) -> Body | None:
    """Return the body that a card tells of, None where it is not told, or not as ours are: it is for people to read."""
    try:
        robot = training["config"]["robot"]
        shape, mount = robot["footprint"], robot["lidar"]["mount"]
        footprint = (
            Footprint.polygon(shape["vertices_xy"]) if shape["radius"] is None else Footprint.circle(shape["radius"])
        )
        return _make_body(footprint, float(mount["x"]), float(mount["y"]))
    except (KeyError, TypeError, ValueError, ConfigurationError):
        return None


def _card_accelerations(training: Mapping[str, Any]) -> Accelerations | None:
    """Return the accelerations that a card tells of, None where it tells of none."""
    try:
        limits = training["config"]["robot"]["limits"]
        return Accelerations(*(float(limits[name]) for name in Accelerations._fields))
    except (KeyError, TypeError, ValueError):
        return None


def _make_body(footprint: Footprint, x: float, y: float) -> Body:
    return Body(footprint.radius, footprint.inscribed_radius, x, y)
