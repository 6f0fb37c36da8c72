"""The picture of a cell: map, all trajectories, people's tracks, collisions, starts and goals."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from arena_core import EpisodeRecord, InputFileError, read_record
from arena_metrics.cells import Cell, Cells
from arena_metrics.figures import INK, Image, rendered

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

FloatArray = NDArray[np.float64]
SUCCEEDED, FAILED, PEOPLE = "#0072B2", "#D55E00", "#B88BA8"
WALL, UNKNOWN_CELL, FREE_CELL = (0.36, 0.36, 0.38), (0.93, 0.93, 0.93), (1.0, 1.0, 1.0)
MAPS = 4  # worlds side by side in one picture
LEGEND_HEIGHT = 0.75  # inches
MARGIN = 1.5  # m around all that happened
PERSON = 2  # contact_kind of a contact with a person


@dataclass(frozen=True, slots=True, eq=False)
class Drive:
    """One episode as it is drawn."""

    record: EpisodeRecord
    success: bool


def cell_image(cells: Cells, cell: Cell) -> Image | None:
    """Draw a cell; None where no episode left a record."""
    from matplotlib.figure import Figure

    by_map = _by_map(cell)
    if not by_map:
        return None
    shown = sorted(by_map.items(), key=lambda item: -len(item[1]))[:MAPS]
    windows = [_window(drives) for _, drives in shown]
    sizes = [_panel_size(window) for window in windows]
    width = sum(width for width, _ in sizes)
    figure = Figure(figsize=(width, max(height for _, height in sizes) + LEGEND_HEIGHT * max(1.0, 5.2 / width)), layout="constrained")
    panels = figure.subplots(1, len(shown), squeeze=False, width_ratios=[width for width, _ in sizes])[0]
    for axes, (path, drives), window in zip(panels, shown, windows, strict=True):
        _draw(axes, path, drives, window)
    _legend(figure, [drive for _, drives in shown for drive in drives])
    drawn = sum(len(drives) for _, drives in shown)
    left_out = sum(map(len, by_map.values())) - drawn
    note = f" ({left_out} more on {len(by_map) - MAPS} other maps)" if left_out else ""
    return rendered(figure, f"cell_{cell.hash}", f"{cells.name(cell)}: {drawn} episode{'s' * (drawn > 1)}{note}")


def _by_map(cell: Cell) -> dict[Path, list[Drive]]:
    """Read the records of a cell, grouped by the map that they were driven on; a map's name says what is in it, in every run."""
    drives: dict[str, list[Drive]] = {}
    paths: dict[str, Path] = {}
    for episode in cell.episodes:
        if episode.record_path.exists():
            record = read_record(episode.record_path)
            name = str(record.meta["world"]["grid"])
            paths[name] = episode.run.folder / name
            drives.setdefault(name, []).append(Drive(record, episode.row.get("success") == 1.0))
    return {paths[name]: found for name, found in drives.items()}


def _window(drives: Sequence[Drive]) -> tuple[float, float, float, float]:
    """Return x and y limits that hold all trajectories and goals, m."""
    points = [drive.record["pose"][:, :2] for drive in drives]
    points += [np.array([drive.record.meta["scenario"]["goal"][:2]]) for drive in drives]
    low, high = np.min([p.min(axis=0) for p in points], axis=0) - MARGIN, np.max([p.max(axis=0) for p in points], axis=0) + MARGIN
    return float(low[0]), float(high[0]), float(low[1]), float(high[1])


def _panel_size(window: tuple[float, float, float, float]) -> tuple[float, float]:
    """Return width and height in inches that keep the scale of x and y equal."""
    aspect = (window[1] - window[0]) / (window[3] - window[2])
    return (5.2, max(2.2, 5.2 / aspect)) if aspect > 1.0 else (max(2.2, 5.2 * aspect), 5.2)


def _draw(axes: Axes, path: Path, drives: Sequence[Drive], window: tuple[float, float, float, float]) -> None:
    axes.set_aspect("equal")
    axes.set_xlim(window[0], window[1])
    axes.set_ylim(window[2], window[3])
    _draw_map(axes, path)
    _draw_obstacles(axes, drives[0].record.meta["scenario"]["obstacles"])
    _draw_people(axes, drives)
    for drive in sorted(drives, key=lambda drive: drive.success, reverse=True):
        _draw_drive(axes, drive)
    _draw_scale_bar(axes, window)
    axes.set_xticks([])
    axes.set_yticks([])
    axes.spines[:].set(visible=True, color="#bbbbbb", linewidth=0.6)


def _draw_map(axes: Axes, path: Path) -> None:
    from matplotlib.transforms import Affine2D

    data, resolution, origin = read_grid(path)
    colours = np.empty((*data.shape, 3))
    colours[:] = FREE_CELL
    colours[data < 0] = UNKNOWN_CELL
    colours[data >= 65] = WALL
    place = Affine2D().rotate(origin[2]).translate(origin[0], origin[1]) + axes.transData
    extent = (0.0, data.shape[1] * resolution, 0.0, data.shape[0] * resolution)
    limits = axes.get_xlim(), axes.get_ylim()
    axes.imshow(colours, origin="lower", extent=extent, transform=place, interpolation="nearest", zorder=0)
    axes.set(xlim=limits[0], ylim=limits[1])


def read_grid(path: Path) -> tuple[NDArray[np.int8], float, FloatArray]:
    """Read a run's map: cells (H, W), resolution in m, origin (3,); raise InputFileError when it is missing or damaged."""
    try:
        with np.load(path, allow_pickle=False) as content:
            return content["data"], float(content["resolution"]), np.asarray(content["origin"], dtype=np.float64)
    except FileNotFoundError:
        raise InputFileError(f"{path}: no such file; allowed: the maps that `arena run` wrote beside the records") from None
    except Exception as error:
        raise InputFileError(f"{path}: damaged ({error}); allowed: a map that `arena run` wrote") from error


def _draw_obstacles(axes: Axes, obstacles: Sequence[Mapping[str, Any]]) -> None:
    from matplotlib.patches import Circle, Polygon

    for obstacle in obstacles:
        vertices = np.asarray(obstacle["vertices_xy"])
        shape = Circle(tuple(vertices[0]), obstacle["radius"]) if len(vertices) < 3 else Polygon(vertices)
        shape.set(facecolor="#8a8a8d", edgecolor="none", zorder=1)
        axes.add_patch(shape)


def _draw_people(axes: Axes, drives: Sequence[Drive]) -> None:
    from matplotlib.collections import LineCollection

    tracks = [track for drive in drives for track in np.moveaxis(drive.record["pedestrian_positions"], 1, 0)]
    colours = [colour for drive in drives for colour in people_colours(drive.record, PEOPLE)]
    axes.add_collection(LineCollection(tracks, colors=colours, linewidths=0.7, alpha=0.35, zorder=2), autolim=False)


def people_colours(record: EpisodeRecord, usual: str) -> list[str]:
    """Return a colour for each of a record's people: that of the type where the configuration gives it one, else the usual one."""
    types = record.meta["scenario"].get("pedestrian_types", {})
    known = record.meta.get("config", {}).get("pedestrians", {}).get("types", {})
    names = [types.get(str(number)) for number in record["pedestrian_ids"].tolist()]
    return [known.get(name, {}).get("colour") or usual for name in names]


def _draw_drive(axes: Axes, drive: Drive) -> None:
    record = drive.record
    colour = SUCCEEDED if drive.success else FAILED
    start, goal = record.meta["scenario"]["start"], record.meta["scenario"]["goal"]
    axes.plot(*record["pose"][:, :2].T, color=colour, linewidth=1.3, alpha=0.8, zorder=4, solid_joinstyle="round")
    axes.plot(start[0], start[1], "o", markersize=5, markerfacecolor="white", markeredgecolor=INK, markeredgewidth=1.0, zorder=5)
    axes.plot(goal[0], goal[1], "*", markersize=9, markerfacecolor="#F0C808", markeredgecolor=INK, markeredgewidth=0.7, zorder=6)
    for position, kind in zip(record["contact_position"], record["contact_kind"], strict=True):
        face = "#CC3377" if kind == PERSON else "black"
        axes.plot(*position, "X", markersize=7, markerfacecolor=face, markeredgecolor="white", markeredgewidth=0.8, zorder=7)


def _draw_scale_bar(axes: Axes, window: tuple[float, float, float, float]) -> None:
    """Draw a bar of a round length below the map."""
    length = scale_bar_length(window[1] - window[0])
    below = window[2] - 0.03 * (window[3] - window[2])
    axes.plot([window[0], window[0] + length], [below, below], color=INK, linewidth=2.0, clip_on=False, solid_capstyle="butt")
    axes.text(window[0] + length, below, f"  {length:g} m", va="center", ha="left", fontsize=8.5, color=INK)


def scale_bar_length(width: float) -> float:
    """Return the greatest of 1, 2 or 5 times a power of ten that is at most a quarter of ``width``, m."""
    quarter = width / 4.0
    power = 10.0 ** math.floor(math.log10(quarter))
    return max(factor * power for factor in (1.0, 2.0, 5.0) if factor * power <= quarter * (1.0 + 1e-9))


def _legend(figure: Figure, drives: Sequence[Drive]) -> None:
    """Put the legend below the map, with what the picture shows."""
    from matplotlib.lines import Line2D

    kinds = {bool(kind == PERSON) for drive in drives for kind in drive.record["contact_kind"]}
    mark = {"linestyle": "", "markeredgecolor": "white", "markeredgewidth": 0.8, "marker": "X", "markersize": 7}
    entries = [
        (any(d.success for d in drives), Line2D([], [], color=SUCCEEDED, label="successful")),
        (any(not d.success for d in drives), Line2D([], [], color=FAILED, label="not successful")),
        (any(d.record["pedestrian_ids"].size for d in drives), Line2D([], [], color=PEOPLE, linewidth=1, label="people")),
        (True, Line2D([], [], linestyle="", marker="o", markerfacecolor="white", markeredgecolor=INK, markersize=5, label="start")),
        (True, Line2D([], [], linestyle="", marker="*", markerfacecolor="#F0C808", markeredgecolor=INK, markersize=9, label="goal")),
        (True in kinds, Line2D([], [], markerfacecolor="#CC3377", label="collision, person", **mark)),  # type: ignore[arg-type]
        (False in kinds, Line2D([], [], markerfacecolor="black", label="collision, static", **mark)),  # type: ignore[arg-type]
    ]
    figure.legend(
        handles=[handle for wanted, handle in entries if wanted],
        loc="outside lower left",
        ncols=max(1, int(figure.get_figwidth() / 1.7)),
    )
