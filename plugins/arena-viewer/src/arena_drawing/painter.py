"""What pictures of worlds have in common: colours, maps, obstacles, bodies and marks, on
matplotlib axes in m in ``map``.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, Patch, Polygon
from matplotlib.transforms import Affine2D
from numpy.typing import ArrayLike, NDArray

FloatArray = NDArray[np.float64]
INK = "#333333"
# after Okabe and Ito: told apart by who is colour-blind
ROBOT, PERSON, PATH, GOAL = "#0072B2", "#D55E00", "#009E73", "#F0C808"
TEAM = ("#8E44AD", "#117A65", "#B7950B", "#C0392B", "#5D6D7E", "#56B4E9")  # a robot's teammates, as in replays
CONTACT = "#D7263D"
OBSTACLE, OVERHANG = "#8a8a8d", "#e3d2bd"
DOOR = "#6D4C41"
WALL, UNKNOWN_CELL, FREE_CELL = (0.36, 0.36, 0.38), (0.93, 0.93, 0.93), (1.0, 1.0, 1.0)
OCCUPIED_FROM = 65  # of a cell (ROS map_server)


def draw_map(axes: Axes, data: NDArray[np.int8], resolution: float, origin: ArrayLike) -> None:
    """Draw the cells (H, W) of a map below everything else;

    ``resolution`` in m, ``origin`` (3,). The axes' limits stay.
    """
    colours = np.empty((*data.shape, 3))
    colours[:] = FREE_CELL
    colours[data < 0] = UNKNOWN_CELL
    colours[data >= OCCUPIED_FROM] = WALL
    x, y, theta = np.asarray(origin, dtype=np.float64)
    place = Affine2D().rotate(theta).translate(x, y) + axes.transData
    extent = (0.0, data.shape[1] * resolution, 0.0, data.shape[0] * resolution)
    limits = axes.get_xlim(), axes.get_ylim()
    axes.imshow(colours, origin="lower", extent=extent, transform=place, interpolation="nearest", zorder=0)
    axes.set(xlim=limits[0], ylim=limits[1])


def draw_obstacles(axes: Axes, obstacles: Sequence[Mapping[str, Any]]) -> None:
    """Draw obstacles that are on no map, as records have them: ``vertices_xy`` of a polygon, or a place and a
    ``radius``.

    What has a key ``overhang`` is a top of furniture, and drawn lightly; what has a key ``door`` has the colour of
    doors.
    """
    for obstacle in obstacles:
        vertices = np.asarray(obstacle["vertices_xy"])
        shape = Circle(tuple(vertices[0]), obstacle["radius"]) if len(vertices) < 3 else Polygon(vertices)
        colour = DOOR if obstacle.get("door") else OVERHANG if obstacle.get("overhang") else OBSTACLE
        shape.set(facecolor=colour, edgecolor="none", zorder=1)
        axes.add_patch(shape)


def door_patches(axes: Axes, outlines: Sequence[ArrayLike]) -> list[Polygon]:
    """Add closed doors, each an outline (V, 2)."""
    patches = [Polygon(np.asarray(outline), facecolor=DOOR, edgecolor=DOOR, zorder=2) for outline in outlines]
    for patch in patches:
        axes.add_patch(patch)
    return patches


def show_doors(patches: Sequence[Polygon], doors_open: Sequence[bool]) -> None:
    """Fill doors that are closed; of open ones the outline is left."""
    for patch, is_open in zip(patches, doors_open, strict=True):
        patch.set(facecolor="none" if is_open else DOOR, linewidth=0.8 if is_open else 1.0)


def body_patch(vertices_xy: ArrayLike, radius: float, colour: str = ROBOT, zorder: float = 5) -> Patch:
    """Return the outline of a body at the origin: a polygon of ``vertices_xy`` (V, 2), a disc where there are none."""
    vertices = np.asarray(vertices_xy, dtype=np.float64).reshape(-1, 2)
    shape = Polygon(vertices) if len(vertices) else Circle((0.0, 0.0), radius)
    shape.set(facecolor=colour, edgecolor="none", zorder=zorder)
    return shape


def move_patch(patch: Patch, axes: Axes, pose: ArrayLike) -> None:
    """Put a body that was made at the origin to a pose (3,)."""
    x, y, theta = np.asarray(pose, dtype=np.float64)
    patch.set_transform(Affine2D().rotate(theta).translate(x, y) + axes.transData)


def draw_start(axes: Axes, x: float, y: float) -> Line2D:
    """Mark where a robot began."""
    (mark,) = axes.plot(
        x, y, "o", markersize=5, markerfacecolor="white", markeredgecolor=INK, markeredgewidth=1.0, zorder=5
    )
    return mark


def draw_goal(axes: Axes, x: float, y: float, *, colour: str = GOAL) -> Line2D:
    """Mark where a robot is to go."""
    (mark,) = axes.plot(
        x, y, "*", markersize=9, markerfacecolor=colour, markeredgecolor=INK, markeredgewidth=0.7, zorder=6
    )
    return mark


def path_line(axes: Axes, colour: str = ROBOT, width: float = 1.6) -> Line2D:
    """Return the line of the way that a robot has driven, with no point yet."""
    (line,) = axes.plot([], [], color=colour, linewidth=width, solid_capstyle="round", zorder=3)
    return line


def contact_marks(axes: Axes, size: float) -> Line2D:
    """Return the marks of places where a robot touched something, none yet: crosses of ``size`` points."""
    (marks,) = axes.plot(
        [],
        [],
        "X",
        markersize=size,
        markerfacecolor=CONTACT,
        markeredgecolor="white",
        markeredgewidth=size / 9.0,
        zorder=8,
    )
    return marks


def frame_axes(axes: Axes, window: tuple[float, float, float, float]) -> None:
    """Show x from ``window[0]`` to ``window[1]`` and y from ``window[2]`` to ``window[3]``, m, without ticks."""
    axes.set_aspect("equal")
    axes.set_facecolor(UNKNOWN_CELL)
    axes.set(xlim=window[:2], ylim=window[2:], xticks=[], yticks=[])
