"""The maps of a Flatland world: the YAML file of layers, as arena-tools' map generator writes
it beside a map_server map.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from arena_core import InputFileError
from arena_core.commands import print_notice
from arena_worlds.formats.map_yaml import quote_value, read_mapping

ENDING = ".world.yaml"
ALLOWED = "layers, each with the map: of a map_server YAML"


def map_yamls_of(path: Path) -> list[Path]:
    """Return the map_server YAMLs that ``path`` stands for: itself, those of a Flatland world's layers, or that of a
    folder.

    A folder's map is that of its map.world.yaml, else its map.yaml, else its only file that ends in .world.yaml. A file
    is a Flatland world when it has layers and no image; where it has both or neither, by its name. Raises
    InputFileError for a world without a map.
    """
    path = _in_folder(path) if path.is_dir() else path
    if not _is_world(path):
        return [path]
    keys = read_mapping(path, ALLOWED)
    if keys.get("models"):
        print_notice(f"{path}: models are not read, only layers; models belong into the scenario, as obstacles")
    return [path.parent / name for name in dict.fromkeys(_layer_maps(path, keys.get("layers")))]


def _in_folder(folder: Path) -> Path:
    worlds = sorted(folder.glob(f"*{ENDING}"))
    usual = [folder / f"map{ENDING}", folder / "map.yaml", *(worlds if len(worlds) == 1 else [])]
    return next((path for path in usual if path.is_file()), folder / "map.yaml")


def _is_world(path: Path) -> bool:
    """Return whether a file is a Flatland world by its keys, or by its name where these do not tell."""
    named = path.name.endswith(ENDING)
    try:
        keys = read_mapping(path, ALLOWED)
    except InputFileError:
        return named  # the reader of maps or that of worlds says it better
    return "layers" in keys if ("layers" in keys) != ("image" in keys) else named


def _layer_maps(path: Path, layers: Any) -> list[str]:
    """Return the names of the maps of all layers; a layer without a map has nothing in it."""
    if not isinstance(layers, list) or not all(isinstance(layer, Mapping) for layer in layers):
        raise InputFileError(f"{path}: layers is {quote_value(layers)}; allowed: {ALLOWED}")
    maps = [layer["map"] for layer in layers if "map" in layer]
    if not maps or not all(isinstance(name, str) and name for name in maps):
        raise InputFileError(f"{path}: layers have the maps {quote_value(maps)}; allowed: {ALLOWED}")
    return maps
