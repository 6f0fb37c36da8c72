"""Draw a team at moments of one episode: python benchmarks/draw_door.py OUT.png RECORD.npz XMIN,XMAX,YMIN,YMAX S ..."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle

from arena_core import EpisodeRecord
from arena_core.records import read_grid, read_record

BEFORE = 8.0  # s of each robot's way that are drawn


def draw_moment(axes: Axes, record: EpisodeRecord, grid_file: Path, at: float) -> None:
    """Draw walls, where each robot is at ``at`` s with its number, where it heads, and its way of the last seconds."""
    grid, poses, stamps = read_grid(grid_file), record["team_pose"], record["team_stamp"]
    walls = grid.positions(np.argwhere(grid.occupied))
    axes.plot(*walls.T, "s", color="0.3", markersize=2.5)
    now, first = np.searchsorted(stamps, (at, at - BEFORE)).tolist()
    for member, robot in enumerate(record.meta["team"]["robots"]):
        (line,) = axes.plot(*poses[first : now + 1, member, :2].T, linewidth=1.0)
        (x, y, theta), radius = poses[now, member], robot["robot"]["footprint"]["radius"]
        axes.add_patch(Circle((x, y), radius, fill=False, color=line.get_color()))
        axes.plot((x, x + radius * np.cos(theta)), (y, y + radius * np.sin(theta)), color=line.get_color())
        axes.text(x, y, str(member), ha="center", va="center", fontsize=8, clip_on=True)
    axes.set_title(f"{at:g} s", fontsize=9)
    axes.set_aspect("equal")
    axes.tick_params(labelsize=7)


def main(target: str, path: str, window: str, *moments: str) -> None:
    """Write one picture of all moments, side by side; lengths are in m."""
    record, (left, right, low, high) = read_record(path), map(float, window.split(","))
    figure = Figure(figsize=(3.2 * len(moments), 3.0), layout="constrained")
    for axes, at in zip(np.atleast_1d(figure.subplots(1, len(moments))), moments, strict=True):
        draw_moment(axes, record, Path(path).parent.parent / record.meta["world"]["grid"], float(at))
        axes.set(xlim=(left, right), ylim=(low, high))
    figure.savefig(target, dpi=90, bbox_inches="tight")


if __name__ == "__main__":
    main(*sys.argv[1:])
