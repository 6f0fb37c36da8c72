"""A world from a ROS map: map_server YAML and image."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path

from arena_core import ConfigurationError, OccupancyGrid, Pose, World, WorldSource
from arena_core.files import local_path
from arena_worlds.formats.flatland_world import map_yamls_of
from arena_worlds.formats.line_segments import LineFile, line_grid, read_line_yaml
from arena_worlds.formats.map_image import read_occupancy
from arena_worlds.formats.map_merge import merge_maps
from arena_worlds.formats.map_yaml import MapFile, read_map_yaml


class RosMap(WorldSource):
    """The same map for every scenario; the robot is given it if ``known``."""

    def __init__(self, path: str | None, *, known: bool) -> None:
        if path is None:
            raise ConfigurationError(
                "world.path is null; allowed: the YAML file of a map_server map, as in world.path=site.yaml"
            )
        yaml_path = local_path(path)
        self._world = World(f"{yaml_path.resolve().parent.name}/{yaml_path.stem}", load_map(yaml_path), known)

    def world(self, seed: int, index: int) -> World:
        """Return the map, whatever the scenario."""
        return self._world


def load_map(path: Path) -> OccupancyGrid:
    """Read a map, given by its YAML, a Flatland world or a folder; raise InputFileError. The layers of a Flatland world
    are merged.

    The grid object is the same again for as long as its files stay as they are.
    """
    maps = []
    for yaml_path in map_yamls_of(path):
        file = read_line_yaml(yaml_path) or read_map_yaml(yaml_path)
        written = (file.image if isinstance(file, MapFile) else file.data).stat()
        maps.append((file, written.st_mtime_ns, written.st_size))
    return _load_grid(tuple(maps), str(path))


@lru_cache(maxsize=16)
def _load_grid(maps: tuple[tuple[MapFile | LineFile, int, int], ...], name: str) -> OccupancyGrid:
    grids = [_load_layer(file) for file, _, _ in maps]
    return grids[0] if len(grids) == 1 else merge_maps(grids, name)


def _load_layer(file: MapFile | LineFile) -> OccupancyGrid:
    if isinstance(file, LineFile):
        return line_grid(file)
    return OccupancyGrid(read_occupancy(file), file.resolution, Pose(*file.origin))
