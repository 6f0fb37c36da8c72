"""The viewer's page: one file with everything inside it, or one that fetches the document from its server."""

from __future__ import annotations

import base64
import json
from html import escape
from importlib.resources import files
from string import Template

MODULES = (
    "camera",
    "decode",
    "episode",
    "facts",
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


def page(title: str, document: bytes | None) -> str:
    """Return the page; without a ``document`` it fetches one from where it came from."""
    web = files("arena_viewer") / "web"
    template = Template((web / "viewer.html").read_text(encoding="utf-8"))
    return template.substitute(
        title=escape(title),
        style=(web / "viewer.css").read_text(encoding="utf-8"),
        document="" if document is None else base64.b64encode(document).decode(),
        modules=json.dumps({"imports": {f"arena/{name}.js": _module(name) for name in MODULES}}),
    )


def _module(name: str) -> str:
    """Return a module as an address of its own content: modules of a file on disk may not be fetched from beside it."""
    source = (files("arena_viewer") / "web" / f"{name}.js").read_bytes()
    return "data:text/javascript;base64," + base64.b64encode(source).decode()
