"""The API of the scenario editor: scenario files of the project, their maps, what is impossible
in them, and how they move.
"""

from __future__ import annotations

import posixpath
from typing import Annotated, Any

from fastapi import APIRouter, Header, Query
from pydantic import BaseModel, Field

from arena_core import ArenaError
from arena_studio.project import Project
from arena_studio.side_process import LONG, SOON, side_processes

LONGEST_PREVIEW = 60.0  # s of simulated time
Path = Annotated[str, Query(max_length=400)]
# of the file as it was read, "none" where it must not be there yet
Version = Annotated[str, Header(alias="If-Match", max_length=100)]
Name = Annotated[str, Field(pattern=r"^[A-Za-z0-9_.\-/]{1,80}$")]
MapPath = Annotated[str, Field(max_length=400)]


class Content(BaseModel):
    """A scenario file as the page holds it: in our format, under the name that it has or will have; ``map``
    is relative to the project.
    """

    path: Annotated[str, Field(max_length=400)]
    content: dict[str, Any]
    map: MapPath = ""


class Checking(Content):
    """What is to be checked, for whom."""

    robot: Name = "turtlebot3"
    pedestrians: Name = "social_force"


class Previewing(Checking):
    """What is to be simulated."""

    scene: Annotated[int, Field(ge=0)]
    planner: Name = "pure_pursuit"
    seconds: Annotated[float, Field(gt=0.0, le=LONGEST_PREVIEW)] = 20.0
    seed: Annotated[int, Field(ge=0, lt=2**63)] = 0
    legs: bool = False


class Exporting(Content):
    """Which scene is to be written in which format, to which file that is not there yet."""

    scene: Annotated[int, Field(ge=0)]
    format: Name
    target: Annotated[str, Field(max_length=400)]


def make_router(project: Project) -> APIRouter:
    """Return the routes below /api/scenarios."""
    routes = APIRouter(prefix="/api/scenarios")
    side = side_processes(project.root)

    @routes.get("")
    def listed() -> Any:
        return side.files.ask("list", SOON, names=project.files((".json",)))

    @routes.get("/kinds")
    def kinds() -> Any:
        return side.files.ask("kinds", SOON)

    @routes.get("/file")
    def opened(path: Path) -> Any:
        version = project.read(path).version
        return {"path": path, "version": version, **side.files.ask("open", SOON, name=path)}

    @routes.put("/file")
    def saved(path: Path, content: dict[str, Any], version: Version) -> dict[str, str]:
        project.path(path)
        if not path.endswith(".json"):
            raise ArenaError(f"path is {path}; allowed: a name that ends in .json")
        text = side.files.ask("text", SOON, name=path, content=content)
        return {"version": project.write(path, text.encode(), known_version(version))}

    @routes.get("/map")
    def map_cells(path: Path) -> Any:
        project.path(path)
        return side.files.ask("map", SOON, name=path)

    @routes.post("/check")
    def checked(asked: Checking) -> Any:
        return side.checks.ask(
            "check", LONG, **_request_facts(project, asked), robot=asked.robot, pedestrians=asked.pedestrians
        )

    @routes.post("/preview")
    def preview(asked: Previewing) -> Any:
        chosen = {
            key: getattr(asked, key) for key in ("scene", "robot", "planner", "pedestrians", "seconds", "seed", "legs")
        }
        return side.long.ask("preview", LONG, **_request_facts(project, asked), **chosen)

    @routes.post("/export")
    def exported(asked: Exporting) -> dict[str, Any]:
        project.path(asked.target)
        made = side.files.ask(
            "export",
            SOON,
            **_request_facts(project, asked),
            scene=asked.scene,
            written=asked.format,
            target=asked.target,
        )
        # what it names comes first
        for path, text in sorted(made["texts"].items(), key=lambda row: row[0] == asked.target):
            project.write(path, text.encode(), None)
        return {"written": sorted(made["texts"]), "left_out": made["left_out"]}

    return routes


def known_version(version: str) -> str | None:
    """Return a version as the project has it."""
    return None if version == "none" else version


def _request_facts(project: Project, asked: Content) -> dict[str, Any]:
    """Return what all requests about a content hand on; raise ArenaError for a path that leads out of the project."""
    project.path(asked.path)
    if asked.map:
        project.path(asked.map)
    return {"name": posixpath.normpath(asked.path), "content": asked.content, "map_file": asked.map}
