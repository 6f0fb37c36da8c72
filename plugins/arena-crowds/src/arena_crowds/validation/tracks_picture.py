"""A picture of where people walked."""

from __future__ import annotations

import io
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from arena_core.files import write_bytes_whole
from arena_crowds.validation.walk_record import WalkRecord

PANELS = 4
ROBOT = "#0072B2"


def draw_tracks(walked: Sequence[WalkRecord], path: Path) -> None:
    """Draw the first episodes: walls, everybody's track in a colour of its own with a ring at
    its start, and the robot's in bold.
    """
    from matplotlib.figure import Figure

    shown = walked[:PANELS]
    figure = Figure(figsize=(4.5 * len(shown), 4.5), layout="constrained")
    for axes, each in zip(np.ravel(figure.subplots(1, len(shown))), shown, strict=True):
        _draw_episode(axes, each)
    picture = io.BytesIO()
    figure.savefig(picture, format="png", dpi=90)
    write_bytes_whole(path, picture.getvalue())


def _draw_episode(axes: Any, walked: WalkRecord) -> None:
    from matplotlib import colormaps

    grid = walked.scenario.world.grid
    walls = grid.positions(np.argwhere(grid.occupied))
    axes.plot(*walls.T, ",", color="0.4")
    for number in range(walked.positions.shape[1]):
        colour = colormaps["tab10"](number % 10)
        axes.plot(*walked.positions[:, number].T, color=colour, linewidth=1.0)
        axes.plot(*walked.positions[0, number], "o", color=colour, fillstyle="none")
    axes.plot(*walked.poses[:, :2].T, color=ROBOT, linewidth=2.5)
    axes.plot(walked.poses[0, 0], walked.poses[0, 1], "s", color=ROBOT)
    axes.plot(walked.scenario.goal.x, walked.scenario.goal.y, "*", color=ROBOT, markersize=10)
    axes.set(aspect="equal", xticks=[], yticks=[], title=walked.scenario.name)
