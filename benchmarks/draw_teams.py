"""Draw where the robots of teams drove: python benchmarks/draw_teams.py OUT.png RECORD.npz ..."""

from __future__ import annotations

import sys

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle

from arena_core import EpisodeRecord
from arena_core.records import read_record

EVERY = 5.0  # s between two outlines of a robot
THIN = 2  # every so many control steps a point of a way


def draw_team(axes: Axes, record: EpisodeRecord) -> None:
    """Draw each robot's way in a colour of its own, where it was every five seconds, and its goal as a star."""
    poses, stamps = record["team_pose"], record["team_stamp"]
    for member, robot in enumerate(record.meta["team"]["robots"]):
        (line,) = axes.plot(*poses[::THIN, member, :2].T, linewidth=1.0)
        axes.plot(*robot["goal"][:2], "*", color=line.get_color())
        for step in np.searchsorted(stamps, np.arange(0.0, stamps[-1], EVERY)).tolist():
            place, radius = poses[step, member, :2], record.meta["robot"]["footprint"]["radius"]
            axes.add_patch(Circle(place, radius, fill=False, color=line.get_color(), linewidth=0.7))
    count = len(record.meta["team"]["robots"])
    axes.set_title(f"{count} robots, {record.meta['columns']['preset']}, {stamps[-1]:.0f} s", fontsize=9)
    axes.set_aspect("equal")
    axes.tick_params(labelsize=7)


def main(target: str, *records: str) -> None:
    """Write one picture of all records, side by side; lengths are in m."""
    figure = Figure(figsize=(3.4 * len(records), 3.6), layout="constrained")
    for axes, path in zip(np.atleast_1d(figure.subplots(1, len(records))), records, strict=True):
        draw_team(axes, read_record(path))
    figure.savefig(target, dpi=90, bbox_inches="tight")


if __name__ == "__main__":
    main(*sys.argv[1:])
