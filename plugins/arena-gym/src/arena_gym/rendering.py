"""What ``env.render()`` shows: the worlds of a batch, drawn by the suite's painter."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from arena_core import ConfigurationError
from arena_core.scenes import furniture_shapes
from arena_gym.batch import NavigationBatch
from arena_gym.episodes import Episode

if TYPE_CHECKING:
    from arena_drawing.frames import FramePainter, FrameWindow, SceneState

Frame = NDArray[np.uint8]
MODES = ("human", "rgb_array")


class Metadata:
    """What gymnasium asks of an environment: all render modes of its class, those that are
    possible on this machine of its objects.
    """

    def __get__(self, env: object | None, owner: type | None = None) -> dict[str, Any]:
        """Return the modes and the frames a second."""
        return {"render_modes": list(MODES if env is None else possible_modes()), "render_fps": 10}


def possible_modes() -> tuple[str, ...]:
    """Return the modes that work here: none without arena-viewer, and no window without a display."""
    try:
        from arena_drawing.frames import has_display
    except ImportError:
        return ()
    return MODES if has_display() else ("rgb_array",)


class Renderer:
    """Draws the worlds of a batch: ``rgb_array`` gives arrays (H, W, 3) of bytes, ``human``
    shows the first world in a window.
    """

    def __init__(self, batch: NavigationBatch, mode: str) -> None:
        if mode not in MODES:
            raise ConfigurationError(f"render_mode is {mode}; allowed: {', '.join(MODES)}, or none")
        try:
            import arena_drawing.frames  # noqa: F401 - an extra: say at once where it is missing
        except ImportError as error:
            raise ConfigurationError(
                f"render_mode is {mode}, which needs arena-viewer; allowed: arena-gym[render], or none"
            ) from error
        self.mode = mode
        self._batch = batch
        self._painters: dict[int, tuple[Episode, FramePainter]] = {}
        self._window = self._open_window() if mode == "human" else None

    def frame(self, slot: int) -> Frame:
        """Return the picture of one world now."""
        return self._frame_painter(slot).frame(self._frame_scene(slot))

    def show(self) -> None:
        """Show the first world, in mode ``human``."""
        if self._window is not None:
            self._window.show(self.frame(0))

    def close(self) -> None:
        """Close the window, if there is one."""
        if self._window is not None:
            self._window.close()

    def _open_window(self) -> FrameWindow:
        from arena_drawing.frames import FrameWindow

        return FrameWindow("arena", 1.0 / self._batch.parts.robot.control_period)

    def _frame_painter(self, slot: int) -> FramePainter:
        from arena_drawing.frames import FramePainter, StaticScene

        episode = self._batch.episodes[slot]
        known = self._painters.get(slot)
        if known is None or known[0] is not episode:
            scenario, path = episode.problem.scenario, episode.problem.path
            obstacles = [{"vertices_xy": one.vertices_xy, "radius": one.radius} for one in scenario.obstacles]
            obstacles += furniture_shapes(scenario.world.furniture)
            doors = [door.vertices_xy for door in scenario.doors]
            ends = scenario.start.array(), scenario.goal.array()
            stage = StaticScene(scenario.world.grid, obstacles, *ends, path, doors=doors)
            known = self._painters[slot] = (episode, FramePainter(stage, self._batch.parts.robot.footprint))
        return known[1]

    def _frame_scene(self, slot: int) -> SceneState:
        from arena_drawing.frames import SceneState

        now, lidar = self._batch.snapshot, self._batch.parts.robot.lidar
        people, pose = now.crowd.world(slot), now.poses[slot]
        angles = lidar.angle_min + lidar.angle_increment * np.arange(lidar.beams) + lidar.mount.theta
        seen = np.isfinite(now.ranges[slot])
        rays = now.ranges[slot][seen, None] * np.stack((np.cos(angles[seen]), np.sin(angles[seen])), axis=1)
        c, s = np.cos(pose[2]), np.sin(pose[2])
        returns = (rays + np.array((lidar.mount.x, lidar.mount.y))) @ np.array(((c, s), (-s, c))) + pose[:2]
        doors = now.state(slot).doors_open[: len(self._batch.episodes[slot].problem.scenario.doors)].tolist()
        return SceneState(pose, people.positions, people.radii, returns, float(now.stamps[slot]), doors_open=doors)
