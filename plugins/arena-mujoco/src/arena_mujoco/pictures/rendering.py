"""Draws moments of an episode as arrays of bytes, without a display."""

from __future__ import annotations

import math
import os
from collections.abc import Callable
from contextlib import suppress
from ctypes.util import find_library
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from arena_core import ConfigurationError, Pose, Robot
from arena_mujoco.body import Body
from arena_mujoco.pictures.appearance import Appearance, Colour
from arena_mujoco.pictures.scene import SceneModel
from arena_mujoco.pictures.scene_states import SceneState
from arena_mujoco.rays import Rays

Camera = Literal["follow", "top", "onboard"]
Frame = NDArray[np.uint8]
GEOMS = 20_000  # of one picture
DRAWN = 400  # points of a path or a trail, and beams, at the most
NO_DRIVER = (
    "no driver draws without a display ({}); allowed: Mesa's EGL or OSMesa, on Debian: "
    "apt install libegl1 libgl1-mesa-dri, or libosmesa6; "
    "simulating needs neither"
)


@dataclass(frozen=True, slots=True)
class SceneView:
    """What is drawn: from which camera, ``size`` (width, height) pixels, with the lidar's returns or without."""

    camera: Camera
    size: tuple[int, int]
    lidar: bool


class SceneRenderer:
    """Draws a stage; close it after use."""

    def __init__(self, stage: SceneModel, robot: Robot, body: Body, looks: Appearance, view: SceneView) -> None:
        self._context = _drawing_context(*view.size)
        import mujoco

        self._stage, self._looks, self._size, self._kind = stage, looks, view.size, view.camera
        self._rays = Rays(robot.lidar, body.lidar_height) if view.lidar else None
        self._robot, self._height = robot, body.lidar_height
        self._scene = mujoco.MjvScene(stage.model, GEOMS)
        self._scene.flags[mujoco.mjtRndFlag.mjRND_SHADOW] = 0
        self._options = mujoco.MjvOption()
        self._camera = mujoco.MjvCamera()
        self._drawing = mujoco.MjrContext(stage.model, mujoco.mjtFontScale.mjFONTSCALE_100)
        mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN, self._drawing)
        if view.camera == "onboard":
            self._camera.type = mujoco.mjtCamera.mjCAMERA_FIXED
            self._camera.fixedcamid = stage.model.camera("onboard").id

    def close(self) -> None:
        """Give the driver back what it holds."""
        self._drawing.free()
        self._context.free()

    def render(self, still: SceneState, title: str, window: tuple[float, float, float, float]) -> Frame:
        """Return a moment as an array (height, width, 3); ``window`` is what a camera above
        shows: left, right, bottom, top, m.
        """
        import mujoco

        self._stage.set_state(still)
        self._aim_camera(still, window)
        model, data = self._stage.model, self._stage.data
        mujoco.mjv_updateScene(model, data, self._options, None, self._camera, mujoco.mjtCatBit.mjCAT_ALL, self._scene)
        self._add_line(still.path, self._looks.path, 0.02)
        self._add_line(still.trail, self._looks.trail, 0.03)
        if self._rays is not None:
            self._add_returns(still, self._rays)
        view = mujoco.MjrRect(0, 0, *self._size)
        mujoco.mjr_render(view, self._scene, self._drawing)
        place, font = mujoco.mjtGridPos.mjGRID_TOPLEFT, mujoco.mjtFont.mjFONT_NORMAL
        mujoco.mjr_overlay(font, place, view, title, "", self._drawing)
        frame = np.empty((self._size[1], self._size[0], 3), np.uint8)
        mujoco.mjr_readPixels(frame, None, view, self._drawing)
        return frame[::-1]

    def _aim_camera(self, still: SceneState, window: tuple[float, float, float, float]) -> None:
        camera, follow = self._camera, self._looks.follow
        if self._kind == "follow":
            camera.lookat[:] = still.pose[0], still.pose[1], 0.3
            camera.distance, camera.elevation, camera.azimuth = (
                follow.distance,
                follow.elevation,
                math.degrees(still.heading),
            )
        elif self._kind == "top":
            left, right, bottom, top = window
            width, height = right - left, top - bottom
            camera.lookat[:] = 0.5 * (left + right), 0.5 * (bottom + top), 0.0
            tall = max(height, width * self._size[1] / self._size[0])
            camera.distance = 0.5 * tall / math.tan(math.radians(22.5)) + self._looks.wall_height
            camera.elevation, camera.azimuth = -90.0, 90.0

    def _add_line(self, points: NDArray[np.float64], colour: Colour, height: float) -> None:
        """Add a line through points (K, 2), as capsules at ``height`` m."""
        import mujoco

        thinned = points[:: max(1, len(points) // DRAWN)]
        kind = mujoco.mjtGeom.mjGEOM_CAPSULE
        for begin, end in pairwise(thinned):
            geom = self._next_geom(kind, np.zeros(3), np.zeros(3), colour)
            if geom is not None:
                mujoco.mjv_connector(geom, kind, self._looks.line, np.append(begin, height), np.append(end, height))

    def _add_returns(self, still: SceneState, rays: Rays) -> None:
        """Add a dot where each beam ends: of the scan that was kept, or of one without noise."""
        import mujoco

        lidar = self._robot.lidar
        ranges = still.scan
        if ranges is None or len(ranges) != lidar.beams:
            ranges = np.zeros(lidar.beams, np.float32)
            rays.cast_rays(self._stage.model, self._stage.data, ranges)
        mount = Pose.of(still.pose).compose(lidar.mount)
        angles = mount.theta + lidar.angles()
        reach = ranges * np.cos(angles), ranges * np.sin(angles)
        ends = np.column_stack((mount.x + reach[0], mount.y + reach[1], np.full(len(angles), self._height)))
        kept = ends[np.isfinite(ranges)]
        size = np.full(3, self._looks.dot)
        for end in kept[:: max(1, len(kept) // DRAWN)]:
            self._next_geom(mujoco.mjtGeom.mjGEOM_BOX, size, end, self._looks.returns)

    def _next_geom(self, kind: Any, size: NDArray[np.float64], place: NDArray[np.float64], colour: Colour) -> Any:
        import mujoco

        scene = self._scene
        if scene.ngeom >= scene.maxgeom:
            return None
        geom = scene.geoms[scene.ngeom]
        mujoco.mjv_initGeom(geom, kind, size, place, np.eye(3).ravel(), np.asarray(colour, np.float32))
        scene.ngeom += 1
        return geom


def _drawing_context(width: int, height: int) -> Any:
    """Return a context of OpenGL that is current, as MUJOCO_GL asks or as it can be had; raise ConfigurationError."""
    asked = os.environ.get("MUJOCO_GL", "").lower()
    found = asked if asked in ("egl", "osmesa") else "egl" if find_library("EGL") else "osmesa"
    try:
        context = _context_makers()[found](width, height)
        context.make_current()
    except Exception as error:  # PyOpenGL raises what a missing library leads it to, AttributeError among it
        raise ConfigurationError(NO_DRIVER.format(f"{found}: {type(error).__name__}")) from None
    return context


def _context_makers() -> dict[str, Callable[[int, int], Any]]:
    def egl(width: int, height: int) -> Any:
        from mujoco.egl import GLContext

        return GLContext(width, height)

    def osmesa(width: int, height: int) -> Any:
        with suppress(KeyError):
            del os.environ["PYOPENGL_PLATFORM"]
        from mujoco.osmesa import GLContext

        return GLContext(width, height)

    return {"egl": egl, "osmesa": osmesa}
