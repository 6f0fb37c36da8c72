"""The application: its pages, the routers of its parts, and how errors are told."""

from __future__ import annotations

import base64
from hashlib import sha256
from importlib.resources import files

from fastapi import FastAPI, Request
from fastapi.exceptions import RequestValidationError
from fastapi.responses import HTMLResponse, JSONResponse
from fastapi.staticfiles import StaticFiles
from starlette.exceptions import HTTPException

from arena_core import ArenaError
from arena_core.commands import one_line
from arena_studio.access import LOOPBACK, Access, AccessMiddleware
from arena_studio.background.process import side_processes
from arena_studio.errors import status_of
from arena_studio.experiments.experiments import Experiments
from arena_studio.project import Project
from arena_studio.routers import curricula, curves, live, maps, replays, reports, results, runs, scenarios
from arena_studio.signed_addresses import SignedAddresses

POLICY = (
    "default-src 'none'; script-src 'self' '{}'; style-src 'self'; img-src 'self' data: blob:; connect-src 'self'; "
    "frame-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)


def make_app(project: Project, token: str, hosts: frozenset[str] | None = LOOPBACK) -> FastAPI:
    """Return the studio of a project; ``token`` is what a page must know, ``hosts`` the names
    that it answers to (None: any).
    """
    index = (files("arena_studio") / "web" / "index.html").read_text(encoding="utf-8")
    app = FastAPI(title="arena studio", docs_url=None, redoc_url=None, openapi_url=None)
    app.state.project = project
    _report_errors(app)
    experiments = Experiments(project)
    app.include_router(runs.make_router(experiments, side_processes(project.root).runs))
    for routes in (
        live.make_router(experiments),
        replays.watch_router(experiments),
        reports.make_router(project, SignedAddresses(token)),
    ):
        app.include_router(routes)
    for part in (results, curves, replays, maps, scenarios, curricula):
        app.include_router(part.make_router(project))

    @app.get("/", response_class=HTMLResponse)
    def page() -> HTMLResponse:
        return HTMLResponse(index)

    @app.get("/api/project")
    def about() -> dict[str, str]:
        return {"name": project.root.name, "folder": str(project.root)}

    app.mount("/web", StaticFiles(packages=[("arena_studio", "web")]))
    app.mount("/viewer", StaticFiles(packages=[("arena_viewer", "web")]))
    app.add_middleware(
        AccessMiddleware, access=Access(token, hosts, POLICY.format(_inline_hash(index))), root=project.root
    )
    return app


def _inline_hash(index: str) -> str:
    """Return the digest by which a browser knows the page's import map, the only script that
    stands in the page itself.
    """
    text = index.partition('<script type="importmap">')[2].partition("</script>")[0]
    return f"sha256-{base64.b64encode(sha256(text.encode()).digest()).decode()}"


def _report_errors(app: FastAPI) -> None:
    """Have every error answered in one line of JSON."""

    @app.exception_handler(ArenaError)
    def wrong(request: Request, error: ArenaError) -> JSONResponse:
        return JSONResponse({"error": str(error)}, status_of(error))

    @app.exception_handler(RequestValidationError)
    def unreadable(request: Request, error: RequestValidationError) -> JSONResponse:
        first = error.errors()[0]
        place = ".".join(map(str, first["loc"]))
        return JSONResponse({"error": one_line(f"{place} is wrong: {first['msg']}", 300)}, 400)

    @app.exception_handler(HTTPException)
    def unknown(request: Request, error: HTTPException) -> JSONResponse:
        return JSONResponse({"error": one_line(f"{request.url.path}: {error.detail}", 300)}, error.status_code)
