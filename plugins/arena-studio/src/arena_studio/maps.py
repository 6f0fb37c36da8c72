"""Maps: listed, opened cell by cell, saved, drawn, measured and furnished."""

from __future__ import annotations

from typing import Any

from fastapi import APIRouter, Request, Response
from pydantic import BaseModel
from starlette.concurrency import run_in_threadpool

from arena_studio.mapping.drawn_worlds import drawn_world, kinds, measured_file, read_parameters
from arena_studio.mapping.furnishing import furniture_kinds, new_scenario, save_furniture, scenario_files
from arena_studio.mapping.map_document import copy_map, grid_document, map_document, map_files, map_version, save_map
from arena_studio.mapping.transfer import packed, unpacked
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


def router(project: Project) -> APIRouter:
    """Return what the map editor asks for."""
    routes = APIRouter(prefix="/api/maps")
    _files(routes, project)
    _worlds(routes, project)
    _furniture(routes, project)
    return routes


def _files(routes: APIRouter, project: Project) -> None:
    @routes.get("")
    def listed() -> dict[str, Any]:
        return {"maps": map_files(project)}

    @routes.get("/file")
    def opened(path: str) -> Response:
        header, codes = map_document(project, path)
        return Response(packed(header, codes.tobytes()), media_type=BINARY)

    @routes.get("/version")
    def version(path: str) -> dict[str, Any]:
        return {"version": map_version(project, path)}

    @routes.put("/file")
    async def saved(path: str, request: Request) -> dict[str, Any]:
        header, cells = await run_in_threadpool(unpacked, await request.body())
        return {"version": await run_in_threadpool(save_map, project, path, header, cells)}

    @routes.post("/copy")
    async def copied(path: str, request: Request) -> dict[str, Any]:
        header, cells = await run_in_threadpool(unpacked, await request.body())
        return await run_in_threadpool(copy_map, project, path, header, cells)


def _worlds(routes: APIRouter, project: Project) -> None:
    @routes.get("/kinds")
    def possible() -> dict[str, Any]:
        return {"kinds": kinds()}

    @routes.get("/draw")
    def drawn(kind: str, seed: int = 0, parameters: str = "{}") -> Response:
        world = drawn_world(kind, seed, read_parameters(parameters))
        header, codes = grid_document(world.grid, None)
        header["furniture"] = [{"kind": piece.kind, "pose": piece.pose.array().tolist()} for piece in world.furniture]
        return Response(packed(header, codes.tobytes()), media_type=BINARY)

    @routes.get("/measures")
    def measures(path: str, robot_radius: float | None = None) -> dict[str, Any]:
        return {"measures": measured_file(project, path, robot_radius)}


def _furniture(routes: APIRouter, project: Project) -> None:
    @routes.get("/furniture")
    def pieces() -> dict[str, Any]:
        return {"kinds": furniture_kinds()}

    @routes.get("/scenarios")
    def scenarios(path: str) -> dict[str, Any]:
        return {"files": scenario_files(project, path)}

    @routes.put("/furniture")
    def furnished(sent: Furnished) -> dict[str, Any]:
        return {"version": save_furniture(project, sent.path, sent.version, sent.problem, sent.furniture)}

    @routes.post("/scenarios")
    def new(sent: NewScenario) -> dict[str, Any]:
        return {"version": new_scenario(project, sent.path, sent.map, sent.furniture)}
