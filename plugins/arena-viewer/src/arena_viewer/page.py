"""The viewer's page: one file with everything inside it, or one that fetches the document from its server."""

from __future__ import annotations

import base64
import json
from collections.abc import Sequence
from html import escape
from importlib.resources import files
from string import Template

MODULES = (
    "camera",
    "decode",
    "episode",
    "facts",
    "floor",
    "hands",
    "lidar",
    "looks",
    "main",
    "panes",
    "people",
    "player",
    "plots",
    "scene",
    "thoughts",
    "walk",
)
LIVE_MODULES = ("camera", "live", "live_view", "live_words", "looks")


def page(title: str, document: bytes | None) -> str:
    """Return the page; without a ``document`` it fetches one from where it came from."""
    return _filled("viewer.html", title, MODULES, "" if document is None else base64.b64encode(document).decode())


def live_page(title: str) -> str:
    """Return the page that shows runs under way; it asks its server what is new."""
    return _filled("live.html", title, LIVE_MODULES, "")


def _filled(name: str, title: str, modules: Sequence[str], document: str) -> str:
    web = files("arena_viewer") / "web"
    return Template((web / name).read_text(encoding="utf-8")).substitute(
        title=escape(title),
        style=(web / "viewer.css").read_text(encoding="utf-8"),
        document=document,
        modules=json.dumps({"imports": {f"arena/{module}.js": _module(module) for module in modules}}),
    )


def _module(name: str) -> str:
    """Return a module as an address of its own content: modules of a file on disk may not be fetched from beside it."""
    source = (files("arena_viewer") / "web" / f"{name}.js").read_bytes()
    return "data:text/javascript;base64," + base64.b64encode(source).decode()
