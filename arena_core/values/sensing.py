"""What a robot measures and what it concludes; field names follow ROS sensor_msgs and nav_msgs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from arena_core.values.geometry import FloatArray, Pose, Twist
from arena_core.values.messages import Message
from arena_core.values.predictions import Predictions
from arena_core.values.world import Costmap, OccupancyGrid, Path


@dataclass(frozen=True, slots=True, eq=False)
class LaserScan:
    """One scan with its own stamp (s); ``ranges`` (B,) float32 m, +inf where nothing was hit within ``range_max``
    (REP-117).

    Angles are in the sensor's frame, beam i at ``angle_min + i * angle_increment``; ``mount`` is that frame in
    ``base_link``.
    """

    stamp: float
    angle_min: float
    angle_increment: float
    range_min: float
    range_max: float
    ranges: NDArray[np.float32]
    mount: Pose


@dataclass(frozen=True, slots=True, eq=False)
class DepthImage:
    """One image of a depth camera with its own stamp (s): ``depths`` (H, W) float32 m along its axis, row 0 on top,
    +inf without a return.

    A pinhole in the middle of the image has ``focal`` pixels to it, with square pixels. Its axis points forwards in
    ``mount``, a pose in ``base_link``, from ``height`` m above the floor, ``pitch`` rad downwards. Returns lie between
    ``range_min`` and ``range_max``, m.
    """

    stamp: float
    depths: NDArray[np.float32]
    focal: float
    mount: Pose
    height: float
    pitch: float
    range_min: float
    range_max: float

    def points(self) -> FloatArray:
        """Return where each pixel's return is, (H, W, 3): x and y in ``base_link``, z above the floor, m;
        infinite without a return.
        """
        rays = camera_rays(self.depths.shape[0], self.depths.shape[1], self.focal, self.pitch, self.mount.theta)
        with np.errstate(invalid="ignore"):  # a level ray without a return
            away = np.where(np.isfinite(self.depths)[..., None], self.depths[..., None] * rays, np.inf)
        return np.asarray(away + np.array((self.mount.x, self.mount.y, self.height)))


def camera_rays(rows: int, columns: int, focal: float, pitch: float, yaw: float) -> FloatArray:
    """Return the way from a camera to each pixel's return at depth 1 m, (H, W, 3): x forwards, y to the
    left, z up, turned by ``yaw``.
    """
    right = (np.arange(columns) + 0.5 - 0.5 * columns) / focal
    down = (np.arange(rows) + 0.5 - 0.5 * rows)[:, None] / focal
    ahead, up = np.cos(pitch) - np.sin(pitch) * down, -np.sin(pitch) - np.cos(pitch) * down
    x, y, z = np.broadcast_arrays(ahead, -right, up)
    return np.stack((np.cos(yaw) * x - np.sin(yaw) * y, np.sin(yaw) * x + np.cos(yaw) * y, z), axis=-1)


@dataclass(frozen=True, slots=True)
class Odometry:
    """Wheel odometry: ``pose`` in ``odom`` (drifts), ``twist`` in ``base_link``, ``stamp`` in s."""

    stamp: float
    pose: Pose
    twist: Twist


@dataclass(frozen=True, slots=True)
class Sensors:
    """All that leaves the robot's hardware at one control step.

    ``reference`` is the pose of an external positioning system (in simulation: exact); only the ``ground_truth``
    localiser reads it, and planners never see it. ``depth`` is that of a depth camera; None where the robot has none.
    ``goal`` is where the robot is told to be now, in ``map``, by a task whose goal moves; None in all others. ``heard``
    is the newest message of each teammate that the robot has heard of.
    """

    stamp: float
    scan: LaserScan
    odometry: Odometry
    reference: Pose | None = None
    depth: DepthImage | None = None
    goal: Pose | None = None
    heard: tuple[Message, ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class PoseEstimate:
    """A pose in ``map`` with its covariance (3, 3) over x, y, theta (m^2, m rad, rad^2)."""

    pose: Pose
    covariance: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class Tracks:
    """Moving obstacles that the robot believes in, in ``map``.

    ids (K,), positions (K, 2) m, velocities (K, 2) m/s, radii (K,) m, covariances (K, 4, 4) over x, y, vx, vy.
    """

    ids: NDArray[np.int32]
    positions: FloatArray
    velocities: FloatArray
    radii: FloatArray
    covariances: FloatArray


NO_TRACKS = Tracks(np.empty(0, np.int32), np.empty((0, 2)), np.empty((0, 2)), np.empty(0), np.empty((0, 4, 4)))


@dataclass(frozen=True, slots=True, eq=False)
class Observation:
    """All that a planner may see at one control step. It belongs to the planner, and cannot be written to.

    Attributes:

    - ``stamp``: s since the episode began.
    - ``pose``: the localiser's estimate in ``map``, with its ``covariance`` (3, 3) over x, y, theta.
    - ``twist``: the measured velocity, in ``base_link``.
    - ``scan``: the newest scan, with its own stamp.
    - ``goal``, ``waypoint``: in ``map``; the waypoint is the local goal ahead on the path.
    - ``path``: the global path in ``map``.
    - ``map``: the static map, None in an unknown world.
    - ``local_map``, ``tracks``: the costmap around the robot and the moving obstacles, in ``map``; computed when first
      asked for, so that a planner pays for what it uses.
    - ``depth``: the newest image of a depth camera, None where the robot has none.
    - ``predictions``: where each of the ``tracks`` will be, as the predictor expects it; computed when first asked for,
      too. Without a predictor everybody keeps their velocity.
    - ``heard``: the newest message of each teammate that was heard of, told ``stamp - message.stamp`` s ago; their
      senders are among the ``tracks``.

    ```python
    def nearest_return(observation: Observation) -> float:
        return float(observation.scan.ranges.min(initial=np.inf))  # m
    ```
    """

    stamp: float
    pose: Pose
    covariance: FloatArray
    twist: Twist
    scan: LaserScan
    goal: Pose
    waypoint: Pose
    path: Path
    map: OccupancyGrid | None
    _local_map: Callable[[], Costmap] = field(repr=False)
    _tracks: Callable[[], Tracks] = field(repr=False)
    depth: DepthImage | None = None
    _predictions: Callable[[], Predictions] | None = field(default=None, repr=False)
    heard: tuple[Message, ...] = ()

    @property
    def local_map(self) -> Costmap:
        """Return the rolling costmap around the robot."""
        return self._local_map()

    @property
    def tracks(self) -> Tracks:
        """Return the moving obstacles that the tracker believes in."""
        return self._tracks()

    @property
    def predictions(self) -> Predictions:
        """Return where the tracks will be."""
        return straight_predictions(self.tracks) if self._predictions is None else self._predictions()


def straight_predictions(tracks: Tracks) -> Predictions:
    """Return what is expected of tracks that keep their velocity."""
    return Predictions.straight(tracks.positions, tracks.velocities, tracks.covariances)
