"""The API of the task editor: curricula, what rules of random problems draw, and scenario packs."""

from __future__ import annotations

from typing import Any

from fastapi import APIRouter

from arena_core import ArenaError
from arena_studio.background.process import LONG, SOON, side_processes
from arena_studio.background.requests import (
    CheckLevels,
    CurriculumLevels,
    DrawScenes,
    ListCurricula,
    ListPacks,
    MakePack,
    TaskRules,
)
from arena_studio.project import Project
from arena_studio.routers.scenarios import Path, Version, known_version

SUFFIXES = (".yaml", ".yml")
Row = dict[str, float | int | None]


def make_router(project: Project) -> APIRouter:
    """Return the routes below /api/curricula."""
    routes = APIRouter(prefix="/api/curricula")
    side = side_processes(project.root)

    @routes.get("")
    def listed() -> Any:
        return side.files.ask(ListCurricula(names=project.files(SUFFIXES)), SOON)

    @routes.get("/file")
    def opened(path: Path) -> dict[str, Any]:
        if "/" in path or path.endswith(SUFFIXES):
            version: str | None = project.read(path).version
        else:
            version = None  # one that comes with the suite
        return {"path": path, "version": version, "levels": side.files.ask(CurriculumLevels(name=path), SOON)}

    @routes.put("/file")
    def saved(path: Path, levels: list[Row], version: Version) -> dict[str, str]:
        project.path(path)
        if not path.endswith(SUFFIXES):
            raise ArenaError(f"path is {path}; allowed: a name that ends in .yaml or .yml")
        made = side.files.ask(CheckLevels(rows=levels), SOON)
        if made["findings"]:
            raise ArenaError(f"{path}: {made['findings'][0]['line']}")
        return {"version": project.write(path, made["text"].encode(), known_version(version))}

    @routes.post("/check")
    def checked(levels: list[Row]) -> Any:
        return side.files.ask(CheckLevels(rows=levels), SOON)

    @routes.post("/draws")
    def draws(asked: DrawScenes) -> Any:
        if asked.map:
            project.path(asked.map)
        return side.long.ask(asked, LONG)

    @routes.post("/rules")
    def kept(asked: TaskRules) -> dict[str, str]:
        text = side.files.ask(asked, SOON)
        path = f"conf/task/{asked.name}.yaml"
        return {"path": path, "version": project.write(path, text.encode(), None)}

    @routes.get("/packs")
    def packs() -> Any:
        return side.files.ask(ListPacks(names=project.files(SUFFIXES)), SOON)

    @routes.post("/packs")
    def pack(asked: MakePack) -> Any:
        for path in (asked.folder, *asked.files):
            project.path(path)
        return side.files.ask(asked, SOON)

    return routes
