"""A map as a picture to look at: a title above it, a bar of metres below it."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from arena_core import OccupancyGrid
from arena_core.files import write_bytes_whole

WALL, FLOOR, UNCLEAR, INK, PAPER = (46, 52, 64), (250, 250, 247), (200, 203, 208), (46, 52, 64), (255, 255, 255)
LONG_SIDE, FRAME, TEXT = 900, 24, 22  # pixels: of the map, around it, of letters
BARS = (1, 2, 5, 10, 20, 50, 100)  # m


def write_portrait(path: Path, grid: OccupancyGrid, title: str) -> None:
    """Write a PNG of the map, its longer side about LONG_SIDE pixels; raise
    RunFolderError where it cannot be written.
    """
    content = io.BytesIO()
    draw_portrait(grid, title).save(content, "PNG", optimize=True)
    write_bytes_whole(path, content.getvalue())


def draw_portrait(grid: OccupancyGrid, title: str) -> Image.Image:
    """Return the map with title and bar, y up."""
    floor = _draw_floor(grid)
    font = ImageFont.load_default(TEXT)
    picture = Image.new("RGB", (floor.width + 2 * FRAME, floor.height + 2 * FRAME + 3 * TEXT), PAPER)
    draw = ImageDraw.Draw(picture)
    draw.text((FRAME, FRAME // 2), title, INK, font)
    picture.paste(floor, (FRAME, FRAME + TEXT))
    pixels_per_metre = floor.width / (grid.data.shape[1] * grid.resolution)
    _draw_scale_bar(
        draw, font, pixels_per_metre, floor.width / pixels_per_metre, FRAME + TEXT + floor.height + TEXT // 2
    )
    return picture


def _draw_floor(grid: OccupancyGrid) -> Image.Image:
    colours = np.empty((*grid.data.shape, 3), np.uint8)
    colours[:] = FLOOR
    colours[grid.data < 0] = UNCLEAR
    colours[grid.occupied] = WALL
    longest = max(grid.data.shape)
    size = [max(round(side * LONG_SIDE / longest), 1) for side in reversed(grid.data.shape)]
    enlarged = longest * 2 <= LONG_SIDE
    if enlarged:  # whole pixels a cell keep edges sharp
        size = [side * (LONG_SIDE // longest) for side in reversed(grid.data.shape)]
    return Image.fromarray(colours[::-1]).resize(
        (size[0], size[1]), Image.Resampling.NEAREST if enlarged else Image.Resampling.BOX
    )


def _draw_scale_bar(
    draw: ImageDraw.ImageDraw,
    font: ImageFont.FreeTypeFont | ImageFont.ImageFont,
    scale: float,
    width: float,
    top: float,
) -> None:
    metres = max((bar for bar in BARS if bar <= 0.3 * width), default=BARS[0])
    draw.rectangle((FRAME, top, FRAME + metres * scale, top + TEXT // 3), fill=INK)
    draw.text((FRAME + metres * scale + TEXT // 2, top - TEXT // 3), f"{metres} m", INK, font)
