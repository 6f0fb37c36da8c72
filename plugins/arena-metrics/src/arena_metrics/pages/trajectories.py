"""The picture of a cell: maps with the problems' own obstacles, trajectories by number, people's tracks,
collisions, starts and goals.
"""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from arena_core import EpisodeRecord
from arena_core.records import read_grid, read_record
from arena_drawing.painter import draw_goal, draw_map, draw_obstacles, draw_start, frame_axes
from arena_metrics.packs.outcome import PERSON
from arena_metrics.pages.figures import INK, Image, render_figure
from arena_metrics.pages.panels import Layout, Panel, Window
from arena_metrics.pooling.cells import Cell, Cells
from arena_metrics.pooling.drives import Drive

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

FloatArray = NDArray[np.float64]
SUCCEEDED, FAILED, PEOPLE = "#0072B2", "#D55E00", "#B88BA8"
WIDTH, HEIGHT = 7.2, 6.5  # inches, at most, of a picture's panels side by side, and of one panel
ACROSS = 4  # most panels side by side; the pictures of two rivals fit beside each other
LEGEND_HEIGHT, BELOW = 0.75, 0.2  # inches, of the legend and of the scale bar below each panel
SHORT = 1.0  # m from its goal, from where on a drive is said to have ended elsewhere
NUMBERED = 40  # trajectories in one panel whose numbers can still be read; of more, the failed ones are numbered


def cell_image(cells: Cells, cell: Cell, drives: Sequence[Drive], layout: Layout, *, pdf: bool) -> Image:
    """Draw a cell's drives in the panels of its condition."""
    from matplotlib.figure import Figure

    across, width, height = _panel_sizes(layout.panels)
    down = -(-len(layout.panels) // across)
    titled = len(layout.panels) > 1
    size = (width * across, (height + BELOW + 0.25 * titled) * down + LEGEND_HEIGHT * max(1.0, 5.2 / (width * across)))
    figure = Figure(figsize=size, layout="constrained")
    panels = figure.subplots(down, across, squeeze=False).ravel()
    shown = [[drive for drive in drives if drive.problem in panel.problems] for panel in layout.panels]
    records = [[read_record(drive.episode.record_path) for drive in of] for of in shown]
    for axes, panel, of, read in zip(panels, layout.panels, shown, records, strict=False):
        _draw_panel(axes, panel, of, read)
        if titled:
            axes.set_title(panel.title, loc="left")
    for axes in panels[len(layout.panels) :]:
        axes.set_axis_off()
    _draw_legend(figure, [drive for of in shown for drive in of], [record for read in records for record in read])
    drawn = sum(map(len, shown))
    note = f" ({layout.left_out} more problem{'s' * (layout.left_out > 1)} not drawn)" if layout.left_out else ""
    return render_figure(
        figure, f"cell_{cell.hash}", f"{cells.name(cell)}: {drawn} episode{'s' * (drawn != 1)}{note}", pdf=pdf
    )


def _panel_sizes(panels: Sequence[Panel]) -> tuple[int, float, float]:
    """Return how many panels stand side by side, so that the picture is about square, and their
    width and height in inches.
    """
    left, right, bottom, top = panels[0].window  # all are of one shape
    shape = (top - bottom) / (right - left)
    across = min(len(panels), max(2, min(ACROSS, round(math.sqrt(len(panels) * shape)))))
    most = WIDTH / across
    return (across, most, most * shape) if most * shape <= HEIGHT else (across, HEIGHT / shape, HEIGHT)


def _draw_panel(axes: Axes, panel: Panel, drives: Sequence[Drive], records: Sequence[EpisodeRecord]) -> None:
    frame_axes(axes, panel.window)
    if drives:
        grid = read_grid(drives[0].episode.run.folder / drives[0].problem.grid)
        draw_map(axes, grid.data, grid.resolution, grid.origin.array())
    for obstacles in {problem.obstacles: None for problem in sorted(panel.problems, key=repr)}:
        draw_obstacles(axes, json.loads(obstacles))
    _draw_people(axes, records)
    for drive, record in sorted(zip(drives, records, strict=True), key=lambda pair: pair[0].success, reverse=True):
        _draw_drive(axes, record, success=drive.success)
        _draw_rest(axes, drive)
    _draw_numbers(axes, drives)
    _draw_ends(axes, panel)
    _draw_scale_bar(axes, panel.window)
    axes.spines[:].set(visible=True, color="#bbbbbb", linewidth=0.6)


def _draw_people(axes: Axes, records: Sequence[EpisodeRecord]) -> None:
    from matplotlib.collections import LineCollection

    tracks = [track for record in records for track in np.moveaxis(record["pedestrian_positions"], 1, 0)]
    colours = [colour for record in records for colour in people_colours(record, PEOPLE)]
    axes.add_collection(LineCollection(tracks, colors=colours, linewidths=0.7, alpha=0.35, zorder=2), autolim=False)


def people_colours(record: EpisodeRecord, usual: str) -> list[str]:
    """Return a colour for each of a record's people: that of the type where the configuration
    gives it one, else the usual one.
    """
    types = record.meta["scenario"].get("pedestrian_types", {})
    known = record.meta.get("config", {}).get("pedestrians", {}).get("types", {})
    names = [types.get(str(number)) for number in record["pedestrian_ids"].tolist()]
    return [known.get(name, {}).get("colour") or usual for name in names]


def _draw_drive(axes: Axes, record: EpisodeRecord, *, success: bool) -> None:
    colour = SUCCEEDED if success else FAILED
    axes.plot(*record["pose"][:, :2].T, color=colour, linewidth=1.3, alpha=0.8, zorder=4, solid_joinstyle="round")
    for position, kind in zip(record["contact_position"], record["contact_kind"], strict=True):
        face = "#CC3377" if kind == PERSON else "black"
        axes.plot(
            *position, "X", markersize=7, markerfacecolor=face, markeredgecolor="white", markeredgewidth=0.8, zorder=7
        )


def _draw_rest(axes: Axes, drive: Drive) -> None:
    """Draw a dotted line to the goal of one that ended elsewhere, which tells whose goal it is."""
    (x, y), goal = drive.end_xy, drive.problem.goal
    if math.dist((x, y), goal[:2]) > SHORT:
        axes.plot([x, goal[0]], [y, goal[1]], ":", color=FAILED, linewidth=1.0, alpha=0.6, zorder=3)


def _draw_numbers(axes: Axes, drives: Sequence[Drive]) -> None:
    """Write each episode's number on its path, each further from the start than the one before: so they
    stand apart where paths do not.
    """
    from matplotlib.patheffects import withStroke

    numbered = [drive for drive in drives if len(drives) <= NUMBERED or not drive.success]
    for i, drive in enumerate(numbered):
        away = np.hypot(*(drive.path_xy - drive.path_xy[0]).T)
        x, y = drive.path_xy[int(np.argmax(away >= away.max() * (i + 1) / (len(numbered) + 1)))]
        colour = SUCCEEDED if drive.success else FAILED
        halo = [withStroke(linewidth=2.2, foreground="white")]
        axes.text(
            x,
            y,
            drive.label,
            ha="center",
            va="center",
            fontsize=7.5,
            color=colour,
            weight="bold",
            path_effects=halo,
            zorder=8,
            clip_on=True,
        )


def _draw_ends(axes: Axes, panel: Panel) -> None:
    """Mark start and goal of every problem, also of those that no one finished."""
    for problem in sorted(panel.problems, key=repr):
        draw_start(axes, *problem.start[:2])
        draw_goal(axes, *problem.goal[:2])


def _draw_scale_bar(axes: Axes, window: Window) -> None:
    """Draw a bar of a round length below the panel."""
    from matplotlib.transforms import ScaledTranslation

    length = scale_bar_length(window[1] - window[0])
    below = axes.get_xaxis_transform() + ScaledTranslation(0.0, -8.0 / 72.0, axes.figure.dpi_scale_trans)
    axes.plot(
        [window[0], window[0] + length],
        [0.0, 0.0],
        color=INK,
        linewidth=2.0,
        clip_on=False,
        solid_capstyle="butt",
        transform=below,
    )
    axes.text(
        window[0] + length, 0.0, f"  {length:g} m", va="center", ha="left", fontsize=8.5, color=INK, transform=below
    )


def scale_bar_length(width: float) -> float:
    """Return the greatest of 1, 2 or 5 times a power of ten that is at most a quarter of ``width``, m."""
    quarter = width / 4.0
    power = 10.0 ** math.floor(math.log10(quarter))
    return max(factor * power for factor in (1.0, 2.0, 5.0) if factor * power <= quarter * (1.0 + 1e-9))


def _draw_legend(figure: Figure, drives: Sequence[Drive], records: Sequence[EpisodeRecord]) -> None:
    """Put the legend below the maps, with what the picture shows."""
    from matplotlib.lines import Line2D

    kinds = {bool(kind == PERSON) for record in records for kind in record["contact_kind"]}

    def cross(color: str, label: str) -> Line2D:
        handle = Line2D([], [], linestyle="", marker="X", markersize=7, label=label)
        handle.set(markerfacecolor=color, markeredgecolor="white", markeredgewidth=0.8)
        return handle

    entries = [
        (any(d.success for d in drives), Line2D([], [], color=SUCCEEDED, label="successful")),
        (any(not d.success for d in drives), Line2D([], [], color=FAILED, label="not successful")),
        (
            any(record["pedestrian_ids"].size for record in records),
            Line2D([], [], color=PEOPLE, linewidth=1, label="people"),
        ),
        (
            True,
            Line2D(
                [],
                [],
                linestyle="",
                marker="o",
                markerfacecolor="white",
                markeredgecolor=INK,
                markersize=5,
                label="start",
            ),
        ),
        (
            True,
            Line2D(
                [],
                [],
                linestyle="",
                marker="*",
                markerfacecolor="#F0C808",
                markeredgecolor=INK,
                markersize=9,
                label="goal",
            ),
        ),
        (True in kinds, cross("#CC3377", "collision, person")),
        (False in kinds, cross("black", "collision, static")),
    ]
    figure.legend(
        handles=[handle for wanted, handle in entries if wanted],
        loc="outside lower left",
        ncols=max(1, int(figure.get_figwidth() / 1.7)),
    )
