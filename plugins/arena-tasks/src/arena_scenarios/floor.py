"""A floor plan to draw rooms into, and how it is kept as a ROS map."""

from __future__ import annotations

from io import BytesIO
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from arena_core.files import write_bytes_whole, write_text_whole

RESOLUTION = 0.05  # m
WALL_CELLS = 2  # a wall of one cell could be cut by a ray along its diagonal


class Floor:
    """A building of ``width`` by ``height`` m, at first solid; its lower left inner corner is the origin of ``map``."""

    def __init__(self, width: float, height: float) -> None:
        self.free = np.zeros((_cell_count(height), _cell_count(width)), bool)

    def room(self, x_min: float, y_min: float, x_max: float, y_max: float) -> None:
        """Make a rectangle free."""
        self.free[_cell_count(y_min) : _cell_count(y_max), _cell_count(x_min) : _cell_count(x_max)] = True

    def block(self, x_min: float, y_min: float, x_max: float, y_max: float) -> None:
        """Make a rectangle occupied; what lies outside the building is cut off."""
        self.free[max(_cell_count(y_min), 0) : _cell_count(y_max), max(_cell_count(x_min), 0) : _cell_count(x_max)] = (
            False
        )

    def pilasters(self, y: float, depth: float, places: tuple[float, ...]) -> None:
        """Put flat pillars of ``depth`` m (down from ``y`` if negative) on a wall along x: a scan matches a
        bare one anywhere along it.
        """
        for number, x in enumerate(places):
            low, high = sorted((y, y + depth))
            self.block(x, low, x + 0.3 + 0.1 * (number % 3), high)

    def save(self, folder: Path, name: str) -> None:
        """Write ``name.png`` and ``name.yaml`` with a wall all around."""
        save_map(folder, name, np.pad(self.free, WALL_CELLS), RESOLUTION, -WALL_CELLS * RESOLUTION)


def save_map(folder: Path, name: str, free: NDArray[np.bool_], resolution: float, corner: float) -> None:
    """Write a map of one bit a cell, (H, W), row 0 at the bottom; its lower left corner lies at (corner, corner), m."""
    picture = BytesIO()
    Image.fromarray(free[::-1]).save(picture, "png", optimize=True)
    write_bytes_whole(folder / f"{name}.png", picture.getvalue())
    lines = [
        f"image: {name}.png",
        f"resolution: {resolution}",
        f"origin: [{corner:.3f}, {corner:.3f}, 0.0]",
        "negate: 0",
    ]
    write_text_whole(
        folder / f"{name}.yaml", "\n".join([*lines, "occupied_thresh: 0.65", "free_thresh: 0.196", "mode: trinary", ""])
    )


def _cell_count(length: float) -> int:
    return round(length / RESOLUTION)
