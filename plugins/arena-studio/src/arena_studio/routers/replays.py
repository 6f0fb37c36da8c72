"""``/replay`` and ``/watch``: episodes in the viewer, and runs under way."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query, Request
from fastapi.responses import HTMLResponse, PlainTextResponse, Response

from arena_core import ArenaError
from arena_studio.errors import Missing, status_of
from arena_studio.experiments.experiments import Experiments
from arena_studio.project import Project
from arena_viewer.document import RecordedEpisode, read_recorded, replay_document
from arena_viewer.live import LiveRuns
from arena_viewer.page import live_page, replay_page
from arena_viewer.serving import POLICY

MOST = 12  # episodes beside each other
Episode = Annotated[int, Query(ge=0, le=10**9)]
Runs = Annotated[list[str], Query(max_length=MOST)]


def make_router(project: Project) -> APIRouter:
    """Return the routes of replays."""
    routes = APIRouter()

    @routes.get("/replay/")
    def replay() -> HTMLResponse:
        """Return the viewer; it fetches the document by the same query."""
        return _viewer_response(replay_page("arena replay", None))

    @routes.get("/replay/document")
    def replayed(run: Runs, episode: Episode) -> Response:
        """Return the document of one episode, by several runs beside each other; errors are lines
        of text, which the viewer shows.
        """
        try:
            content = replay_document([read_episode(project, one, episode) for one in run])
        except ArenaError as error:
            return PlainTextResponse(str(error), status_of(error))
        return Response(content, media_type="application/octet-stream", headers={"Cache-Control": "no-store"})

    return routes


def watch_router(experiments: Experiments) -> APIRouter:
    """Return the routes of experiments under way, each below its name: the viewer's page and what it asks for."""
    routes = APIRouter(prefix="/watch/{name}")
    watched: dict[str, LiveRuns] = {}

    def answer(name: str, what: str, request: Request) -> Response:
        one = watched.setdefault(name, LiveRuns(experiments.folder(name)))
        asked = dict(request.query_params)
        kind, content = {"state": one.state, "map": one.map, "document": one.document}[what](asked)
        return Response(content, media_type=kind, headers={"Cache-Control": "no-store"})

    @routes.get("/")
    def watch(name: str) -> HTMLResponse:
        return _viewer_response(live_page(experiments.experiment_state(name)["folder"]))

    @routes.get("/replay")
    def replay(name: str) -> HTMLResponse:
        return _viewer_response(replay_page("arena replay", None))

    @routes.get("/state")
    def state(name: str, request: Request) -> Response:
        return answer(name, "state", request)

    @routes.get("/map")
    def grid(name: str, request: Request) -> Response:
        return answer(name, "map", request)

    @routes.get("/document")
    def document_of(name: str, request: Request) -> Response:
        return answer(name, "document", request)

    return routes


def _viewer_response(text: str) -> HTMLResponse:
    return HTMLResponse(text, headers={"Content-Security-Policy": POLICY})


def read_episode(project: Project, run: str, episode: int) -> RecordedEpisode:
    """Return an episode of a run of the project; raise Missing where the run is gone."""
    folder = project.path(run) if run != "." else project.root
    if not (folder / "episodes.csv").is_file():
        raise Missing(f"{run}: there is no such run any more")
    return read_recorded(folder, episode)
