"""A line for each scenario of the installed packs: nothing is built but its map."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cache
from importlib.resources.abc import Traversable
from pathlib import Path
from typing import Any

import yaml

from arena_core import ArenaError, InputFileError
from arena_core.commands import align_columns
from arena_core.files import local_path
from arena_core.hosting import Registry
from arena_tasks.commands.packing import ANYBODY
from arena_tasks.scenario_files.content import content_hash
from arena_tasks.scenario_files.pack import hash_of, verified_pack
from arena_tasks.scenario_files.scenario_file import read_scenario_file

HEAD = ("scenario", "problems", "distance", "people", "world", "hash", "what it is")


def table_lines(options: Mapping[str, Traversable], registry: Registry) -> list[str]:
    """Return aligned lines, a head first."""
    reader = _Reader(registry)
    return align_columns([HEAD, *(reader.row(name, option) for name, option in options.items())])


class _Reader:
    """Reads each pack and each map once."""

    def __init__(self, registry: Registry) -> None:
        self._pack = cache(verified_pack)
        self._world = cache(
            lambda address: registry.build("world", {"name": "ros_map", "path": address, "known": True}).world(0, 0)
        )

    def row(self, name: str, option: Traversable) -> tuple[str, ...]:
        """Return the cells of a line, or the name and why the scenario cannot be run."""
        try:
            return (name, *self._scenario_cells(option))
        except ArenaError as error:
            return (name, str(error))

    def _scenario_cells(self, option: Traversable) -> tuple[str, ...]:
        path, map_address = scenario_path(option), _option_path(option, "world")
        pack = self._pack(path.parent)
        file = read_scenario_file(path, ANYBODY)
        distances = _format_range([problem.start.distance(problem.goal) for problem in file.problems], ".1f")
        people = _format_range([len(problem.pedestrians) for problem in file.problems], "d")
        digest = content_hash(hash_of(path), self._world(map_address).grid, pack)
        return (str(len(file.problems)), f"{distances} m", people, Path(map_address).stem, digest, file.title)


def scenario_path(option: Traversable) -> Path:
    """Return the scenario file of an option of ``scenario``; raise InputFileError where it names none."""
    return local_path(_option_path(option, "task"))


def _option_path(option: Traversable, kind: str) -> str:
    chosen: Any = yaml.safe_load(option.read_text("utf-8"))
    node = chosen.get(kind) if isinstance(chosen, dict) else None
    if not isinstance(node, dict) or not isinstance(node.get("path"), str):
        raise InputFileError(f"{option}: {kind}.path is missing; allowed: an option as `arena scenario pack` writes it")
    return str(node["path"])


def _format_range(values: Sequence[float], digits: str) -> str:
    low, high = format(min(values), digits), format(max(values), digits)
    return low if low == high else f"{low}-{high}"
