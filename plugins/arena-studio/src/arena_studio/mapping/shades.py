"""An image as one byte a cell: codes, what each code's pixel is, what occupancy it stands for,
and which codes to draw with.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from arena_core import InputFileError
from arena_studio.mapping.picture import Picture, read_picture
from arena_studio.mapping.pnm import Pnm, is_pnm, read_pnm
from arena_worlds.formats.map_image import image_occupancy
from arena_worlds.formats.map_yaml import MapFile

CODES = 256
DRAWN = {"free": 0, "occupied": 100, "unknown": -1}
USUAL = (254, 0, 205, 255, 100)  # greys that map_saver writes, white, and what ``raw`` has for occupied


@dataclass(frozen=True, slots=True, eq=False)
class Cells:
    """``codes`` (H, W), row 0 at the top, are rows of ``samples`` (K, C), whose occupancy is ``values`` (K,), -1 ..
    100.

    ``drawn`` says which code to draw free, occupied and unknown cells with; None: this image has no such pixel.
    """

    codes: NDArray[np.uint8]
    samples: NDArray[np.uint16]
    values: NDArray[np.int8]
    drawn: Mapping[str, int | None]


def read_image(content: bytes, name: str) -> Pnm | Picture | None:
    """Read an image that can be written again without loss;

    None for another kind. Raises InputFileError, which calls it ``name``.
    """
    return read_pnm(content, name) if is_pnm(content) else read_picture(content, name)


def cells_of(image: Pnm | Picture, file: MapFile) -> Cells:
    """Return an image's cells as the map ``file`` reads them; raise InputFileError for one with
    more than 256 different pixels.
    """
    codes, samples = _code_image(image, file)
    cells = Cells(codes, samples, pixel_occupancies(image, samples, file), {})
    return _with_shades(cells, image, file)


def pixel_occupancies(image: Pnm | Picture, samples: NDArray[np.uint16], file: MapFile) -> NDArray[np.int8]:
    """Return what occupancy pixels (K, C) stand for, (K,): they are written as an
    image of one row and read as any map.
    """
    return np.asarray(image_occupancy(image.encode_samples(samples[None]), file)[0])


def _code_image(image: Pnm | Picture, file: MapFile) -> tuple[NDArray[np.uint8], NDArray[np.uint16]]:
    pixels = image.samples
    if pixels.shape[2] == 1 and image.highest <= 255 and not (isinstance(image, Picture) and image.image.mode == "P"):
        # a grey value is its own code: nothing has to be counted, and a stroke needs no new one
        count = CODES if isinstance(image, Pnm) else image.highest + 1
        return pixels[:, :, 0].astype(np.uint8, copy=False), np.arange(count, dtype=np.uint16)[:, None]
    packed = np.zeros(pixels.shape[:2], np.uint64)
    for channel in range(pixels.shape[2]):
        packed = packed << np.uint64(16) | pixels[:, :, channel].astype(np.uint64)
    _, first, codes = np.unique(packed, return_index=True, return_inverse=True)
    if len(first) > CODES:
        raise InputFileError(
            f"{file.image}: has {len(first)} different colours; allowed: up to {CODES}, or a grey image"
        )
    return codes.reshape(packed.shape).astype(np.uint8), pixels.reshape(-1, pixels.shape[2])[first].astype(np.uint16)


def _with_shades(cells: Cells, image: Pnm | Picture, file: MapFile) -> Cells:
    """Choose codes to draw with: the commonest that stands for it, else a usual grey, which is
    added where there is room.
    """
    counts = np.array(Image.fromarray(cells.codes).histogram())  # of 16 million cells in a fiftieth of bincount's time
    drawn: dict[str, int | None] = {}
    for name, value in DRAWN.items():
        fitting = np.flatnonzero(cells.values == value)
        if len(fitting) and counts[fitting].max() > 0:
            drawn[name] = int(fitting[counts[fitting].argmax()])
        else:
            cells, drawn[name] = _usual_code(cells, image, file, value)
    return replace(cells, drawn=drawn)


def _usual_code(cells: Cells, image: Pnm | Picture, file: MapFile, value: int) -> tuple[Cells, int | None]:
    candidates = _candidate_pixels(image)
    fitting = np.flatnonzero(pixel_occupancies(image, candidates, file) == value)
    if not len(fitting):
        return cells, None
    sample = candidates[fitting[0]]
    known = np.flatnonzero((cells.samples == sample).all(axis=1))
    if len(known):
        return cells, int(known[0])
    if len(cells.samples) == CODES:
        return cells, None
    samples, values = np.vstack((cells.samples, sample)), np.append(cells.values, np.int8(value))
    return replace(cells, samples=samples, values=values), len(samples) - 1


def _candidate_pixels(image: Pnm | Picture) -> NDArray[np.uint16]:
    """Return pixels (K, C) that could be drawn with, the usual greys first, transparent black last."""
    channels, mode = image.samples.shape[2], image.image.mode if isinstance(image, Picture) else ""
    if mode in ("P", "1"):
        return np.arange(image.highest + 1, dtype=np.uint16)[:, None]
    greys = np.array([*USUAL, *(grey for grey in range(CODES) if grey not in USUAL)], np.uint32)
    scaled = (greys * image.highest + 127) // 255
    if mode not in ("LA", "RGBA"):
        return np.repeat(scaled[:, None], channels, axis=1).astype(np.uint16)
    opaque = np.repeat(scaled[:, None], channels, axis=1)
    opaque[:, -1] = 255
    return np.vstack((opaque, np.zeros(channels, np.uint32))).astype(np.uint16)


def plain_pgm(shape: tuple[int, int]) -> Pnm:
    """Return an empty grey image (H, W) as new maps have it."""
    return read_pnm(f"P5\n{shape[1]} {shape[0]}\n255\n".encode() + bytes(shape[0] * shape[1]), "map.pgm")


def check_samples(given: Any, image: Pnm | Picture) -> NDArray[np.uint16]:
    """Return pixels (K, C) that were sent; raise InputFileError where this image cannot have them."""
    channels = image.samples.shape[2]
    highest = 255 if isinstance(image, Pnm) and image.highest <= 255 else image.highest
    if (
        not isinstance(given, list)
        or not 0 < len(given) <= CODES
        or not all(_is_pixel(one, channels, highest) for one in given)
    ):
        raise InputFileError(
            f"samples are not pixels of this image; allowed: up to {CODES}, each of {channels} numbers 0 .. {highest}"
        )
    return np.array(given, np.uint16)


def _is_pixel(given: Any, channels: int, highest: int) -> bool:
    return (
        isinstance(given, list)
        and len(given) == channels
        and all(type(one) is int and 0 <= one <= highest for one in given)
    )
