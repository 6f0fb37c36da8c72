"""Maps: listed, opened cell by cell, saved, drawn, measured and furnished."""

from __future__ import annotations

import base64
from typing import Any

from fastapi import APIRouter, Request, Response
from pydantic import BaseModel
from starlette.concurrency import run_in_threadpool

from arena_studio.background.process import LONG, SideProcess, side_processes
from arena_studio.background.requests import (
    DrawWorld,
    FurnitureKinds,
    MeasureWorld,
    OpenWorld,
    RouteEnds,
    WorldKinds,
)
from arena_studio.mapping.furnishing import new_scenario, save_furniture, scenario_files
from arena_studio.mapping.map_document import copy_map, document_of, map_files, map_version, open_map, save_map
from arena_studio.mapping.transfer import pack_cells, unpack_cells
from arena_studio.project import Project

BINARY = "application/octet-stream"


class Furnished(BaseModel):
    """The furniture of one problem of a scenario file."""

    path: str
    version: str
    problem: str
    furniture: list[Any]


class NewScenario(BaseModel):
    """A scenario file to be made for a map."""

    path: str
    map: str
    furniture: list[Any] = []


def make_router(project: Project) -> APIRouter:
    """Return what the map editor asks for.

    Images are read and written here, for NumPy and Pillow let other requests go on meanwhile; worlds are the work of a
    process beside.
    """
    routes = APIRouter(prefix="/api/maps")
    side = side_processes(project.root).checks
    _add_file_routes(routes, project, side)
    _add_world_routes(routes, project, side)
    _add_furniture_routes(routes, project, side)
    return routes


def _add_file_routes(routes: APIRouter, project: Project, side: SideProcess) -> None:
    @routes.get("")
    def listed() -> dict[str, Any]:
        return {"maps": map_files(project)}

    @routes.get("/file")
    def opened(path: str) -> Response:
        found = open_map(project, path)
        if found is None:
            return _binary_response(side.ask(OpenWorld(path=path), LONG))
        header, codes = document_of(found)
        return Response(pack_cells(header, codes.tobytes()), media_type=BINARY)

    @routes.get("/version")
    def version(path: str) -> dict[str, Any]:
        return {"version": map_version(project, path)}

    @routes.put("/file")
    async def saved(path: str, request: Request) -> dict[str, Any]:
        header, cells = await run_in_threadpool(unpack_cells, await request.body())
        return {"version": await run_in_threadpool(save_map, project, path, header, cells)}

    @routes.post("/copy")
    async def copied(path: str, request: Request) -> dict[str, Any]:
        header, cells = await run_in_threadpool(unpack_cells, await request.body())
        return await run_in_threadpool(copy_map, project, path, header, cells)


def _add_world_routes(routes: APIRouter, project: Project, side: SideProcess) -> None:
    @routes.get("/kinds")
    def possible() -> dict[str, Any]:
        return {"kinds": side.ask(WorldKinds(), LONG)}

    @routes.get("/draw")
    def drawn(kind: str, seed: int = 0, parameters: str = "{}") -> Response:
        return _binary_response(side.ask(DrawWorld(kind=kind, seed=seed, parameters=parameters), LONG))

    @routes.get("/measures")
    def measures(path: str, robot_radius: float | None = None) -> dict[str, Any]:
        project.path(path)
        return {"measures": side.ask(MeasureWorld(path=path, robot_radius=robot_radius), LONG)}


def _add_furniture_routes(routes: APIRouter, project: Project, side: SideProcess) -> None:
    @routes.get("/furniture")
    def pieces() -> dict[str, Any]:
        return {"kinds": side_processes(project.root).files.ask(FurnitureKinds(), LONG)}

    @routes.get("/scenarios")
    def scenarios(path: str) -> dict[str, Any]:
        return {"files": scenario_files(project, path)}

    @routes.put("/furniture")
    def furnished(sent: Furnished) -> dict[str, Any]:
        return {"version": save_furniture(project, sent.path, sent.version, sent.problem, sent.furniture)}

    @routes.post("/scenarios")
    def new(sent: NewScenario) -> dict[str, Any]:
        project.path(sent.map)
        ends = side.ask(RouteEnds(path=sent.map), LONG)
        return {"version": new_scenario(project, sent.path, sent.map, ends, sent.furniture)}


def _binary_response(content: str) -> Response:
    """Return what another process has sent in base64."""
    return Response(base64.b64decode(content), media_type=BINARY)
