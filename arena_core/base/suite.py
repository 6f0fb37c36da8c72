"""Which distribution of the suite brings what: for messages where it is not installed.

``scripts/name_components`` writes the list.
"""

from __future__ import annotations

import json
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from importlib.resources import files


def distribution_hint(kind: str, name: str) -> str:
    """Return, as the end of a message, which distribution brings a component or an option, and why it is
    not there; empty if none does.
    """
    found = [distribution for distribution, brought in _read_suite().items() if name in brought.get(kind, ())]
    return f"comes with {found[0]}, which is {_install_state(found[0])}" if found else ""


def _install_state(distribution: str) -> str:
    try:
        version(distribution)
    except PackageNotFoundError:
        return f"not installed: pip install {distribution}"
    return "switched off by ARENA_DISABLED_PLUGINS"


@cache
def _read_suite() -> dict[str, dict[str, list[str]]]:
    found: dict[str, dict[str, list[str]]] = json.loads(
        (files("arena_core") / "suite.json").read_text(encoding="utf-8")
    )
    return found
