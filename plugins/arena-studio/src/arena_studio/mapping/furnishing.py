"""Furniture around a map: its kinds, and the scenario files whose problems have pieces of it, for no map holds any."""

from __future__ import annotations

import json
import posixpath
from collections.abc import Mapping, Sequence
from typing import Any

from arena_core import InputFileError, Pose
from arena_core.commands import one_line
from arena_core.files import LIMITS, option_files
from arena_core.hosting import load_registry
from arena_core.scenes import furniture_kind, furniture_shapes
from arena_studio.errors import Conflict, Missing
from arena_studio.project import Document, Project
from arena_tasks.scenario_files.scenario_file import FORMAT, VERSION, scenario_text

HEAD = 2000  # characters of a file in which its format stands
ALLOWED = f"a file of the format {FORMAT}"


def furniture_kinds() -> dict[str, list[dict[str, Any]]]:
    """Return the outlines of each kind of furniture in its own frame, m: what hangs over
    (``overhang``) before what stands.
    """
    names = option_files("furniture", load_registry().manager)
    return {name: furniture_shapes([furniture_kind(name).at(name, Pose(0.0, 0.0))]) for name in names}


def scenario_files(project: Project, map_path: str) -> list[dict[str, Any]]:
    """Return the scenario files of a map: path, version, and name and furniture of each problem; files that
    cannot be read are left out.
    """
    found = []
    for path in project.files({".json"}):
        try:
            document = project.read(path)
            root = _read_content(document, path)
        except InputFileError:
            continue
        if _map_of(root, path) == map_path:
            problems = [{"name": str(one["name"]), "furniture": one.get("furniture", [])} for one in root["scenarios"]]
            found.append({"path": path, "version": document.version, "problems": problems})
    return found


def _read_content(document: Document, path: str) -> dict[str, Any]:
    """Return what one of our scenario files says; raise InputFileError for any other file."""
    if FORMAT.encode() not in document.content[:HEAD] or len(document.content) > LIMITS.json_bytes:
        raise InputFileError(f"{path}: is no scenario file; allowed: {ALLOWED}")
    try:
        root = json.loads(document.content)
    except (ValueError, RecursionError):
        root = None
    named = isinstance(root, dict) and isinstance(root.get("scenarios"), list)
    if not named or not all(isinstance(one, dict) and "name" in one for one in root["scenarios"]):
        raise InputFileError(f"{path}: is no scenario file; allowed: {ALLOWED}")
    return root  # type: ignore[no-any-return]


def _map_of(root: Mapping[str, Any], path: str) -> str:
    return posixpath.normpath(posixpath.join(posixpath.dirname(path), str(root.get("map", ""))))


def save_furniture(project: Project, path: str, version: str, problem: str, pieces: list[Any]) -> str:
    """Write the furniture of one problem of a scenario file, whose all else stays; return the file's new version.

    Raises Conflict where the file has another version, Missing where it has no such problem, InputFileError for what is
    no furniture.
    """
    document = project.read(path)
    if document.version != version:
        raise Conflict(f"{path} was changed by someone else since it was read")
    root = _read_content(document, path)
    found = next((one for one in root["scenarios"] if one["name"] == problem), None)
    if found is None:
        raise Missing(f"{path}: has no problem {one_line(problem, 60)!r}")
    found.pop("furniture", None)
    if pieces:
        found["furniture"] = _check_pieces(pieces)
    content = scenario_text({**root, "version": VERSION}).encode()
    return project.write(path, content, version)


def _check_pieces(pieces: list[Any]) -> list[dict[str, Any]]:
    if len(pieces) > LIMITS.furniture:
        raise InputFileError(f"furniture has {len(pieces)} pieces; allowed: up to {LIMITS.furniture}")
    kinds = option_files("furniture", load_registry().manager)
    for number, piece in enumerate(pieces):
        pose = piece.get("pose") if isinstance(piece, dict) else None
        placed = (
            isinstance(pose, list)
            and len(pose) == 3
            and all(isinstance(one, int | float) and abs(one) <= LIMITS.number_largest for one in pose)
        )
        if not placed or piece.get("kind") not in kinds:
            raise InputFileError(
                f"furniture[{number}] is {one_line(str(piece), 80)}; allowed: "
                f"a kind ({', '.join(kinds)}) and a pose [x, y, theta]"
            )
    return [{"kind": piece["kind"], "pose": [float(one) for one in piece["pose"]]} for piece in pieces]


def new_scenario(project: Project, path: str, map_path: str, ends: Sequence[list[float]], pieces: list[Any]) -> str:
    """Write a scenario file with one problem across a furnished map and return its version; raise Conflict where there
    is a file already.

    ``ends`` are start and goal.
    """
    start, goal = ends
    relative = posixpath.relpath(map_path, posixpath.dirname(path) or ".")
    problem = {
        "name": "furnished",
        "start": start,
        "goal": goal,
        "pedestrians": [],
        "obstacles": [],
        "furniture": _check_pieces(pieces),
    }
    content = {
        "format": FORMAT,
        "version": VERSION,
        "title": "A robot crosses a furnished hall",
        "map": relative,
        "scenarios": [problem],
    }
    return project.write(path, scenario_text(content).encode(), None)
