"""Curricula and scenario packs for the page: what a project has of them, whether they hold, and
packs made of chosen files.
"""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path, PurePosixPath
from typing import Any

import yaml

from arena_core import ArenaError, InputFileError
from arena_core.files import read_bytes, write_bytes_whole
from arena_studio.background.requests import CheckLevels, CurriculumLevels, ListCurricula, ListPacks, MakePack
from arena_studio.background.scenes import content_text, read_scenario
from arena_studio.project import Project
from arena_tasks.commands.packing import make_pack, write_options
from arena_tasks.random.curriculum import Level, built_in, curriculum_of, curriculum_text, read_curriculum, read_level
from arena_tasks.scenario_files.json_fields import Field
from arena_tasks.scenario_files.pack import PACK_FILE, read_pack
from arena_tasks.scenario_files.yaml_fields import read_yaml
from arena_worlds.formats.map_yaml import read_map_yaml

LARGEST_IMAGE = 100_000_000  # bytes
SHOWN = "curriculum"  # what a curriculum is called that is no file yet


def list_curricula(request: ListCurricula) -> dict[str, Any]:
    """Return the curricula of a project, those that come with the suite, and their numbers of levels."""
    rows = [row for row in map(_curriculum_row, request.names) if row]
    return {
        "files": rows,
        "built_in": [{"path": name, "levels": len(read_curriculum(name).levels)} for name in built_in()],
    }


def _curriculum_row(name: str) -> dict[str, Any] | None:
    try:
        root = read_yaml(Path(name).absolute(), "a curriculum")
        if not isinstance(root.value, dict) or list(root.value) != ["levels"]:
            return None  # some other YAML
    except ArenaError:
        return None
    try:
        return {"path": name, "levels": len(curriculum_of(root).levels)}
    except ArenaError as error:
        return {"path": name, "error": str(error).removeprefix(f"{root.file}: ")}


def curriculum_levels(request: CurriculumLevels) -> list[dict[str, Any]]:
    """Return the levels of a curriculum, by its file or its built-in name; raise InputFileError."""
    name = request.name if request.name in built_in() else str(_current_project().path(request.name))
    return [_level_row(level) for level in read_curriculum(name).levels]


def _level_row(level: Level) -> dict[str, Any]:
    """Return a level as files have it; distances only where they are said."""
    said = {key: value for key, value in asdict(level).items() if key != "key"}
    return {key: value for key, value in said.items() if value is not None or key == "difficulty"}


def check_levels(request: CheckLevels) -> dict[str, Any]:
    """Return what is wrong with each level, and the file's text where nothing is."""
    rows = request.rows
    findings = [found for number, row in enumerate(rows) if (found := _level_error(number, row))]
    if not rows:
        findings = [{"level": 0, "key": "", "line": "there is no level; allowed: at least one"}]
    return {"findings": findings, "text": None if findings else curriculum_text(rows)}


def _level_error(number: int, row: Any) -> dict[str, Any] | None:
    try:
        read_level(Field(Path(SHOWN), f"levels.{number}", row))
    except InputFileError as error:
        line = str(error).removeprefix(f"{SHOWN}: ")
        key = line.partition(" ")[0].rpartition(".")[2]
        return {"level": number, "key": key if isinstance(row, dict) and key in line else "", "line": line}
    return None


def list_packs(request: ListPacks) -> list[dict[str, Any]]:
    """Return the packs whose pack.yaml is among the files, what is in them, and why one cannot be run."""
    return [_pack_row(Path(name).parent) for name in request.names if PurePosixPath(name).name == PACK_FILE]


def _pack_row(folder: Path) -> dict[str, Any]:
    row: dict[str, Any] = {"folder": folder.as_posix()}
    try:
        found = read_pack(folder.absolute())
        row |= {"id": found.id, "version": found.version, "title": found.title, "licence": found.licence}
        row["files"] = sorted(found.files)
        found.check()
        row["scenarios"] = [_pack_file(folder, name) for name in found.scenario_files()]
    except ArenaError as error:
        row["error"] = str(error)
    return row


def _pack_file(folder: Path, name: str) -> dict[str, Any]:
    content = read_scenario((folder / name).as_posix())["content"]
    return {"name": name, "scenes": len(content["scenarios"]), "title": content.get("title", "")}


def make_scenario_pack(request: MakePack) -> dict[str, Any]:
    """Make a pack of scenario files and their maps, copied below ``folder``; return what it holds and what runs it.

    Raises InputFileError where a file names no map, or a place is taken by something else.
    """
    target = Path(request.folder)
    for name in request.files:
        _copy_scenario(target, name)
    said = request.model_dump(include={"id", "version", "title", "licence"})
    made = make_pack(target.absolute(), {key: value for key, value in said.items() if value})
    options = write_options(made, _current_project().path(f"conf/scenario/{made.id}"), target.as_posix())
    return {**_pack_row(target), "options": [f"scenario={made.id}/{option}" for option in options]}


def _copy_scenario(target: Path, name: str) -> None:
    """Copy a scenario file and its map into a pack; one that lies there already stays."""
    if Path(name).is_relative_to(target):
        return
    found = read_scenario(name)
    if not found["map"]:
        raise InputFileError(f"{name}: names no map of this project; allowed: a scenario file with a map")
    content = {**found["content"], "map": f"../maps/{_copy_map(target, found['map'])}"}
    _write_new(target / "scenarios" / f"{Path(name).stem}.json", content_text(name, content).encode())


def _copy_map(target: Path, name: str) -> str:
    """Copy a map and its image; return what its YAML file is called there."""
    path = Path(name)
    image = read_map_yaml(path.absolute()).image
    stem = path.parent.name if path.stem == "map" and path.parent.name else path.stem
    said = dict(read_yaml(path.absolute(), "a map").value)
    said["image"] = f"{stem}{image.suffix}"
    _write_new(target / "maps" / said["image"], read_bytes(image, LARGEST_IMAGE, "an image", unpack=False))
    _write_new(target / "maps" / f"{stem}.yaml", yaml.safe_dump(said, sort_keys=False).encode())
    return f"{stem}.yaml"


def _write_new(path: Path, content: bytes) -> None:
    """Write a file of the project; raise InputFileError where there is another one."""
    path = _current_project().path(path.as_posix())
    if path.exists() and read_bytes(path, LARGEST_IMAGE, "a file", unpack=False) != content:
        raise InputFileError(
            f"{path}: is there already, with other content; allowed: another folder, or a file of another name"
        )
    path.parent.mkdir(parents=True, exist_ok=True)
    write_bytes_whole(path, content)


def _current_project() -> Project:
    return Project(Path.cwd())
