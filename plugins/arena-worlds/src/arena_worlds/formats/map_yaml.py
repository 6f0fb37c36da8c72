"""The YAML file of a map_server map: what it must say, and what is wrong with it."""

from __future__ import annotations

import math
import reprlib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, get_args

from arena_core import InputFileError
from arena_core.files import is_file, read_yaml

Mode = Literal["trinary", "scale", "raw"]
ROS2 = "/**", "ros__parameters"  # what files for ROS 2 may wrap all keys in
KEYS = "image, resolution, origin, negate, occupied_thresh, free_thresh, mode"


@dataclass(frozen=True, slots=True)
class MapFile:
    """What a map's YAML says:

    ``resolution`` m, ``origin`` (x, y, yaw) of the lower left corner, thresholds of occupancy in 0 .. 1.
    """

    image: Path
    resolution: float
    origin: tuple[float, float, float]
    negate: bool
    occupied_thresh: float
    free_thresh: float
    mode: Mode


def read_map_yaml(path: Path) -> MapFile:
    """Read and check a map's YAML; raise InputFileError with the file, the key and what is allowed."""
    keys = read_mapping(path, KEYS)
    found = MapFile(
        image=_image_path(path, keys),
        resolution=number_at(path, keys, "resolution"),
        origin=origin_at(path, keys),
        negate=_read_negate(path, keys),
        occupied_thresh=number_at(path, keys, "occupied_thresh"),
        free_thresh=number_at(path, keys, "free_thresh"),
        mode=_read_mode(path, keys),
    )
    if found.resolution <= 0.0:
        raise InputFileError(f"{path}: resolution is {found.resolution:g}; allowed: > 0 (m a cell)")
    if not 0.0 <= found.free_thresh <= found.occupied_thresh <= 1.0:
        raise InputFileError(
            f"{path}: free_thresh is {found.free_thresh:g} and occupied_thresh {found.occupied_thresh:g}; "
            "allowed: 0 <= free_thresh <= occupied_thresh <= 1"
        )
    return found


def read_mapping(path: Path, allowed: str) -> Mapping[str, Any]:
    """Read a YAML file of keys and values; raise InputFileError, which names ``allowed`` as what may be there."""
    keys = read_yaml(path, "the YAML file of a map_server map")
    for name in ROS2:
        keys = keys[name] if isinstance(keys, Mapping) and name in keys else keys
    if not isinstance(keys, Mapping):
        raise InputFileError(f"{path}: holds no keys; allowed: {allowed}")
    return keys


def quote_value(value: object) -> str:
    """Return a value as an error may quote it."""
    return reprlib.repr(value)


def _required_value(path: Path, keys: Mapping[str, Any], key: str, allowed: str) -> Any:
    if key not in keys:
        raise InputFileError(f"{path}: {key} is missing; allowed: {allowed}")
    return keys[key]


def _image_path(path: Path, keys: Mapping[str, Any]) -> Path:
    name = _required_value(path, keys, "image", "an image file, relative to this YAML")
    if not isinstance(name, str) or not name:
        raise InputFileError(f"{path}: image is {quote_value(name)}; allowed: an image file, relative to this YAML")
    image = path.parent / name
    if not is_file(image):
        raise InputFileError(
            f"{path}: image {name} is not there (looked for {image}); allowed: an image file, relative to this YAML"
        )
    return image


def number_at(path: Path, keys: Mapping[str, Any], key: str) -> float:
    """Return a finite number; raise InputFileError."""
    value = _required_value(path, keys, key, "a number")
    number = _as_number(value)
    if number is None:
        raise InputFileError(f"{path}: {key} is {quote_value(value)}; allowed: a finite number")
    return number


def _as_number(value: Any) -> float | None:
    """Return a finite number or None; a string may be one, for YAML 1.1 reads 5e-2 as text where ROS reads a number."""
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        return None
    try:
        number = float(value)
    except (ValueError, OverflowError):
        return None
    return number if math.isfinite(number) else None


def origin_at(path: Path, keys: Mapping[str, Any]) -> tuple[float, float, float]:
    """Return ``origin``, x, y (m) and yaw (rad); raise InputFileError."""
    value = _required_value(path, keys, "origin", "[x, y, yaw]")
    numbers = [_as_number(item) for item in value] if isinstance(value, list) else []
    match numbers:
        case [float() as x, float() as y, float() as yaw]:
            return x, y, yaw
    raise InputFileError(f"{path}: origin is {quote_value(value)}; allowed: [x, y, yaw] (m, m, rad)")


def _read_negate(path: Path, keys: Mapping[str, Any]) -> bool:
    value = _required_value(path, keys, "negate", "0 or 1")
    if value not in (0, 1):  # True and False among them
        raise InputFileError(f"{path}: negate is {quote_value(value)}; allowed: 0 or 1")
    return bool(value)


def _read_mode(path: Path, keys: Mapping[str, Any]) -> Mode:
    value = keys.get("mode", "trinary")
    for mode in get_args(Mode):
        if value == mode:
            return mode  # type: ignore[no-any-return]
    raise InputFileError(f"{path}: mode is {quote_value(value)}; allowed: trinary, scale or raw")
