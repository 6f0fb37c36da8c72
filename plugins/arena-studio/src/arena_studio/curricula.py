"""The API of the task editor: curricula, what rules of random problems draw, and scenario packs."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from fastapi import APIRouter
from pydantic import BaseModel, Field

from arena_core import ArenaError
from arena_studio.project import Project
from arena_studio.scenarios import MapPath, Name, Path, Version, known_version
from arena_studio.side_process import LONG, SOON, side_processes

SUFFIXES = (".yaml", ".yml")
Row = dict[str, float | int | None]
Text = Annotated[str, Field(max_length=300)]
# parameters of a task
Rules = dict[Annotated[str, Field(pattern=r"^[a-z_]+(\.[a-z_]+){0,2}$")], bool | int | float | Name]


class DrawRequest(BaseModel):
    """Which rules draw, where: in a map of the project or in a world by its name, for which robot."""

    rules: Rules
    world: Name = "indoor"
    map: MapPath = ""
    difficulty: Annotated[float, Field(ge=0.0, le=1.0)] | None = None
    robot: Name = "turtlebot3"
    seed: Annotated[int, Field(ge=0, lt=2**63)] = 0
    count: Annotated[int, Field(ge=1, le=20)] = 10


class RulesRequest(BaseModel):
    """Under which name of task=NAME rules are kept, and of which task they are."""

    name: Annotated[str, Field(pattern=r"^[a-z][a-z0-9_]{0,60}$")]
    rules: Rules
    task: Literal["random", "staged"] = "random"


class PackRequest(BaseModel):
    """Which files make a pack in which folder, and how it is called."""

    folder: Annotated[str, Field(max_length=400)]
    files: Annotated[list[Annotated[str, Field(max_length=400)]], Field(max_length=1000)]
    id: Text = ""
    version: Text = ""
    title: Text = ""
    licence: Text = ""


def make_router(project: Project) -> APIRouter:
    """Return the routes below /api/curricula."""
    routes = APIRouter(prefix="/api/curricula")
    side = side_processes(project.root)

    @routes.get("")
    def listed() -> Any:
        return side.files.ask("curricula", SOON, names=project.files(SUFFIXES))

    @routes.get("/file")
    def opened(path: Path) -> dict[str, Any]:
        if "/" in path or path.endswith(SUFFIXES):
            version: str | None = project.read(path).version
        else:
            version = None  # one that comes with the suite
        return {"path": path, "version": version, "levels": side.files.ask("levels", SOON, name=path)}

    @routes.put("/file")
    def saved(path: Path, levels: list[Row], version: Version) -> dict[str, str]:
        project.path(path)
        if not path.endswith(SUFFIXES):
            raise ArenaError(f"path is {path}; allowed: a name that ends in .yaml or .yml")
        made = side.files.ask("check levels", SOON, rows=levels)
        if made["findings"]:
            raise ArenaError(f"{path}: {made['findings'][0]['line']}")
        return {"version": project.write(path, made["text"].encode(), known_version(version))}

    @routes.post("/check")
    def checked(levels: list[Row]) -> Any:
        return side.files.ask("check levels", SOON, rows=levels)

    @routes.post("/draws")
    def draws(asked: DrawRequest) -> Any:
        if asked.map:
            project.path(asked.map)
        given = {key: getattr(asked, key) for key in ("rules", "world", "difficulty", "robot", "seed", "count")}
        return side.long.ask("draws", LONG, **given, map_file=asked.map)

    @routes.post("/rules")
    def kept(asked: RulesRequest) -> dict[str, str]:
        text = side.files.ask("rules", SOON, name=asked.name, rules=asked.rules, base=asked.task)
        path = f"conf/task/{asked.name}.yaml"
        return {"path": path, "version": project.write(path, text.encode(), None)}

    @routes.get("/packs")
    def packs() -> Any:
        return side.files.ask("packs", SOON, names=project.files(SUFFIXES))

    @routes.post("/packs")
    def pack(asked: PackRequest) -> Any:
        for path in (asked.folder, *asked.files):
            project.path(path)
        said = {key: getattr(asked, key) for key in ("id", "version", "title", "licence")}
        return side.files.ask("pack", SOON, folder=asked.folder, files=asked.files, said=said)

    return routes
