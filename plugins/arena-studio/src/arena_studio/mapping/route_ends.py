"""A way through a world: a start and a goal for who furnishes it."""

from __future__ import annotations

import numpy as np
from scipy import ndimage

from arena_core import InputFileError
from arena_studio.project import Project
from arena_worlds.commands.convert import DEFAULTS
from arena_worlds.commands.measure import ROBOT_RADIUS
from arena_worlds.formats.site_file import site_grid
from arena_worlds.reachable import free_places


def start_and_goal(project: Project, path: str) -> tuple[list[float], list[float]]:
    """Return a start and a goal, x, y (m) and heading (rad), in a world of the project; raise ArenaError.

    They are the places of the largest region where a robot can be that are farthest along its diagonal.
    """
    grid = site_grid(project.path(path), DEFAULTS["resolution"], DEFAULTS["margin"])
    labels, count = ndimage.label(free_places((grid.data >= 0) & ~grid.occupied, grid.resolution, ROBOT_RADIUS))
    if not count:
        raise InputFileError(f"the map has no free space for a robot of {ROBOT_RADIUS} m; allowed: a map with some")
    sizes = np.bincount(labels.ravel())
    sizes[0] = 0
    cells = np.argwhere(labels == sizes.argmax())
    along = cells.sum(axis=1)
    found = grid.positions(cells[[along.argmin(), along.argmax()]])
    heading = float(np.arctan2(*(found[1] - found[0])[::-1]))
    start, goal = ([round(float(x), 3), round(float(y), 3), round(heading, 3)] for x, y in found)
    return start, goal
