"""The body that a policy was trained in, where it drives another one."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from arena_core import ConfigurationError, Footprint, Robot

SAME = 1e-3  # m


class Body(NamedTuple):
    """What a policy grows used to: the circles about and within the footprint, and where the
    lidar sits in ``base_link``, m.
    """

    radius: float
    inscribed_radius: float
    lidar_x: float
    lidar_y: float


def body_mismatch(name: str, training: Mapping[str, Any], robot: Robot) -> tuple[str, ...]:
    """Return a line where a card's ``training`` tells of another body than the robot's; none
    where it tells of no body.
    """
    then, now = _card_body(training), _make_body(robot.footprint, robot.lidar.mount.x, robot.lidar.mount.y)
    if then is None or np.allclose(then, now, atol=SAME):
        return ()
    return (f"{name}: trained with {_describe_body(then)}, drives with {_describe_body(now)}",)


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


def _make_body(footprint: Footprint, x: float, y: float) -> Body:
    return Body(footprint.radius, footprint.inscribed_radius, x, y)


def _describe_body(body: Body) -> str:
    return f"a footprint of radius {body.radius:.3f} m and the lidar at ({body.lidar_x:g}, {body.lidar_y:g})"
