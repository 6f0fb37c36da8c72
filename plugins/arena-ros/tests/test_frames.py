from __future__ import annotations

import math

import numpy as np
import pytest

from arena_core import LaserScan, Pose
from arena_ros import conversions as of
from arena_ros.codec import Codec, get_codec
from arena_ros.frames import BASES, Mount, find_mount

LEVEL = (0.0, 0.0, 0.0, 1.0)
ROLLED = (1.0, 0.0, 0.0, 0.0)  # half a turn about x
PITCHED = (0.0, 1.0, 0.0, 0.0)  # half a turn about y


def link(own: Codec, parent: str, child: str, xy: tuple[float, float], quaternion: tuple[float, ...]) -> object:
    x, y, z, w = quaternion
    return own.make(
        "geometry_msgs/msg/TransformStamped",
        header=own.header(0, parent),
        child_frame_id=child,
        transform=own.make(
            "geometry_msgs/msg/Transform",
            translation=of.vector_msg(own, *xy),
            rotation=own.make("geometry_msgs/msg/Quaternion", x=x, y=y, z=z, w=w),
        ),
    )


def found(*links: object) -> Mount:
    mount = find_mount(of.mounts_from_msg(get_codec(1).make(of.TF, transforms=list(links))), "laser", BASES)
    assert mount is not None
    return mount


def bearing_of_the_return(mount: Mount, increment: float = 0.5) -> float:
    """Return where in base_link the first beam of a scan points, at -1 rad of the laser."""
    own, ranges = get_codec(1), np.array([2.0, np.inf, np.inf, np.inf, np.inf], np.float32)
    message = of.scan_msg(own, LaserScan(0.0, -1.0, increment, 0.1, 30.0, ranges, Pose(0.0, 0.0)), 0, "laser", 0.1)
    scan = of.scan_from_msg(message, 0.0, mount)
    (beam,) = np.flatnonzero(np.isfinite(scan.ranges))
    assert scan.angle_increment > 0.0
    return scan.mount.theta + scan.angle_min + beam * scan.angle_increment


@pytest.mark.parametrize(
    ("quaternion", "bearing"),
    [
        (LEVEL, -1.0),
        (ROLLED, 1.0),  # what is on its right is on the robot's left
        (PITCHED, math.pi + 1.0),  # it looks backwards, too
        ((math.cos(0.15), math.sin(0.15), 0.0, 0.0), 1.3),  # rolled, then turned by 0.3
    ],
)
def test_beams_point_where_the_laser_does(quaternion: tuple[float, ...], bearing: float) -> None:
    mount = found(link(get_codec(1), "base_link", "laser", (0.2, 0.1), quaternion))
    assert math.remainder(bearing_of_the_return(mount) - bearing, math.tau) == pytest.approx(0.0, abs=1e-9)
    np.testing.assert_allclose(mount.pose.array()[:2], [0.2, 0.1])


def test_laser_on_a_plate_that_hangs_upside_down_is_upright_when_it_hangs_itself() -> None:
    own = get_codec(1)
    plate = link(own, "base_link", "plate", (0.0, 0.5), ROLLED)
    mount = found(plate, link(own, "plate", "laser", (0.2, 0.1), ROLLED))
    assert not mount.flipped
    # the plate's y axis points to the right
    np.testing.assert_allclose(mount.pose.array(), [0.2, 0.4, 0.0], atol=1e-12)
    assert bearing_of_the_return(mount) == pytest.approx(-1.0)


def test_laser_that_turns_clockwise_is_told_counterclockwise() -> None:
    assert bearing_of_the_return(Mount(Pose(0.0, 0.0)), -0.5) == pytest.approx(-1.0)
