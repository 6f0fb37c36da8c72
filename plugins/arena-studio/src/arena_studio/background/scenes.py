"""Scenario files for the page: what a project has, one of them as the suite's own model, what
is impossible in it, other formats.
"""

from __future__ import annotations

import base64
import gzip
import math
import os
import posixpath
import re
from collections.abc import Mapping
from functools import lru_cache
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from arena_core import ArenaError, InputFileError, OccupancyGrid, Pose
from arena_core.files import option_files, options_of
from arena_core.hosting import load_registry
from arena_core.records import robot_meta
from arena_core.scenes import furniture_kind, furniture_shapes
from arena_studio.allowed_overrides import check_overrides
from arena_studio.background.requests import (
    CheckScenes,
    ExportScene,
    ListScenarios,
    MapCells,
    OpenScenario,
    ScenarioText,
    SceneKinds,
)
from arena_tasks.commands.packing import ANYBODY
from arena_tasks.scenario_files.arena_rosnav_writer import arena_rosnav_text, world_name
from arena_tasks.scenario_files.arena_rosnav_writer import unsupported_parts as left_out_by_arena_rosnav
from arena_tasks.scenario_files.arena_tools_writer import arena_tools_text, flatland_model_text, unsupported_parts
from arena_tasks.scenario_files.feasibility import Finding
from arena_tasks.scenario_files.json_fields import Field, read_json
from arena_tasks.scenario_files.problem import reading_notes
from arena_tasks.scenario_files.scenario_file import FORMAT, VERSION, content_of, format_of, read_content, scenario_text
from arena_tasks.scenario_files.site import Site, compose_run
from arena_worlds.formats.ros_map import load_map
from arena_worlds.formats.scenario_map import find_map

MOST_FINDINGS = 100
FREE, OCCUPIED, UNKNOWN = 0, 1, 2
PLACE = re.compile(r"scenarios\[(\d+)\][^\s:]*")
KINDS = ("robot", "planner", "pedestrians", "world")


def scene_kinds(_: SceneKinds) -> dict[str, Any]:
    """Return what a scenario can be made of: names of components, shapes of furniture, and what behaviour may say."""
    manager = load_registry().manager
    names = {kind: [name for name in options_of(kind, manager) if "/" not in name] for kind in KINDS}
    pieces = {name: furniture_kind(name).at(name, Pose(0.0, 0.0, 0.0)) for name in option_files("furniture", manager)}
    behaviour = yaml.safe_load((files("arena_studio") / "behaviour.yaml").read_text(encoding="utf-8"))
    return {
        **names,
        "furniture": {name: furniture_shapes([piece]) for name, piece in pieces.items()},
        "behaviour": behaviour,
    }


def list_scenarios(request: ListScenarios) -> list[dict[str, Any]]:
    """Return those of the files that are scenario files, in any format, with their number of scenes or their error."""
    return [row for row in map(_file_row, request.names) if row]


def _file_row(name: str) -> dict[str, Any] | None:
    try:
        root = read_json(Path(name).absolute())
        written = format_of(root) if isinstance(root.value, dict) else ""
    except ArenaError:
        return None  # some other JSON, or none at all
    if not written:
        return None
    try:
        file = read_content(root, ANYBODY)
    except ArenaError as error:
        return {"path": name, "format": written, "error": str(error).removeprefix(f"{root.file}: ")}
    return {
        "path": name,
        "format": written,
        "title": file.title,
        "scenes": len(file.problems),
        "map": _map_of(name, root),
    }


def open_scenario(request: OpenScenario) -> dict[str, Any]:
    """Return a scenario file as the page holds it; raise InputFileError."""
    return read_scenario(request.path)


def read_scenario(name: str) -> dict[str, Any]:
    """Return a file's content in our format, what of it was read otherwise, and its map, relative to the
    project; raise InputFileError.
    """
    root = read_json(Path(name).absolute())
    file = read_content(root, ANYBODY)
    written = format_of(root)
    content = _upgrade_content(root.value) if written == FORMAT else content_of(file.problems, file.title)
    return {"format": written, "content": content, "notes": reading_notes(file.problems), "map": _map_of(name, root)}


def _upgrade_content(content: dict[str, Any]) -> dict[str, Any]:
    """Return a content of ours in today's version; what a file leaves open stays open."""
    people = [person for scene in content["scenarios"] for person in scene.get("pedestrians", [])]
    for person in people:
        if "max_speed" in person:
            person["desired_speed"] = person.pop("max_speed")
    return {**content, "version": VERSION}


def _map_of(name: str, root: Field) -> str | None:
    """Return the map that a file names, relative to the project; None where it names
    none, or none inside the project.
    """
    here = Path.cwd()
    if format_of(root) == FORMAT:
        said = root.value.get("map", "")
        inside = posixpath.normpath(posixpath.join(posixpath.dirname(name), said)) if said else ""
        return inside if inside and not inside.startswith(("..", "/")) else None
    try:
        found = find_map(root.file, here)
    except ArenaError:
        return None
    return found.resolve().relative_to(here).as_posix() if found.resolve().is_relative_to(here) else None


def scenario_file_text(request: ScenarioText) -> str:
    """Return the text of a file of ours; raise InputFileError."""
    return content_text(request.path, request.content)


def content_text(name: str, content: Any) -> str:
    """Return the text of a file of ours; raise InputFileError, which names the key,
    where it could not be read again.
    """
    read_content(Field(Path(name), "", content), ANYBODY)
    return scenario_text(content)


def map_cells(request: MapCells) -> dict[str, Any]:
    """Return a map: resolution m, origin [x, y, theta], cells by rows from below (0 free, 1 occupied, 2
    unknown), gzip in base64.
    """
    return cells_of(load_map(Path(request.path).absolute()))


def cells_of(grid: OccupancyGrid) -> dict[str, Any]:
    """Return a grid as the page has it."""
    cells = np.full(grid.data.shape, FREE, np.uint8)
    cells[grid.data < 0] = UNKNOWN
    cells[grid.occupied] = OCCUPIED
    packed = base64.b64encode(gzip.compress(cells.tobytes(), compresslevel=4, mtime=0)).decode()
    return {
        "resolution": grid.resolution,
        "origin": grid.origin.array().tolist(),
        "shape": list(cells.shape),
        "cells": packed,
    }


def check_scenes(request: CheckScenes) -> dict[str, Any]:
    """Return everything that keeps scenes from being run, by scene, key and place, and the body of the
    robot that they are checked for.
    """
    try:
        file = read_content(Field(Path(request.path), "", request.content), ANYBODY)
    except InputFileError as error:
        return {"findings": [_error_finding(request.path, error)], "robot": None}
    changed = Path(request.map).stat().st_mtime_ns if request.map else 0
    site = scene_site(request.map, changed, request.robot, request.pedestrians)
    found = [
        _finding_row(number, finding)
        for number, problem in enumerate(file.problems)
        for finding in site.findings(problem)
    ]
    return {"findings": found[:MOST_FINDINGS], "robot": robot_meta(site.robot)}


@lru_cache(maxsize=8)
def scene_site(map_file: str, _: int, robot: str, pedestrians: str) -> Site:
    """Return where scenes are checked; without a map in an empty room of its usual size."""
    overrides = [*world_of(map_file), f"robot={robot}", f"pedestrians={pedestrians}"]
    return Site(Path("scenario.json"), compose_run(Path("scenario.json"), check_overrides(overrides, Path.cwd())))


def world_of(map_file: str) -> list[str]:
    """Return the overrides that choose a map."""
    return (
        ["world=ros_map", f"world.path={quote_text(str(Path(map_file).absolute()))}"] if map_file else ["world=empty"]
    )


def quote_text(value: str) -> str:
    """Return a text as Hydra's grammar has it."""
    return "'" + value.replace("\\", "\\\\").replace("'", "\\'") + "'"


def _finding_row(number: int, finding: Finding) -> dict[str, Any]:
    place = [finding.x, finding.y] if math.isfinite(finding.x) else None
    return {"scene": number, "key": finding.key or f"scenarios[{number}]", "place": place, "line": finding.why}


def _error_finding(name: str, error: InputFileError) -> dict[str, Any]:
    """Return an error of reading as a finding: where it is, if it says so."""
    line = str(error).removeprefix(f"{name}: ")
    found = PLACE.match(line)
    return {"scene": int(found[1]) if found else 0, "key": found[0] if found else "", "place": None, "line": line}


def export_scene(request: ExportScene) -> dict[str, Any]:
    """Return the files, text by name, that one scene is in another program's format, and what that has no place for."""
    scene, target = request.scene, request.target
    problems = read_content(Field(Path(request.path), "", request.content), ANYBODY).problems
    if not 0 <= scene < len(problems):
        raise InputFileError(f"scene is {scene}; allowed: 0 .. {len(problems) - 1}")
    problem, base = problems[scene], posixpath.splitext(target)[0]
    stems = [f"{posixpath.basename(base)}.obstacle_{number}" for number in range(len(problem.obstacles))]
    models = {
        posixpath.join(posixpath.dirname(target), f"{stem}.model.yaml"): obstacle
        for stem, obstacle in zip(stems, problem.obstacles, strict=True)
    }
    texts = {path: flatland_model_text(obstacle) for path, obstacle in models.items()}
    if request.format == "arena-tools":
        said = os.path.relpath(request.map, posixpath.dirname(target) or ".") if request.map else ""
        texts[target] = arena_tools_text(problem, said, [f"{stem}.model.yaml" for stem in stems])
        return {"texts": texts, "left_out": unsupported_parts(problem)}
    if request.format == "arena-rosnav":
        texts[target] = arena_rosnav_text(problem, world_name(request.map), stems)
        return {"texts": texts, "left_out": left_out_by_arena_rosnav(problem)}
    raise InputFileError(f"format is {request.format}; allowed: arena-tools, arena-rosnav")


def single_scene(content: Mapping[str, Any], scene: int) -> dict[str, Any]:
    """Return a content of one of its scenes alone; raise InputFileError where there is no such one."""
    scenes = content.get("scenarios")
    if not isinstance(scenes, list) or not 0 <= scene < len(scenes):
        raise InputFileError(f"scene is {scene}; allowed: one of the file's")
    return {**content, "scenarios": [scenes[scene]]}
