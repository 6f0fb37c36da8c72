"""The map that a scenario file names; those of arena-tools and arena-rosnav are looked up, for their paths
belong to another machine.
"""

from __future__ import annotations

import glob
from collections.abc import Mapping, Sequence
from pathlib import Path, PurePosixPath

from arena_core import ConfigurationError, InputFileError, World, WorldSource
from arena_core.files import is_file, read_json
from arena_worlds.formats.map_yaml import quote_value
from arena_worlds.formats.ros_map import load_map

OURS = "arena-scenario"  # the format of files whose map is no stranger
MAP_FOLDER, MAP_FILE = "map", "map.yaml"  # WORLD/map/map.yaml, as arena-simulation-setup has the map of a world
DEEPEST = 4  # folders between that of the maps and a map's own
INSTEAD = "or give the map by world=ros_map world.path=MAP.yaml"


class ScenarioMap(WorldSource):
    """The same map for every scenario: that which the file ``scenario`` names, looked up below ``maps``."""

    def __init__(self, scenario: str | None, maps: str | None, *, known: bool) -> None:
        if scenario is None:
            raise ConfigurationError(
                "world.scenario is null, and so is task.path; allowed: a scenario file that names its map"
            )
        path = find_map(Path(scenario), None if maps is None else Path(maps))
        self._world = World(f"{path.resolve().parent.name}/{path.stem}", load_map(path), known)

    def world(self, seed: int, index: int) -> World:
        """Return the map, whatever the scenario."""
        return self._world


def find_map(scenario: Path, maps: Path | None) -> Path:
    """Return the map of a scenario: FOLDER/FILE, the end of its map_path, or that of the world that it names, anywhere
    below ``maps``.

    Where ``maps`` is None, a map_path as it stands counts first, then the folders of ``_map_folders``. A file of any
    format that names no map has that of the world in whose folder it lies. The ``map`` of a file in our own format lies
    where it says, seen from the file. Raises InputFileError that says what was looked for and where, or that it is
    there more than once.
    """
    keys = _scenario_keys(scenario)
    stated = keys.get("map_path")
    if keys.get("format") == OURS and isinstance(keys.get("map"), str):
        return scenario.parent / str(keys["map"])
    if isinstance(keys.get("robots"), list) and "map_path" not in keys:
        return _look_up_map(scenario, "map", _maps_of_world(scenario, keys.get("map")), _map_folders(scenario, maps))
    if stated in (None, "") and _world_folder(scenario):
        return _look_up_map(scenario, "map_path", _maps_of_world(scenario, None), _map_folders(scenario, maps))
    path = _map_path(scenario, stated)
    if maps is None and is_file(Path(path)):
        return Path(path)
    return _look_up_map(scenario, "map_path", _path_endings(path), _map_folders(scenario, maps))


def _path_endings(path: PurePosixPath) -> list[str]:
    """Return how the path of a map may end here: WORLD/map/FILE and FOLDER/FILE mean the same
    world, whoever wrote them.
    """
    folder, world, file = path.parent.name, path.parent.parent.name, path.name
    if folder == MAP_FOLDER and world not in ("", ".."):
        return [f"{world}/{folder}/{file}", f"{world}/{file}", f"{folder}/{file}"]
    return [f"{folder}/{file}", f"{folder}/{MAP_FOLDER}/{file}"]


def _map_folders(scenario: Path, maps: Path | None) -> list[Path]:
    """Return where maps may lie: ``maps``; else maps beside the scenario or its folder, and the
    worlds that its own world is one of.
    """
    if maps is not None:
        return [maps]
    world = _world_folder(scenario)
    return [scenario.parent / "maps", scenario.resolve().parent.parent / "maps", *([world.parent] if world else [])]


def _world_folder(scenario: Path) -> Path | None:
    """Return WORLD of WORLD/scenarios/FILE or WORLD/scenarios/NAME/FILE, as arena-simulation-setup has it."""
    parents = scenario.resolve().parents
    return next((parents[k + 1] for k in range(2) if len(parents) > k + 1 and parents[k].name == "scenarios"), None)


def _maps_of_world(scenario: Path, name: object) -> list[str]:
    """Return where the map of a world may lie; raise InputFileError where neither the file nor
    its folder names a world.
    """
    folder = _world_folder(scenario)
    world = (
        PurePosixPath(name).name
        if isinstance(name, str) and "\0" not in name
        else folder.name
        if folder and name is None
        else ""
    )
    if world in ("", ".."):
        said = "map is missing" if name is None else f"map is {quote_value(name)}"
        raise InputFileError(f"{scenario}: {said}; allowed: the name of a world, {INSTEAD}")
    return [f"{world}/{MAP_FOLDER}/{MAP_FILE}", f"{world}/{MAP_FILE}"]


def _look_up_map(scenario: Path, key: str, wanted: Sequence[str], folders: Sequence[Path]) -> Path:
    """Return the one file that ends as wanted, the first of ``wanted`` in the first of ``folders`` that has it."""
    for folder in folders:
        for end in wanted:
            found = _files_below(folder, end)
            if len(found) > 1:
                places = ", ".join(map(str, found))
                raise InputFileError(
                    f"{scenario}: {key}: {end} is there {len(found)} times ({places}); allowed: once, {INSTEAD}"
                )
            if found:
                return found[0]
    places = ", ".join(map(str, folders))
    raise InputFileError(
        f"{scenario}: {key}: no {wanted[0]} below {places}; allowed: world.maps=FOLDER with such a map, {INSTEAD}"
    )


def _files_below(folder: Path, end: str) -> list[Path]:
    """Return the files in a folder, or a few folders deeper, that end so; a name that is too
    long for a file's is nowhere.
    """
    try:
        return [path for depth in range(DEEPEST) for path in sorted(folder.glob("*/" * depth + glob.escape(end)))]
    except OSError:
        return []


def _scenario_keys(scenario: Path) -> Mapping[str, object]:
    keys = read_json(scenario, "a scenario file that names its map")
    return keys if isinstance(keys, dict) else {}


def _map_path(scenario: Path, stated: object) -> PurePosixPath:
    """Return a stated path, which must have a folder and a file name; raise InputFileError."""
    path = (
        PurePosixPath(stated.replace("\\", "/")) if isinstance(stated, str) and "\0" not in stated else PurePosixPath()
    )
    if path.name in ("", "..") or path.parent.name in ("", ".."):
        raise InputFileError(
            f"{scenario}: map_path is {quote_value(stated)}; allowed: the path of a map, FOLDER/FILE.yaml, {INSTEAD}"
        )
    return path
