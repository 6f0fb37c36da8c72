"""The map of a Flatland world: the YAML file of layers that arena-tools' map generator writes beside a map_server map."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from arena_core import InputFileError
from arena_worlds.map_yaml import quoted, read_mapping

ENDING = ".world.yaml"
ALLOWED = "layers, each with the map: of one map_server YAML"


def map_yaml_of(path: Path) -> Path:
    """Return the map_server YAML that ``path`` stands for: itself, the map of a Flatland world, or that of a folder.

    A folder's map is that of its map.world.yaml, else its map.yaml. Raises InputFileError for a world without a map, or with several.
    """
    if path.is_dir():
        world = path / f"map{ENDING}"
        path = world if world.is_file() else path / "map.yaml"
    if not path.name.endswith(ENDING):
        return path
    layers = read_mapping(path, ALLOWED).get("layers")
    if not isinstance(layers, list) or not all(isinstance(layer, Mapping) for layer in layers):
        raise InputFileError(f"{path}: layers is {quoted(layers)}; allowed: {ALLOWED}")
    maps = [layer["map"] for layer in layers if "map" in layer]
    if not maps or not all(isinstance(name, str) and name and name == maps[0] for name in maps):
        raise InputFileError(f"{path}: layers have the maps {quoted(maps)}; allowed: {ALLOWED}")
    return path.parent / str(maps[0])
