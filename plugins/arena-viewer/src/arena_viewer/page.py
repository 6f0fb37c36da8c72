"""The viewer's page: one file with everything inside it, or one that fetches the document from its server."""

from __future__ import annotations

import base64
import json
from collections.abc import Mapping, Sequence
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
    "marks",
    "panes",
    "people",
    "player",
    "plots",
    "scene",
    "solid/building",
    "solid/eye",
    "solid/figures",
    "solid/hands",
    "solid/lines",
    "solid/loading",
    "solid/machines",
    "solid/stage",
    "solid/switch",
    "solid/world",
    "thoughts",
    "walk",
)
LIVE_MODULES = ("camera", "live", "live_view", "live_words", "looks")


def replay_page(title: str, document: bytes | None) -> str:
    """Return the page; without a ``document`` it fetches one from where it came from."""
    parts = {"document": "" if document is None else base64.b64encode(document).decode(), "three": _three()}
    return _fill_page(title, "viewer", "main", MODULES, parts)


def live_page(title: str) -> str:
    """Return the page that shows runs under way; it asks its server what is new."""
    return _fill_page(title, "live", "live", LIVE_MODULES, {"document": "", "three": ""})


def _three() -> str:
    """Return what draws in three dimensions, packed."""
    return base64.b64encode((files("arena_viewer") / "web" / "solid" / "three.module.min.js.gz").read_bytes()).decode()


def _fill_page(title: str, content: str, entry: str, modules: Sequence[str], parts: Mapping[str, str]) -> str:
    """Return the page around a ``content`` and packed ``parts``; ``entry`` is the module that it starts with."""
    return Template(_read_file("page.html")).substitute(
        title=escape(title),
        style=_read_file("viewer.css"),
        main=Template(_read_file(f"{content}.html")).substitute(title=escape(title)),
        **parts,
        modules=json.dumps({"imports": {f"arena/{module}.js": _module_address(module) for module in modules}}),
        entry=entry,
    )


def _read_file(name: str) -> str:
    return (files("arena_viewer") / "web" / name).read_text(encoding="utf-8")


def _module_address(name: str) -> str:
    """Return a module as an address of its own content: modules of a file on disk may not be fetched from beside it."""
    return "data:text/javascript;base64," + base64.b64encode(_read_file(f"{name}.js").encode()).decode()
