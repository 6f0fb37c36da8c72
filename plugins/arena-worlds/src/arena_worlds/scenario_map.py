"""The map that a scenario file names; one of arena-tools is looked up below a folder of maps, for its path belongs to another machine."""

from __future__ import annotations

import glob
import json
from collections.abc import Mapping
from pathlib import Path, PurePosixPath

from arena_core import ConfigurationError, InputFileError, World, WorldSource
from arena_worlds.map_yaml import quoted
from arena_worlds.ros_map import load_map

OURS = "arena-scenario"  # the format of files whose map is no stranger
LARGEST_FILE = 50_000_000  # bytes
DEEPEST = 4  # folders between that of the maps and a map's own
INSTEAD = "or give the map by world=ros_map world.path=MAP.yaml"


class ScenarioMap(WorldSource):
    """The same map for every scenario: that which the file ``scenario`` names, looked up below ``maps``."""

    def __init__(self, scenario: str | None, maps: str | None, known: bool) -> None:
        if scenario is None:
            raise ConfigurationError("world.scenario is null, and so is task.path; allowed: a scenario file of arena-tools")
        path = find_map(Path(scenario), None if maps is None else Path(maps))
        self._world = World(f"{path.resolve().parent.name}/{path.stem}", load_map(path), known)

    def world(self, seed: int, index: int) -> World:
        """Return the map, whatever the scenario."""
        return self._world


def find_map(scenario: Path, maps: Path | None) -> Path:
    """Return the map of a scenario: FOLDER/FILE, the end of its map_path, anywhere below ``maps``.

    Where ``maps`` is None, the path as it stands counts first, then the folder maps beside the scenario or beside its folder. The
    ``map`` of a file in our own format lies where it says, seen from the file. Raises InputFileError that says what was looked for
    and where, or that it is there more than once.
    """
    keys = _keys(scenario)
    if keys.get("format") == OURS and isinstance(keys.get("map"), str):
        return scenario.parent / str(keys["map"])
    stated = _map_path(scenario, keys.get("map_path"))
    if maps is None and Path(stated).is_file():
        return Path(stated)
    folders = [maps] if maps is not None else [scenario.parent / "maps", scenario.resolve().parent.parent / "maps"]
    wanted = f"{stated.parent.name}/{stated.name}"
    for folder in folders:
        found = [path for depth in range(DEEPEST) for path in sorted(folder.glob("*/" * depth + glob.escape(wanted)))]
        if len(found) > 1:
            places = ", ".join(map(str, found))
            raise InputFileError(f"{scenario}: map_path: {wanted} is there {len(found)} times ({places}); allowed: once, {INSTEAD}")
        if found:
            return found[0]
    places = ", ".join(map(str, folders))
    raise InputFileError(f"{scenario}: map_path: no {wanted} below {places}; allowed: world.maps=FOLDER with such a map, {INSTEAD}")


def _keys(scenario: Path) -> Mapping[str, object]:
    try:
        with scenario.open("rb") as file:
            content = file.read(LARGEST_FILE + 1)
        keys = json.loads(content) if len(content) <= LARGEST_FILE else None
    except OSError as error:
        raise InputFileError(f"{scenario}: cannot be read ({error.strerror}); allowed: a scenario file of arena-tools") from None
    except (ValueError, RecursionError) as error:
        raise InputFileError(f"{scenario}: is no JSON ({error}); allowed: a scenario file of arena-tools") from None
    return keys if isinstance(keys, dict) else {}


def _map_path(scenario: Path, stated: object) -> PurePosixPath:
    """Return a stated path, which must have a folder and a file name; raise InputFileError."""
    path = PurePosixPath(stated.replace("\\", "/")) if isinstance(stated, str) and "\0" not in stated else PurePosixPath()
    if path.name in ("", "..") or path.parent.name in ("", ".."):
        raise InputFileError(f"{scenario}: map_path is {quoted(stated)}; allowed: the path of a map, FOLDER/FILE.yaml, {INSTEAD}")
    return path
