"""The API of the scenario editor: scenario files of the project, their maps, what is impossible
in them, and how they move.
"""

from __future__ import annotations

import posixpath
from typing import Annotated, Any

from fastapi import APIRouter, Header, Query

from arena_core import ArenaError
from arena_studio.background.process import LONG, SOON, side_processes
from arena_studio.background.requests import (
    CheckScenes,
    ExportScene,
    ListScenarios,
    MapCells,
    OpenScenario,
    PreviewScene,
    ScenarioText,
    SceneContent,
    SceneKinds,
)
from arena_studio.project import Project

Path = Annotated[str, Query(max_length=400)]
# of the file as it was read, "none" where it must not be there yet
Version = Annotated[str, Header(alias="If-Match", max_length=100)]


def make_router(project: Project) -> APIRouter:
    """Return the routes below /api/scenarios."""
    routes = APIRouter(prefix="/api/scenarios")
    side = side_processes(project.root)

    @routes.get("")
    def listed() -> Any:
        return side.files.ask(ListScenarios(names=project.files((".json",))), SOON)

    @routes.get("/kinds")
    def kinds() -> Any:
        return side.files.ask(SceneKinds(), SOON)

    @routes.get("/file")
    def opened(path: Path) -> Any:
        version = project.read(path).version
        return {"path": path, "version": version, **side.files.ask(OpenScenario(path=path), SOON)}

    @routes.put("/file")
    def saved(path: Path, content: dict[str, Any], version: Version) -> dict[str, str]:
        project.path(path)
        if not path.endswith(".json"):
            raise ArenaError(f"path is {path}; allowed: a name that ends in .json")
        text = side.files.ask(ScenarioText(path=path, content=content), SOON)
        return {"version": project.write(path, text.encode(), known_version(version))}

    @routes.get("/map")
    def map_cells(path: Path) -> Any:
        project.path(path)
        return side.files.ask(MapCells(path=path), SOON)

    @routes.post("/check")
    def checked(asked: CheckScenes) -> Any:
        return side.checks.ask(_inside(project, asked), LONG)

    @routes.post("/preview")
    def preview(asked: PreviewScene) -> Any:
        return side.long.ask(_inside(project, asked), LONG)

    @routes.post("/export")
    def exported(asked: ExportScene) -> dict[str, Any]:
        project.path(asked.target)
        made = side.files.ask(_inside(project, asked), SOON)
        # what it names comes first
        for path, text in sorted(made["texts"].items(), key=lambda row: row[0] == asked.target):
            project.write(path, text.encode(), None)
        return {"written": sorted(made["texts"]), "left_out": made["left_out"]}

    return routes


def known_version(version: str) -> str | None:
    """Return a version as the project has it."""
    return None if version == "none" else version


def _inside(project: Project, asked: SceneContent) -> SceneContent:
    """Return a request with its path as the project has it; raise ArenaError for one that leads out of the project."""
    project.path(asked.path)
    if asked.map:
        project.path(asked.map)
    return asked.model_copy(update={"path": posixpath.normpath(asked.path)})
