"""A depth camera on the robot, by MuJoCo's rays: against every solid, people and the floor, from where the
robot is and as it leans.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated

import numpy as np
from numpy.typing import NDArray

from arena_core import ConfigurationError, DepthImage, Pose, Robot
from arena_core.parameters import Bounds, NonNegative, Positive
from arena_core.scenes import camera_rays
from arena_kernels.compiled import borrowing
from arena_kernels.random import fill_normals
from arena_mujoco.body import Body

if TYPE_CHECKING:
    import mujoco

SEEN = np.array((1, 0, 0, 0, 1, 0), np.uint8)  # of the groups of geoms: what lidars see, and what cameras alone do
Pixels = Annotated[int, Bounds(low=1, high=640)]


@dataclass(frozen=True, slots=True)
class CameraFigures:
    """A depth camera as mujoco.yaml has it; ``x`` and ``height`` None: at the front of the
    footprint, as high as the lidar.
    """

    enabled: bool
    columns: Pixels
    rows: Pixels
    field_of_view: Annotated[float, Bounds(low=0.1, high=3.0)]
    range_min: NonNegative
    range_max: Positive
    period: Positive
    x: float | None
    height: Positive | None
    pitch: Annotated[float, Bounds(low=-1.5, high=1.5)]
    noise: NonNegative


class DepthCamera:
    """Takes images of ``header``'s kind every ``period`` ticks."""

    def __init__(self, figures: CameraFigures, robot: Robot, body: Body, inner_step: float) -> None:
        self.period = round(figures.period / inner_step)
        if self.period < 1 or abs(self.period * inner_step - figures.period) > 1e-9:
            raise ConfigurationError(
                f"simulator.depth_camera.period is {figures.period:g} s; allowed: "
                f"a multiple of simulator.inner_step ({inner_step:g} s)"
            )
        if figures.range_min >= figures.range_max:
            low, high = figures.range_min, figures.range_max
            raise ConfigurationError(f"simulator.depth_camera.range_min is {low:g}; allowed: below range_max, {high:g}")
        footprint = robot.footprint
        front = footprint.radius if footprint.is_circle else float(footprint.vertices_xy[:, 0].max())
        x, height = front if figures.x is None else figures.x, figures.height or body.lidar_height
        focal = 0.5 * figures.columns / np.tan(0.5 * figures.field_of_view)
        self.shape = figures.rows, figures.columns
        empty = np.empty((0, 0), np.float32)
        ranges = figures.range_min, figures.range_max
        self.header = DepthImage(0.0, empty, float(focal), Pose(x, 0.0), height, figures.pitch, *ranges)
        rays = camera_rays(*self.shape, float(focal), figures.pitch, 0.0).reshape(-1, 3)
        lengths = np.linalg.norm(rays, axis=1)
        self._directions, self._depths, self._origin = (
            rays / lengths[:, None],
            1.0 / lengths,
            np.array((x, 0.0, height)),
        )
        self._farthest = figures.range_max * float(lengths.max())
        self._noise, self._normals = figures.noise, np.zeros(len(rays))
        self._geoms, self._distances = np.zeros(len(rays), np.int32), np.zeros(len(rays))

    def take_image(
        self, model: mujoco.MjModel, data: mujoco.MjData, key: np.uint64, tick: int, image: NDArray[np.float32]
    ) -> None:
        """Fill ``image`` (H, W): +inf where a pixel has no return in range.

        Noise is drawn from ``key`` and ``tick``.
        """
        import mujoco

        mujoco.mj_kinematics(model, data)
        robot = data.body("robot")
        turn = robot.xmat.reshape(3, 3)
        origin, beams = robot.xpos + turn @ self._origin, (self._directions @ turn.T).ravel()
        sizes = len(self._geoms), self._farthest
        mujoco.mj_multiRay(model, data, origin, beams, SEEN, 1, robot.id, self._geoms, self._distances, None, *sizes)
        head = self.header
        _write_depths(
            self._distances,
            self._depths,
            key,
            tick,
            self._noise,
            self._normals,
            head.range_min,
            head.range_max,
            image.reshape(-1),
        )


@borrowing
def _write_depths(
    distances: NDArray[np.float64],
    depths: NDArray[np.float64],
    key: np.uint64,
    tick: int,
    noise: float,
    drawn: NDArray[np.float64],
    range_min: float,
    range_max: float,
    image: NDArray[np.float32],
) -> None:
    """Turn distances into depths, with noise that grows with their square; -1 is a miss."""
    if noise > 0.0:
        fill_normals(key, tick, drawn)
    for i in range(len(image)):
        depth = distances[i] * depths[i]
        if distances[i] < 0.0 or depth < range_min or depth > range_max:
            image[i] = np.inf
        else:
            image[i] = depth + noise * depth * depth * drawn[i]
