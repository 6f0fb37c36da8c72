"""A world from one file: a map, a picture, a Gazebo world or a MuJoCo model."""

from __future__ import annotations

from pathlib import Path

from arena_core import ConfigurationError, World, WorldSource
from arena_core.parameters import NonNegative, Positive
from arena_worlds.formats.site_file import site_grid


class FileWorld(WorldSource):
    """The same world for every scenario; ``resolution`` m and ``margin`` m count
    where the file has no cells of its own.
    """

    def __init__(self, path: str | None, resolution: Positive, margin: NonNegative, *, known: bool) -> None:
        if path is None:
            raise ConfigurationError(
                "world.path is null; allowed: a map, picture, Gazebo world or MuJoCo model, as in world.path=hall.sdf"
            )
        file = Path(path)
        self._world = World(
            f"{file.resolve().parent.name}/{file.name.split('.')[0]}", site_grid(file, resolution, margin), known
        )

    def world(self, seed: int, index: int) -> World:
        """Return the world, whatever the scenario."""
        return self._world
