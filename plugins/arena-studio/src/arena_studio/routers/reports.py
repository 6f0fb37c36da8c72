"""``/report`` and ``/shown``: reports and their replays, which the browser keeps apart: they may have come
with a folder from elsewhere.
"""

from __future__ import annotations

import stat

from fastapi import APIRouter, Request
from fastapi.responses import HTMLResponse, RedirectResponse

from arena_core import ArenaError
from arena_studio.errors import Missing, Refused, TooLarge
from arena_studio.project import Project
from arena_studio.signed_addresses import REPLAYS, START, SignedAddresses

PAGE = "index.html"
POLICY = (
    "default-src 'none'; script-src data: 'unsafe-inline'; style-src 'unsafe-inline'; img-src data:; "
    "sandbox allow-scripts"
)
LARGEST = 200_000_000  # bytes of a page


def make_router(project: Project, signed: SignedAddresses) -> APIRouter:
    """Return the routes of reports."""
    routes = APIRouter()

    @routes.get("/report/{folder:path}")
    def report(folder: str) -> RedirectResponse:
        """Lead to the address under which a report is shown; its own links send no cookie, so its
        address vouches for them.
        """
        folder = folder.strip("/")
        _read_page(project, folder, PAGE)
        return RedirectResponse(signed.address(folder), 303)

    @routes.get(START + "{signature}/{place:path}")
    def shown(signature: str, place: str, request: Request) -> HTMLResponse:
        """Return a report, or a replay beside it."""
        # who knows the token may ask for anything, and yet sees reports alone here
        if not signed.allows(request.scope["path"]):
            raise Refused("the address is of no report of this studio; open the report again")
        folder, _, name = place.rpartition("/")
        return HTMLResponse(_read_page(project, folder, name or PAGE), headers={"Content-Security-Policy": POLICY})

    return routes


def _read_page(project: Project, folder: str, name: str) -> bytes:
    """Read a page of a report; raise Missing, TooLarge, or ArenaError for what no report has."""
    path = project.path(f"{folder}/{name}")
    if not name.endswith(".html"):
        raise ArenaError(f"{name}: is no page; allowed: a report, or a page of its folder {REPLAYS}")
    try:
        status = path.stat()
    except OSError:
        raise Missing(f"{folder}: has no report") from None
    if not stat.S_ISREG(status.st_mode):
        raise Missing(f"{folder}: has no report")
    if status.st_size > LARGEST:
        raise TooLarge(f"{folder}: {name} has {status.st_size} bytes; allowed: up to {LARGEST}")
    return path.read_bytes()
