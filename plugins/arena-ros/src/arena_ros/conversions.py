"""Values of the suite as messages of ROS and back; frames after REP-103 and REP-105."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from arena_core import (
    FREE,
    INSCRIBED,
    LETHAL,
    OCCUPIED,
    Costmap,
    LaserScan,
    OccupancyGrid,
    Odometry,
    Pose,
    Twist,
    wrap_angle,
)
from arena_ros.codec import PEOPLE, Codec, stamp_of
from arena_ros.frames import Mount

SCAN = "sensor_msgs/msg/LaserScan"
ODOMETRY = "nav_msgs/msg/Odometry"
TWIST = "geometry_msgs/msg/Twist"
TWIST_STAMPED = "geometry_msgs/msg/TwistStamped"
POSE_STAMPED = "geometry_msgs/msg/PoseStamped"
POSE_COVARIANCE = "geometry_msgs/msg/PoseWithCovarianceStamped"
POSES = "geometry_msgs/msg/PoseArray"
PATH = "nav_msgs/msg/Path"
GRID = "nav_msgs/msg/OccupancyGrid"
TF = "tf2_msgs/msg/TFMessage"
CLOCK = "rosgraph_msgs/msg/Clock"
TEXT = "std_msgs/msg/String"
NUMBERS = "std_msgs/msg/Float64MultiArray"
MARKERS = "visualization_msgs/msg/MarkerArray"
EMPTY = "std_msgs/msg/Empty"
PLANE = (0, 1, 5)  # x, y and yaw among the six of a covariance of ROS
FLOAT = np.float64


def point_msg(codec: Codec, x: float, y: float, z: float = 0.0) -> Any:
    """Return a point, m."""
    return codec.make("geometry_msgs/msg/Point", x=float(x), y=float(y), z=float(z))


def vector_msg(codec: Codec, x: float, y: float, z: float = 0.0) -> Any:
    """Return a vector."""
    return codec.make("geometry_msgs/msg/Vector3", x=float(x), y=float(y), z=float(z))


def quaternion_msg(codec: Codec, theta: float) -> Any:
    """Return a turn about z as a quaternion."""
    return codec.make("geometry_msgs/msg/Quaternion", x=0.0, y=0.0, z=math.sin(theta / 2.0), w=math.cos(theta / 2.0))


def pose_msg(codec: Codec, value: Pose) -> Any:
    """Return a pose."""
    return codec.make(
        "geometry_msgs/msg/Pose",
        position=point_msg(codec, value.x, value.y),
        orientation=quaternion_msg(codec, value.theta),
    )


def pose_from_msg(message: Any) -> Pose:
    """Return the pose in the plane of a message with ``position`` and ``orientation``."""
    return Pose(float(message.position.x), float(message.position.y), yaw_from_msg(message.orientation))


def yaw_from_msg(q: Any) -> float:
    """Return the turn about z of a quaternion; one of length 0, which some nodes send for "none", is no turn."""
    return math.atan2(2.0 * (q.w * q.z + q.x * q.y), q.w * q.w + q.x * q.x - q.y * q.y - q.z * q.z)


def twist_msg(codec: Codec, value: Twist) -> Any:
    """Return a velocity."""
    return codec.make(
        TWIST, linear=vector_msg(codec, value.vx, value.vy), angular=vector_msg(codec, 0.0, 0.0, value.wz)
    )


def twist_from_msg(message: Any) -> Twist:
    """Return the velocity in the plane of a Twist or a TwistStamped."""
    message = getattr(message, "twist", message)
    return Twist(float(message.linear.x), float(message.linear.y), float(message.angular.z))


def pose_stamped_msg(codec: Codec, value: Pose, stamp: int, frame: str) -> Any:
    """Return a pose with a stamp."""
    return codec.make(POSE_STAMPED, header=codec.header(stamp, frame), pose=pose_msg(codec, value))


def pose_covariance_msg(codec: Codec, value: Pose, covariance: NDArray[Any], stamp: int, frame: str) -> Any:
    """Return a pose with its covariance (3, 3) over x, y, theta."""
    spread = codec.make(
        "geometry_msgs/msg/PoseWithCovariance", pose=pose_msg(codec, value), covariance=ros_covariance(covariance)
    )
    return codec.make(POSE_COVARIANCE, header=codec.header(stamp, frame), pose=spread)


def ros_covariance(covariance: NDArray[Any]) -> NDArray[np.float64]:
    """Return a covariance (3, 3) in the layout of ROS, (36,)."""
    six = np.zeros((6, 6))
    six[np.ix_(PLANE, PLANE)] = covariance
    return six.ravel()


def planar_covariance(spread: NDArray[Any]) -> NDArray[np.float64]:
    """Return the part (3, 3) over x, y, theta of a covariance of ROS."""
    return np.asarray(spread, FLOAT).reshape(6, 6)[np.ix_(PLANE, PLANE)]


class Header(NamedTuple):
    """When a message is from, ns, and the frame it is in."""

    stamp: int
    frame: str


def odometry_msg(codec: Codec, value: Pose, velocity: Twist, header: Header, child: str) -> Any:
    """Return odometry: a pose in the header's frame, a velocity in ``child``."""
    none = np.zeros(36)
    where = codec.make("geometry_msgs/msg/PoseWithCovariance", pose=pose_msg(codec, value), covariance=none)
    how = codec.make("geometry_msgs/msg/TwistWithCovariance", twist=twist_msg(codec, velocity), covariance=none)
    return codec.make(
        ODOMETRY, header=codec.header(header.stamp, header.frame), child_frame_id=child, pose=where, twist=how
    )


def odometry_from_msg(message: Any, stamp: float) -> Odometry:
    """Return odometry with a stamp of s."""
    return Odometry(stamp, pose_from_msg(message.pose.pose), twist_from_msg(message.twist.twist))


def scan_msg(codec: Codec, value: LaserScan, stamp: int, frame: str, period: float) -> Any:
    """Return a scan; ``period`` s is the time between two."""
    last = value.angle_min + value.angle_increment * (len(value.ranges) - 1)
    return codec.make(
        SCAN,
        header=codec.header(stamp, frame),
        angle_min=value.angle_min,
        angle_max=last,
        angle_increment=value.angle_increment,
        time_increment=0.0,
        scan_time=period,
        range_min=value.range_min,
        range_max=value.range_max,
        ranges=np.asarray(value.ranges, np.float32),
        intensities=np.empty(0, np.float32),
    )


def scan_from_msg(message: Any, stamp: float, mount: Mount) -> LaserScan:
    """Return a scan as planners take it, after REP-117: +inf where nothing was hit, NaN and what is too near as they
    count there.

    What is below ``range_min`` or no number is an error of measurement and counts as nothing hit, as in costmap_2d; 0,
    which many drivers send for "nothing", likewise. Beams are told counterclockwise as seen from above, also of a laser
    that hangs upside down or turns clockwise.
    """
    ranges = np.array(message.ranges, np.float32)
    with np.errstate(invalid="ignore"):
        ranges[~((ranges >= message.range_min) & (ranges <= message.range_max))] = np.inf
    first, step = float(message.angle_min), float(message.angle_increment)
    if mount.flipped:
        first, step = -first, -step
    if step < 0.0:
        first, step, ranges = first + step * (len(ranges) - 1), -step, ranges[::-1].copy()
    return LaserScan(stamp, first, step, float(message.range_min), float(message.range_max), ranges, mount.pose)


def path_msg(codec: Codec, poses: NDArray[Any], stamp: int, frame: str) -> Any:
    """Return a path of poses (M, 3)."""
    header = codec.header(stamp, frame)
    stamped = [codec.make(POSE_STAMPED, header=header, pose=pose_msg(codec, Pose.of(row))) for row in poses]
    return codec.make(PATH, header=header, poses=stamped)


def path_from_msg(message: Any) -> NDArray[np.float64]:
    """Return the poses (M, 3) of a path."""
    return np.array([pose_from_msg(each.pose).array() for each in message.poses]).reshape(-1, 3)


def grid_msg(codec: Codec, value: OccupancyGrid, stamp: int, frame: str) -> Any:
    """Return a map."""
    rows, columns = value.data.shape
    info = codec.make(
        "nav_msgs/msg/MapMetaData",
        map_load_time=codec.time(stamp),
        resolution=value.resolution,
        width=columns,
        height=rows,
        origin=pose_msg(codec, value.origin),
    )
    return codec.make(GRID, header=codec.header(stamp, frame), info=info, data=value.data.ravel())


def grid_from_msg(message: Any) -> OccupancyGrid:
    """Return a map; values outside -1 .. 100 count as unknown.

    Resolutions, float32 on the wire, are taken to a micrometre.
    """
    data = np.asarray(message.data, np.int8).reshape(message.info.height, message.info.width)
    data = np.where((data >= FREE) & (data <= OCCUPIED), data, -1).astype(np.int8)
    return OccupancyGrid(data, round(float(message.info.resolution), 6), pose_from_msg(message.info.origin))


def costmap_msg(codec: Codec, value: Costmap, stamp: int, frame: str) -> Any:
    """Return a cost grid as nav_msgs have it: 100 lethal, 99 inscribed, below that in proportion (as
    costmap_2d publishes it).
    """
    costs = np.rint(value.costs.astype(np.float64) * 98.0 / (INSCRIBED - 1)).astype(np.int8)
    costs[value.costs == INSCRIBED] = 99
    costs[value.costs >= LETHAL] = 100
    left, below = value.origin_xy.tolist()
    return grid_msg(codec, OccupancyGrid(costs, value.resolution, Pose(left, below)), stamp, frame)


def transforms_msg(codec: Codec, links: Iterable[tuple[str, str, Pose]], stamp: int) -> Any:
    """Return transforms, each a frame, its child, and the child's pose in it."""
    made = [
        codec.make(
            "geometry_msgs/msg/TransformStamped",
            header=codec.header(stamp, frame),
            child_frame_id=child,
            transform=codec.make(
                "geometry_msgs/msg/Transform",
                translation=vector_msg(codec, value.x, value.y),
                rotation=quaternion_msg(codec, value.theta),
            ),
        )
        for frame, child, value in links
    ]
    return codec.make(TF, transforms=made)


def links_from_msg(message: Any) -> list[tuple[str, str, Pose, int]]:
    """Return the transforms of a message: frame, child, pose, stamp in ns; old names' leading slash is dropped."""
    return [
        (
            each.header.frame_id.lstrip("/"),
            each.child_frame_id.lstrip("/"),
            Pose(each.transform.translation.x, each.transform.translation.y, yaw_from_msg(each.transform.rotation)),
            stamp_of(each.header.stamp),
        )
        for each in message.transforms
    ]


def mounts_from_msg(message: Any) -> dict[str, tuple[str, Mount]]:
    """Return the links of a message by child frame, with the side on which each lies."""
    flipped = [is_flipped(each.transform.rotation) for each in message.transforms]
    return {
        child: (parent, Mount(pose, over))
        for (parent, child, pose, _), over in zip(links_from_msg(message), flipped, strict=True)
    }


def is_flipped(q: Any) -> bool:
    """Return whether a quaternion turns the z axis downwards."""
    return bool(q.w * q.w + q.z * q.z < q.x * q.x + q.y * q.y)


def people_msg(
    codec: Codec, ids: Sequence[int], positions: NDArray[Any], velocities: NDArray[Any], header: Header
) -> Any:
    """Return people, each named by its number; who is at NaN is not there."""
    there = np.isfinite(positions).all(axis=1)
    made = [
        codec.make(
            "people_msgs/msg/Person",
            name=str(int(ids[k])),
            position=point_msg(codec, *positions[k]),
            velocity=point_msg(codec, *velocities[k]),
            reliability=1.0,
            tagnames=[],
            tags=[],
        )
        for k in np.flatnonzero(there).tolist()
    ]
    return codec.make(PEOPLE, header=codec.header(header.stamp, header.frame), people=made)


def markers_msg(codec: Codec, ids: Sequence[int], positions: NDArray[Any], radii: NDArray[Any], header: Header) -> Any:
    """Return people as cylinders that RViz and Foxglove show; who is not there is taken away."""
    colour = codec.make("std_msgs/msg/ColorRGBA", r=0.1, g=0.4, b=0.8, a=0.9)
    extra: dict[str, Any] = {
        "points": [],
        "colors": [],
        "text": "",
        "mesh_resource": "",
        "mesh_use_embedded_materials": False,
    }
    if codec.ros == 2:
        extra["texture_resource"] = ""
        extra["texture"] = codec.make(
            "sensor_msgs/msg/CompressedImage", header=codec.header(0, ""), format="", data=np.empty(0, np.uint8)
        )
        extra["uv_coordinates"] = []
        extra["mesh_file"] = codec.make("visualization_msgs/msg/MeshFile", filename="", data=np.empty(0, np.uint8))
    made = []
    for k, there in enumerate(np.isfinite(positions).all(axis=1)):
        x, y = positions[k] if there else (0.0, 0.0)
        where = codec.make(
            "geometry_msgs/msg/Pose", position=point_msg(codec, x, y, 0.85), orientation=quaternion_msg(codec, 0.0)
        )
        size = vector_msg(codec, 2.0 * radii[k], 2.0 * radii[k], 1.7)  # m, as tall as people are
        life = codec.make("builtin_interfaces/msg/Duration", sec=0, nanosec=0)
        made.append(
            codec.make(
                "visualization_msgs/msg/Marker",
                header=codec.header(header.stamp, header.frame),
                ns="people",
                id=int(ids[k]),
                type=3,  # CYLINDER
                action=0 if there else 2,  # ADD, DELETE
                pose=where,
                scale=size,
                color=colour,
                lifetime=life,
                frame_locked=False,
                **extra,
            )
        )
    return codec.make(MARKERS, markers=made)


def numbers_msg(codec: Codec, values: Sequence[float]) -> Any:
    """Return some numbers."""
    layout = codec.make("std_msgs/msg/MultiArrayLayout", dim=[], data_offset=0)
    return codec.make(NUMBERS, layout=layout, data=np.asarray(values, FLOAT))


def text_msg(codec: Codec, value: str) -> Any:
    """Return a text."""
    return codec.make(TEXT, data=value)


def unwrap_angles(angles: NDArray[Any]) -> NDArray[np.float64]:
    """Return angles without jumps of a whole turn, to interpolate between them."""
    return np.unwrap(np.asarray(angles, FLOAT))


def interpolate_poses(stamps: NDArray[Any], known: NDArray[Any], poses: NDArray[Any]) -> NDArray[np.float64]:
    """Return poses (T, 3) at ``stamps`` between poses (K, 3) at ``known``, the first and last held beyond."""
    columns = [np.interp(stamps, known, poses[:, 0]), np.interp(stamps, known, poses[:, 1])]
    return np.stack([*columns, wrap_angle(np.interp(stamps, known, unwrap_angles(poses[:, 2])))], axis=1)
