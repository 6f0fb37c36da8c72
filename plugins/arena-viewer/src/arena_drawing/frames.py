"""One picture after the other of one episode: the map is drawn once, what moves is drawn again."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import PatchCollection
from matplotlib.figure import Figure
from matplotlib.patches import Circle
from numpy.typing import ArrayLike, NDArray

from arena_core import ArenaError, Footprint, OccupancyGrid, Path
from arena_drawing.painter import (
    INK,
    PATH,
    PERSON,
    TEAM,
    body_patch,
    contact_marks,
    door_patches,
    draw_goal,
    draw_map,
    draw_obstacles,
    draw_start,
    frame_axes,
    move_patch,
    path_line,
    show_doors,
)

FloatArray = NDArray[np.float64]
Frame = NDArray[np.uint8]
SIDE = 480  # pixels of a frame's longer side
SHORTEST = 160  # pixels of its shorter side
MARGIN = 0.5  # m around the map's free cells
RETURNS = "#CC79A7"
PLATES = {
    (0.02, 0.02): ("left", "bottom"),
    (0.98, 0.02): ("right", "bottom"),
    (0.02, 0.98): ("left", "top"),
    (0.98, 0.98): ("right", "top"),
}
Window = tuple[float, float, float, float]  # x from, to, y from, to, m


def _no_points() -> FloatArray:
    return np.empty((0, 2))


@dataclass(frozen=True, slots=True, eq=False)
class StaticScene:
    """What does not move in an episode: the map, obstacles as records have them, start and goal (3,), and the path that
    was planned.

    ``window`` is what is shown of it, all free cells where it is None. ``doors`` are the outlines (V, 2) of closed
    ones, ``mates`` the teammates, each an outline and a goal (2,).
    """

    grid: OccupancyGrid
    obstacles: Sequence[Mapping[str, Any]]
    start: FloatArray
    goal: FloatArray
    path: Path | None
    window: Window | None = None
    doors: Sequence[ArrayLike] = ()
    mates: Sequence[tuple[Footprint, FloatArray]] = ()


@dataclass(frozen=True, slots=True, eq=False)
class SceneState:
    """What moves, in ``map``: the robot's pose (3,), people's positions (P, 2) and radii (P,), NaN where absent, a
    scan's returns (R, 2).

    ``stamp`` is in s, ``title`` stands before it. ``driven`` (K, 2) is the way until now, ``contacts`` (C, 2) where it
    touched something. ``doors_open`` says of each door whether it is, ``mates`` (K, M, 3) where the M teammates were
    until now.
    """

    pose: FloatArray
    positions: FloatArray
    radii: FloatArray
    returns: FloatArray
    stamp: float
    driven: FloatArray = field(default_factory=_no_points)
    contacts: FloatArray = field(default_factory=_no_points)
    title: str = ""
    doors_open: Sequence[bool] = ()
    mates: FloatArray = field(default_factory=lambda: np.empty((1, 0, 3)))


class FramePainter:
    """Draws the scenes of one episode as arrays (H, W, 3) of bytes; a robot shorter than ``least`` pixels
    is drawn as long as that.
    """

    def __init__(self, stage: StaticScene, footprint: Footprint, side: int = SIDE, least: int = 0) -> None:
        window = stage.window or free_window(stage.grid)
        scale = side / max(window[1] - window[0], window[3] - window[2])
        size = [max(SHORTEST, round(scale * length)) for length in (window[1] - window[0], window[3] - window[2])]
        window = _fill_window(window, size, scale)
        self._figure = Figure(figsize=(size[0] / 100.0, size[1] / 100.0), dpi=100)
        self._canvas = FigureCanvasAgg(self._figure)
        self._axes = self._figure.add_axes((0.0, 0.0, 1.0, 1.0))
        frame_axes(self._axes, window)
        draw_map(self._axes, stage.grid.data, stage.grid.resolution, stage.grid.origin.array())
        draw_obstacles(self._axes, stage.obstacles)
        draw_start(self._axes, stage.start[0], stage.start[1])
        draw_goal(self._axes, stage.goal[0], stage.goal[1])
        colours = [TEAM[number % len(TEAM)] for number in range(len(stage.mates))]
        for (_, goal), colour in zip(stage.mates, colours, strict=True):
            draw_goal(self._axes, goal[0], goal[1], colour=colour)
        if stage.path is not None:
            self._axes.plot(*stage.path.poses[:, :2].T, "--", color=PATH, linewidth=1.0, zorder=2)
        self._canvas.draw()  # type: ignore[no-untyped-call]
        self._still = self._canvas.copy_from_bbox(self._figure.bbox)  # type: ignore[no-untyped-call]
        self._doors = door_patches(self._axes, stage.doors)
        larger = max(1.0, least / (2.0 * footprint.radius * scale))
        self._robot = body_patch(larger * footprint.vertices_xy, larger * footprint.radius)
        self._axes.add_patch(self._robot)
        bodies = [(body.vertices_xy, body.radius) for body, _ in stage.mates]
        self._mates = [
            body_patch(larger * vertices, larger * radius, colour, zorder=4.5)
            for (vertices, radius), colour in zip(bodies, colours, strict=True)
        ]
        for mate in self._mates:
            self._axes.add_patch(mate)
        self._mates_driven = [path_line(self._axes, colour, 0.9) for colour in colours]
        self._driven, self._contacts = path_line(self._axes), contact_marks(self._axes, min(8.0, max(4.5, side / 60.0)))
        self._nose = self._axes.plot([], [], color="white", linewidth=1.2, zorder=6)[0]
        self._reach = larger * footprint.radius
        self._returns = self._axes.plot([], [], ".", markersize=1.5, color=RETURNS, zorder=3)[0]
        plate = {"facecolor": "white", "edgecolor": "none"}
        corner = _free_corner(window, (stage.goal, stage.start))
        across, up = PLATES[corner]
        style: dict[str, Any] = {"color": INK, "fontsize": 9, "zorder": 9, "bbox": plate}
        self._clock = self._axes.text(*corner, "", transform=self._axes.transAxes, ha=across, va=up, **style)

    def frame(self, scene: SceneState) -> Frame:
        """Return the picture of a scene."""
        there = np.isfinite(scene.positions).all(axis=1)
        discs = [
            Circle((x, y), r)
            for (x, y), r in zip(scene.positions[there].tolist(), scene.radii[there].tolist(), strict=True)
        ]
        people = PatchCollection(discs, facecolor=PERSON, edgecolor="none", alpha=0.85, zorder=4)
        self._axes.add_collection(people, autolim=False)
        move_patch(self._robot, self._axes, scene.pose)
        x, y, theta = scene.pose
        self._nose.set_data([x, x + self._reach * np.cos(theta)], [y, y + self._reach * np.sin(theta)])
        for number, (mate, line) in enumerate(zip(self._mates, self._mates_driven, strict=True)):
            move_patch(mate, self._axes, scene.mates[-1, number])
            line.set_data(scene.mates[:, number, 0], scene.mates[:, number, 1])
        self._returns.set_data(scene.returns[:, 0], scene.returns[:, 1])
        self._driven.set_data(scene.driven[:, 0], scene.driven[:, 1])
        self._contacts.set_data(scene.contacts[:, 0], scene.contacts[:, 1])
        self._clock.set_text(f"{scene.title}  {scene.stamp:.1f} s".lstrip())
        show_doors(self._doors, scene.doors_open)
        self._canvas.restore_region(self._still)  # type: ignore[no-untyped-call]
        moving: list[Artist] = [
            *self._doors,
            self._returns,
            *self._mates_driven,
            self._driven,
            people,
            *self._mates,
            self._robot,
            self._nose,
            self._contacts,
            self._clock,
        ]
        for artist in moving:
            self._axes.draw_artist(artist)
        people.remove()
        return np.asarray(self._canvas.buffer_rgba())[..., :3].copy()  # type: ignore[no-untyped-call]


class FrameWindow:
    """A window on the screen that shows frames as they come."""

    def __init__(self, title: str, fps: float) -> None:
        import matplotlib.pyplot as plt

        if not has_display():
            raise ArenaError("render_mode is human, and there is no display; allowed here: rgb_array")
        self._plt, self._pause = plt, 1.0 / fps
        plt.ion()
        self._figure = plt.figure(title)
        self._image: Any = None

    def show(self, frame: Frame) -> None:
        """Show a frame, as long as its turn is."""
        if self._image is None or self._image.get_array().shape != frame.shape:
            self._figure.clear()
            axes = self._figure.add_axes((0.0, 0.0, 1.0, 1.0))
            axes.set_axis_off()
            self._image = axes.imshow(frame)
        self._image.set_data(frame)
        self._plt.pause(self._pause)

    def close(self) -> None:
        """Close the window."""
        self._plt.close(self._figure)


def has_display() -> bool:
    """Return whether a window can be opened here."""
    import matplotlib.pyplot as plt

    return plt.get_backend().lower() in {name.lower() for name in _interactive_backends()}


def _interactive_backends() -> Sequence[str]:
    from matplotlib.backends.registry import BackendFilter, backend_registry

    names: Sequence[str] = backend_registry.list_builtin(BackendFilter.INTERACTIVE)  # type: ignore[no-untyped-call]
    return names


def _fill_window(window: Window, size: Sequence[int], scale: float) -> Window:
    """Return a window that fills a picture of ``size`` pixels, wider where it was too narrow for one."""
    middles = ((window[0] + window[1]) / 2.0, (window[2] + window[3]) / 2.0)
    halves = [
        max(pixels / scale, length) / 2.0
        for pixels, length in zip(size, (window[1] - window[0], window[3] - window[2]), strict=True)
    ]
    (x, y), (half_x, half_y) = middles, halves
    return x - half_x, x + half_x, y - half_y, y + half_y


def _free_corner(window: Window, marks: Sequence[FloatArray]) -> tuple[float, float]:
    """Return the corner of the picture, a share of both sides, that is farthest from the nearest of some marks."""

    def room(corner: tuple[float, float]) -> float:
        x, y = (window[2 * k] + corner[k] * (window[2 * k + 1] - window[2 * k]) for k in (0, 1))
        return min(float(np.hypot(mark[0] - x, mark[1] - y)) for mark in marks)

    return max(PLATES, key=room)


def free_window(grid: OccupancyGrid) -> Window:
    """Return the bounds of the map's known, free cells with a margin: x from, to, y from, to, m."""
    rows, columns = np.nonzero((grid.data >= 0) & (grid.data < grid.occupied_from))
    if not len(rows):
        rows, columns = np.array((0, grid.data.shape[0] - 1)), np.array((0, grid.data.shape[1] - 1))
    x = grid.resolution * np.array((columns.min(), columns.max() + 1.0))
    y = grid.resolution * np.array((rows.min(), rows.max() + 1.0))
    c, s = np.cos(grid.origin.theta), np.sin(grid.origin.theta)
    corners = np.array([(c * i - s * j + grid.origin.x, s * i + c * j + grid.origin.y) for i in x for j in y])
    low, high = corners.min(axis=0) - MARGIN, corners.max(axis=0) + MARGIN
    return float(low[0]), float(high[0]), float(low[1]), float(high[1])
