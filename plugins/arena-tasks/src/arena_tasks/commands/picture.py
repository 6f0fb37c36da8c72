"""Problems of a scenario file as one picture: each on its map, with people's rounds, groups and
trigger zones, and a legend.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, Patch
from numpy.typing import NDArray

from arena_core import Obstacle, OccupancyGrid, PedestrianSpec, Robot, World
from arena_core.commands import one_line
from arena_core.scenes import furniture_shapes
from arena_drawing.painter import (
    DOOR,
    GOAL,
    INK,
    OBSTACLE,
    PERSON,
    ROBOT,
    body_patch,
    door_patches,
    draw_goal,
    draw_map,
    draw_obstacles,
    frame_axes,
    move_patch,
)
from arena_tasks.commands.picture_people import TRIGGER, draw_person, group_colours
from arena_tasks.scenario_files.problem import Problem
from arena_tasks.scenario_files.zones import zones_of

PANEL = 7.2  # inches of the longer side of one scene
SMALL_PANEL = 4.8  # of one among several
DPI = 110
MARGIN = 0.5  # m around what of the map is known
LEGEND = 0.5  # least inches below the scenes
HEAD, BETWEEN = 0.3, 0.35  # inches above the first scene, and between two rows
LONGEST_LABEL = 28  # characters of the legend
Window = tuple[float, float, float, float]


def draw_problems(problems: Sequence[Problem], world: World, robot: Robot, goal_radius: float) -> NDArray[np.uint8]:
    """Return the picture (H, W, 3), bytes; ``goal_radius`` m counts where a problem does not say."""
    window = _map_window(world.grid)
    figure, panels = _make_panels(len(problems), window)
    for axes, problem in zip(panels, problems, strict=True):
        frame_axes(axes, window)
        draw_map(axes, world.grid.data, world.grid.resolution, world.grid.origin.array())
        draw_problem(axes, problem, world, robot, problem.goal_radius or goal_radius)
        axes.set_title(f"{problem.name}  ({len(problem.pedestrians)} people)", fontsize=10, color=INK)
    canvas = FigureCanvasAgg(figure)
    _add_legend(figure, _legend_handles(problems))
    canvas.draw()  # type: ignore[no-untyped-call]
    return np.asarray(canvas.buffer_rgba())[..., :3].copy()  # type: ignore[no-untyped-call]


def _add_legend(figure: Figure, marks: Sequence[Line2D | Patch]) -> None:
    """Draw a legend below the scenes in as few rows as its words leave, and make the
    picture as much higher as it needs.
    """
    for columns in range(len(marks), 0, -1):
        legend = figure.legend(handles=marks, loc="lower center", ncols=columns, frameon=False, fontsize=9)
        box = legend.get_window_extent()
        if box.width <= figure.bbox.width or columns == 1:
            break
        legend.remove()
    across, before = figure.get_size_inches()
    total = before + max(0.0, box.height / DPI - LEGEND)
    figure.set_size_inches(across, total)
    figure.subplots_adjust(top=1.0 - HEAD / total, bottom=(total - before + LEGEND) / total)


def draw_problem(axes: Axes, problem: Problem, world: World, robot: Robot, goal_radius: float) -> None:
    """Draw what a problem adds to its map."""
    draw_obstacles(
        axes, [*furniture_shapes((*world.furniture, *problem.furniture)), *map(_shape_arguments, problem.obstacles)]
    )
    door_patches(axes, [door.vertices_xy for door in problem.doors])
    colours = group_colours(problem.pedestrians)
    for person in problem.pedestrians:
        draw_person(axes, person, colours.get(str(person.behaviour.get("group", "")), PERSON))
    arrival = Circle((problem.goal.x, problem.goal.y), goal_radius)
    arrival.set(facecolor=GOAL, alpha=0.35, edgecolor=INK, linewidth=0.5, zorder=3)
    axes.add_patch(arrival)
    draw_goal(axes, problem.goal.x, problem.goal.y)
    outline = body_patch(robot.footprint.vertices_xy, robot.footprint.radius)
    axes.add_patch(outline)
    move_patch(outline, axes, problem.start.array())
    _draw_heading(axes, problem, max(2.5 * robot.footprint.radius, 0.5))


def _draw_heading(axes: Axes, problem: Problem, length: float) -> None:
    """Draw an arrow from the start along its heading, and a ring, for a robot may be too small
    to be seen on a large map.
    """
    x, y, theta = problem.start.array().tolist()
    axes.plot(x, y, "o", markersize=9, markerfacecolor="none", markeredgecolor=ROBOT, markeredgewidth=1.2, zorder=6)
    tip = (x + length * math.cos(theta), y + length * math.sin(theta))
    axes.annotate("", tip, (x, y), arrowprops={"arrowstyle": "-|>", "color": ROBOT, "linewidth": 1.4}, zorder=6)


def _shape_arguments(obstacle: Obstacle) -> dict[str, object]:
    return {"vertices_xy": obstacle.vertices_xy, "radius": obstacle.radius}


def _make_panels(count: int, window: Window) -> tuple[Figure, list[Axes]]:
    """Return a figure with an axes for each of so many scenes, as square a field of them as there can be."""
    columns = math.ceil(math.sqrt(count))
    rows = math.ceil(count / columns)
    width, height = window[1] - window[0], window[3] - window[2]
    scale = (PANEL if count == 1 else SMALL_PANEL) / max(width, height)
    across, up = max(scale * width, 3.2), max(scale * height, 2.0) + BETWEEN
    total = rows * up + LEGEND
    figure = Figure(figsize=(columns * across + 0.2, total), dpi=DPI, facecolor="white")
    field = figure.subplots(rows, columns, squeeze=False).ravel()
    figure.subplots_adjust(
        left=0.02, right=0.98, top=1.0 - HEAD / total, bottom=LEGEND / total, wspace=0.04, hspace=BETWEEN / up
    )
    for axes in field[count:]:
        axes.set_axis_off()
    return figure, list(field[:count])


def _map_window(grid: OccupancyGrid) -> Window:
    """Return the bounds of all that is known of a map, with a margin: x from, to, y from, to, m."""
    rows, columns = np.nonzero(grid.data >= 0)
    if not len(rows):
        rows, columns = np.array((0, grid.data.shape[0] - 1)), np.array((0, grid.data.shape[1] - 1))
    corners = grid.positions(
        [(row, column) for row in (rows.min(), rows.max()) for column in (columns.min(), columns.max())]
    )
    (left, bottom), (right, top) = corners.min(axis=0) - MARGIN, corners.max(axis=0) + MARGIN
    return float(left), float(right), float(bottom), float(top)


def _legend_handles(problems: Sequence[Problem]) -> list[Line2D | Patch]:
    """Return what explains the marks that are there."""
    people: list[PedestrianSpec] = [person for problem in problems for person in problem.pedestrians]
    marks: list[tuple[bool, Line2D | Patch]] = [
        (True, Line2D([], [], marker="o", color=ROBOT, linestyle="none", label="robot's start")),
        (
            True,
            Line2D([], [], marker="*", color=GOAL, markeredgecolor=INK, markersize=10, linestyle="none", label="goal"),
        ),
        (
            bool(people),
            Line2D([], [], marker="o", color=PERSON, linestyle="--", linewidth=1.0, label="person and round"),
        ),
        *((True, Patch(color=colour, label=name)) for name, colour in _legend_colours(problems).items()),
        (any(map(zones_of, people)), Patch(color=TRIGGER, alpha=0.4, label="trigger")),
        (any(problem.obstacles or problem.furniture for problem in problems), Patch(color=OBSTACLE, label="obstacle")),
        (any(problem.doors for problem in problems), Patch(color=DOOR, label="door")),
    ]
    return [mark for is_there, mark in marks if is_there]


def _legend_colours(problems: Sequence[Problem]) -> dict[str, str]:
    """Return the colours of groups by what the legend calls them; of several scenes, in which
    names differ, one stands for all.
    """
    colours = [{_group_label(name): colour for name, colour in group_colours(p.pedestrians).items()} for p in problems]
    if len(problems) == 1:
        return colours[0]
    first = next(filter(None, colours), {})
    return {"groups": next(iter(first.values()))} if first else {}


def _group_label(group: str) -> str:
    return one_line(f"group {group.removeprefix('group ')}", LONGEST_LABEL)
