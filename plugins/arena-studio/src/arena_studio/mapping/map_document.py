"""A map of the project as the editor has it: opened, changed by rectangles of cells, written as a new one."""

from __future__ import annotations

import os
import posixpath
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import Any

import numpy as np
from numpy.typing import NDArray

from arena_core import ArenaError, InputFileError, OccupancyGrid, Pose
from arena_core.commands import one_line
from arena_core.files import LIMITS, read_bytes
from arena_core.parameters import read_settings
from arena_studio.errors import Conflict
from arena_studio.mapping.picture import Picture
from arena_studio.mapping.pnm import Pnm, Samples
from arena_studio.mapping.shades import Cells, cells_of, check_samples, plain_pgm, read_image
from arena_studio.mapping.yaml_text import Value, with_values
from arena_studio.project import Document, Project
from arena_worlds.commands.convert import DEFAULTS
from arena_worlds.formats.flatland_world import ENDING
from arena_worlds.formats.map_writer import FREE_THRESH, OCCUPIED_THRESH, map_text, pixels_of
from arena_worlds.formats.map_yaml import MapFile, read_map_yaml
from arena_worlds.formats.site_file import GAZEBO, ROS, site_grid

NAMES_IMAGE = (b"image:", b'"image":', b"{image:", b'{"image":')


@dataclass(frozen=True, slots=True, eq=False)
class OpenMap:
    """A map_server map whose image can be written without loss. ``image_path`` is its place in the project."""

    path: str
    file: MapFile
    text: Document
    image_path: str
    image_text: Document
    image: Pnm | Picture

    @property
    def version(self) -> str:
        """Return the versions of both files."""
        return f"{self.text.version}.{self.image_text.version}"


def open_map(project: Project, path: str) -> OpenMap | None:
    """Read a map; None where it is a world of another kind, or its image of a kind that would lose something when
    written.

    Raises ArenaError where it cannot be read.
    """
    text = project.read(path)
    if Path(path).suffix not in ROS or path.endswith(ENDING) or not is_map_text(text.content):
        return None
    file = read_map_yaml(project.path(path))
    image_path = os.path.relpath(file.image, project.root)
    image_text = project.read(image_path)
    image = read_image(image_text.content, image_path)
    return None if image is None else OpenMap(path, file, text, image_path, image_text, image)


def is_map_text(content: bytes) -> bool:
    """Return whether a YAML file may be a map's: it names an image."""
    return any(line.strip().startswith(NAMES_IMAGE) for line in content.splitlines())


def map_files(project: Project) -> list[str]:
    """Return the worlds of the project that the editor opens: maps, Flatland worlds, and those of Gazebo."""
    found = project.files({*ROS, *GAZEBO})
    return [path for path in found if Path(path).suffix in GAZEBO or path.endswith(ENDING) or _is_map(project, path)]


def _is_map(project: Project, path: str) -> bool:
    try:
        return is_map_text(read_bytes(project.path(path), LIMITS.yaml_bytes, "a map's YAML file"))
    except ArenaError:
        return False


def map_version(project: Project, path: str) -> str | None:
    """Return the version of a map; None for a world that cannot be changed as it is."""
    opened = open_map(project, path)
    return None if opened is None else opened.version


def header_of(
    path: str | None, cells: Cells, keys: Mapping[str, Any], version: str | None, mode: str
) -> dict[str, Any]:
    """Return what the page is told of a map beside its codes."""
    rows, columns = cells.codes.shape
    said = {
        "path": path,
        "version": version,
        "width": columns,
        "height": rows,
        "most_cells": LIMITS.cells,
        "mode": mode,
        **keys,
    }
    return {**said, "samples": cells.samples.tolist(), "values": cells.values.tolist(), "drawn": dict(cells.drawn)}


def map_document(project: Project, path: str) -> tuple[dict[str, Any], NDArray[np.uint8]]:
    """Return a world of the project for the page: what is said of it, and its codes (H, W), row 0 at the top; raise
    ArenaError.

    ``version`` is None where it cannot be written as it is; then it is kept as a map of another name.
    """
    opened = open_map(project, path)
    if opened is None:
        return grid_document(site_grid(project.path(path), DEFAULTS["resolution"], DEFAULTS["margin"]), path)
    return document_of(opened)


def document_of(opened: OpenMap) -> tuple[dict[str, Any], NDArray[np.uint8]]:
    """Return a map as ``map_document`` does; raise InputFileError for an image with too many colours."""
    cells = cells_of(opened.image, opened.file)
    file = opened.file
    keys = {
        "resolution": file.resolution,
        "origin": list(file.origin),
        "image": opened.image_path,
        "negate": int(file.negate),
        "occupied_thresh": file.occupied_thresh,
        "free_thresh": file.free_thresh,
    }
    return header_of(opened.path, cells, keys, opened.version, file.mode), cells.codes


def grid_document(grid: OccupancyGrid, path: str | None) -> tuple[dict[str, Any], NDArray[np.uint8]]:
    """Return a grid that is no map file yet, in the shades that a new map has: what is said of it, and its codes."""
    mode, _ = map_text(grid, "map.pgm")
    pixels = (pixels_of(grid.data) if mode == "trinary" else grid.data.view(np.uint8))[::-1]
    file = MapFile(
        Path("map.pgm"),
        grid.resolution,
        (grid.origin.x, grid.origin.y, grid.origin.theta),
        False,
        OCCUPIED_THRESH,
        FREE_THRESH,
        mode,
    )
    template = plain_pgm((1, 1))
    cells = cells_of(Pnm(template.content, template.kind, 255, template.begin, pixels[:, :, None]), file)
    keys = {"resolution": file.resolution, "origin": list(file.origin)}
    return header_of(path, cells, keys, None, mode), cells.codes


def save_map(project: Project, path: str, header: Mapping[str, Any], sent: bytes) -> str:
    """Write what was changed and return the new version; raise Conflict where the map has another one than the header
    says.

    ``rectangles`` of the header are left, top, width, height, in cells from the upper left corner; ``sent`` has their
    codes, one after the other, which stand for the pixels ``samples``. A file in which nothing is different is not
    written. A map that was cropped or enlarged has another ``width`` or ``height`` than the file, and one rectangle,
    the whole of it.
    """
    opened = open_map(project, path)
    if opened is None:
        raise InputFileError(f"{path}: cannot be changed without loss; allowed: keep it as a map of another name")
    if header.get("version") != opened.version:
        raise Conflict(f"{path} was changed by someone else since it was read")
    image = _changed_image(opened.image, header, sent)
    text = with_values(_map_text(opened), _changed_keys(opened.file, header), path).encode()
    versions = [opened.text.version, opened.image_text.version]
    if image is not None:
        versions[1] = project.write(opened.image_path, image, opened.image_text.version)
    if text != opened.text.content:
        versions[0] = project.write(path, text, opened.text.version)
    return ".".join(versions)


def copy_map(project: Project, path: str, header: Mapping[str, Any], sent: bytes) -> dict[str, str]:
    """Write all cells as a map of a new name and return its path and version; raise Conflict where there is one
    already.

    It is a map like that of ``like`` in the header, with its mode, comments and kind of image, or, without one, as
    map_saver writes it.
    """
    path = path if Path(path).suffix in ROS else f"{path}.yaml"
    like = header.get("like")
    opened = open_map(project, like) if isinstance(like, str) else None
    template: Pnm | Picture = opened.image if opened else plain_pgm((1, 1))
    image_path = str(PurePosixPath(path).with_suffix(_image_ending(opened)))
    text = _map_text(opened) if opened else _new_text(header)
    values: dict[str, Value] = {**_header_keys(header), "image": posixpath.basename(image_path)}
    shape = _read_count(header, "height"), _read_count(header, "width")
    samples = check_samples(header.get("samples"), template)
    codes = _read_codes(sent, 0, shape[0] * shape[1], len(samples)).reshape(shape)
    content = template.encode_samples(samples[codes])
    for name in (path, image_path):
        if project.path(name).exists():
            raise Conflict(f"{name} is there already")
    project.path(path).parent.mkdir(parents=True, exist_ok=True)
    image_version = project.write(image_path, content, None)
    version = project.write(path, with_values(text, values, path).encode(), None)
    return {"path": path, "image": image_path, "version": f"{version}.{image_version}"}


def _map_text(opened: OpenMap) -> str:
    try:
        return opened.text.content.decode("utf-8")
    except UnicodeDecodeError:
        raise InputFileError(f"{opened.path}: is no text in UTF-8; allowed: a map's YAML file") from None


def _new_text(header: Mapping[str, Any]) -> str:
    """Return the YAML of a map without a model, in the mode that the header says."""
    value = 50 if header.get("mode") == "raw" else 0
    return map_text(OccupancyGrid(np.full((1, 1), value, np.int8), 1.0, Pose(0.0, 0.0)), "")[1]


def _image_ending(opened: OpenMap | None) -> str:
    return ".pgm" if opened is None else Path(opened.image_path).suffix


def _changed_keys(file: MapFile, header: Mapping[str, Any]) -> dict[str, Value]:
    old: dict[str, Value] = {"resolution": file.resolution, "origin": list(file.origin)}
    return {key: value for key, value in _header_keys(header).items() if value != old[key]}


def _header_keys(header: Mapping[str, Any]) -> dict[str, Value]:
    """Return the keys of the YAML that the header has other values for."""
    found: dict[str, Value] = {}
    if "resolution" in header:
        found["resolution"] = _finite_values(header, "resolution", [header["resolution"]])[0]
        if not found["resolution"] > 0.0:  # type: ignore[operator]
            raise InputFileError(f"resolution is {found['resolution']}; allowed: > 0 (m a cell)")
    if "origin" in header:
        found["origin"] = _finite_values(header, "origin", header["origin"])
        if len(found["origin"]) != 3:  # type: ignore[arg-type]
            raise InputFileError("origin is not three numbers; allowed: x, y (m) and yaw (rad)")
    return found


def _finite_values(header: Mapping[str, Any], key: str, values: Any) -> list[float]:
    fits = isinstance(values, list) and all(
        isinstance(one, int | float) and not isinstance(one, bool) for one in values
    )
    if not fits or not np.isfinite(np.array(values, np.float64)).all():
        raise InputFileError(f"{key} is {one_line(str(header[key]), 60)}; allowed: finite numbers")
    return [float(one) for one in values]


def _read_count(header: Mapping[str, Any], key: str) -> int:
    value = header.get(key)
    if not isinstance(value, int) or isinstance(value, bool) or not 0 < value <= LIMITS.cells:
        raise InputFileError(f"{key} is {value!r}; allowed: a whole number of cells, up to {LIMITS.cells} in all")
    return value


def _changed_image(image: Pnm | Picture, header: Mapping[str, Any], sent: bytes) -> bytes | None:
    """Return the image's new content;

    None where no pixel is another one. Cells that were not sent keep their pixels, sample for sample.
    """
    if not header.get("rectangles"):
        return None
    samples = check_samples(header.get("samples"), image)
    rows, columns = _map_shape(image, header)
    pixels, begin = _make_canvas(image, (rows, columns), header["rectangles"]), 0
    for left, top, width, height in _read_rectangles(header, columns, rows):
        codes = _read_codes(sent, begin, width * height, len(samples)).reshape(height, width)
        pixels[top : top + height, left : left + width] = samples[codes].astype(pixels.dtype, copy=False)
        begin += width * height
    return None if np.array_equal(pixels, image.samples) else image.encode_samples(pixels)


def _map_shape(image: Pnm | Picture, header: Mapping[str, Any]) -> tuple[int, int]:
    """Return the rows and columns that a map has now: those of its file unless the header says otherwise."""
    rows, columns = image.samples.shape[:2]
    shape = (
        _read_count(header, "height") if "height" in header else rows,
        _read_count(header, "width") if "width" in header else columns,
    )
    if shape[0] * shape[1] > LIMITS.cells:
        raise InputFileError(f"the map has {shape[1]} x {shape[0]} cells; allowed: {LIMITS.cells} in all")
    return shape


def _make_canvas(image: Pnm | Picture, shape: tuple[int, int], rectangles: Any) -> Samples:
    """Return what the rectangles are drawn on: the pixels of the file, or nothing where the map has another size."""
    if shape == image.samples.shape[:2]:
        return image.samples.copy()
    if rectangles != [[0, 0, shape[1], shape[0]]]:
        raise InputFileError(
            f"rectangles is not the whole of {shape[1]} x {shape[0]} cells; allowed: that, for a map of another size"
        )
    return np.zeros((*shape, image.samples.shape[2]), image.samples.dtype)


def _read_codes(sent: bytes, begin: int, count: int, most: int) -> NDArray[np.uint8]:
    codes = np.frombuffer(sent[begin : begin + count], np.uint8)
    if len(codes) < count or codes.max(initial=0) >= most:
        raise InputFileError(f"cells are missing or have no sample; allowed: {count} codes below {most}")
    return codes


def _read_rectangles(header: Mapping[str, Any], columns: int, rows: int) -> list[tuple[int, int, int, int]]:
    found = read_settings(header["rectangles"], list[list[int]], "rectangles")
    for one in found:
        if len(one) != 4 or min(one) < 0 or one[0] + one[2] > columns or one[1] + one[3] > rows or not one[2] * one[3]:
            raise InputFileError(
                f"rectangles has {one}; allowed: left, top, width, height inside {columns} x {rows} cells"
            )
    return [tuple(one) for one in found]  # type: ignore[misc]
