"""The image of a map_server map, and the occupancy that its pixels stand for."""

from __future__ import annotations

import io
import re
import warnings
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from arena_core import InputFileError
from arena_core.commands import one_line
from arena_core.files import LIMITS, read_bytes
from arena_worlds.formats.map_yaml import MapFile

# of all that Pillow could open; PPM is its name for PGM as well
FORMATS = ("PNG", "PPM", "BMP", "JPEG", "GIF", "TIFF", "WEBP")
ALLOWED = "PGM, PNG, BMP, JPEG, GIF, TIFF or WebP"
HEADER = re.compile(rb"P\d(?:(?:\s|#[^\r\n]*[\r\n])+\d+){2}\s")
BAND = 2**20  # pixels
LONGEST_SIDE = 200_000  # pixels: 10 km at 5 cm
# bytes in which the header of a PGM ends: its comments are a line or two, and Pillow reads them byte by byte
HEAD = 65_536


def read_occupancy(file: MapFile) -> NDArray[np.int8]:
    """Return the values of a map, row 0 at the bottom, (H, W): -1 unknown, 0 free .. 100 occupied.

    As navigation2's map server (map_io.cpp): ``trinary`` averages an alpha channel in with the colours, ``scale`` takes
    what is not opaque as unknown and spreads the values between the thresholds, ``raw`` takes the grey value itself.
    """
    return image_occupancy(read_bytes(file.image, LIMITS.image_bytes, ALLOWED), file)[::-1]


def image_occupancy(content: bytes, file: MapFile) -> NDArray[np.int8]:
    """Return what the pixels of an image stand for in a map that reads like ``file``, row 0 at the top, (H, W)."""
    return np.concatenate([_pixel_values(file, *_colour_channels(band)) for band in _image_bands(content, file.image)])


def _check_header(content: bytes, path: Path) -> None:
    """Raise InputFileError for a PGM whose header has no end."""
    if content[:1] == b"P" and content[1:2].isdigit() and len(content) > HEAD and not HEADER.match(content, 0, HEAD):
        raise InputFileError(f"{path}: its header does not end within {HEAD} bytes; allowed: a header of a few lines")


def _pixel_values(file: MapFile, colours: NDArray[np.float64], alpha: NDArray[np.float64] | None) -> NDArray[np.int8]:
    """Return the values of pixels with these colours (H, W, 1 or 3) and alpha (H, W), 0 .. 1, row 0 at the top."""
    if file.mode == "raw":
        return _raw_values(_pixel_shade(colours, None))
    shade = _pixel_shade(colours, alpha if file.mode == "trinary" else None)
    occupied = shade if file.negate else 1.0 - shade
    values = _intermediate_values(occupied, file)
    values[occupied < file.free_thresh] = 0
    values[occupied > file.occupied_thresh] = 100
    if file.mode == "scale" and alpha is not None:
        values[alpha < 1.0] = -1
    return values


def _intermediate_values(occupied: NDArray[np.float64], file: MapFile) -> NDArray[np.int8]:
    """Return what cells between the thresholds are: unknown, or their share of the way."""
    if file.mode == "trinary":
        return np.full(occupied.shape, -1, np.int8)
    span = max(file.occupied_thresh - file.free_thresh, np.finfo(float).tiny)
    share = np.clip((occupied - file.free_thresh) / span, 0.0, 1.0)
    return np.rint(share * 100.0).astype(np.int8)


def _raw_values(shade: NDArray[np.float64]) -> NDArray[np.int8]:
    grey = np.floor(shade * 255.0 + 0.5)  # rounds halves up, as C's round does
    return np.where(grey <= 100.0, grey, -1.0).astype(np.int8)


def _pixel_shade(colours: NDArray[np.float64], alpha: NDArray[np.float64] | None) -> NDArray[np.float64]:
    """Return how bright the pixels are, 0 .. 1; an alpha channel counts as one more colour."""
    channels = colours if alpha is None else np.dstack((colours, alpha))
    return np.asarray(channels.sum(axis=2) / channels.shape[2])


def _image_bands(content: bytes, path: Path) -> Iterator[Image.Image]:
    """Yield an image in bands of whole rows, from the top: as numbers they take ten times the memory of the image."""
    _check_header(content, path)
    # Pillow raises anything, and no common error of its own, for files that are cut off, made up or no images
    try:
        with (
            warnings.catch_warnings(action="error", category=Image.DecompressionBombWarning),
            Image.open(io.BytesIO(content), formats=FORMATS) as image,
        ):
            if image.width * image.height > LIMITS.cells:
                raise InputFileError(
                    f"{path}: has {image.width} x {image.height} pixels; allowed: {LIMITS.cells} in all"
                )
            if max(image.size) > LONGEST_SIDE:
                raise InputFileError(
                    f"{path}: has {image.width} x {image.height} pixels; allowed: {LONGEST_SIDE} a side"
                )
            image.load()
            rows = max(BAND // image.width, 1)
            for top in range(0, image.height, rows):
                yield image.crop((0, top, image.width, min(top + rows, image.height)))
    except InputFileError:
        raise
    except Exception as error:
        raise InputFileError(
            f"{path}: is no image that can be read ({one_line(str(error), 120)}); allowed: {ALLOWED}"
        ) from None


def _colour_channels(image: Image.Image) -> tuple[NDArray[np.float64], NDArray[np.float64] | None]:
    if image.mode.startswith("I"):  # 16 bit grey
        return np.asarray(image, dtype=np.float64)[:, :, None] / 65535.0, None
    if image.mode == "L":
        return np.asarray(image, dtype=np.float64)[:, :, None] / 255.0, None
    if image.has_transparency_data:
        pixels = np.asarray(image.convert("RGBA"), dtype=np.float64) / 255.0
        return pixels[:, :, :3], pixels[:, :, 3]
    return np.asarray(image.convert("RGB"), dtype=np.float64) / 255.0, None
