"""The file of one option of a configuration group, which anybody may have written: read within limits,
checked before it is expanded.
"""

from __future__ import annotations

from importlib.resources.abc import Traversable
from pathlib import Path
from typing import Any

from arena_core.base.errors import InputFileError
from arena_core.base.files import read_text
from arena_core.base.limits import LIMITS

ALLOWED = "a mapping of keys and values"


def option_text(file: Traversable) -> str:
    """Return the text of an option's file; raise InputFileError (one line)."""
    return read_text(file, LIMITS.yaml_bytes, ALLOWED) if isinstance(file, Path) else file.read_text(encoding="utf-8")


def check_option(file: Traversable, node: Any) -> None:
    """Raise InputFileError for what Hydra stumbles over: no mapping, defaults that are no list, aliases
    that make much of little.
    """
    import yaml

    if node is None:
        return
    if not isinstance(node, yaml.MappingNode):
        raise InputFileError(f"{file}: is no mapping; allowed: {ALLOWED}")
    try:
        size = _expanded_size(node, {})
    except RecursionError:
        size = LIMITS.yaml_nodes + 1
    if size > LIMITS.yaml_nodes:
        raise InputFileError(
            f"{file}: its aliases make more than {LIMITS.yaml_nodes} values of it; allowed: up to that"
        )
    for key, value in node.value:
        if key.value == "defaults" and not isinstance(value, yaml.SequenceNode):
            raise InputFileError(f"{file}: defaults is no list; allowed: a list of options, or no such key")


def _expanded_size(node: Any, known: dict[int, int]) -> int:
    """Return how many values a node is once its aliases are written out; without end where it holds itself."""
    import yaml

    if isinstance(node, yaml.ScalarNode):
        return 1
    if id(node) not in known:
        known[id(node)] = LIMITS.yaml_nodes + 1  # until it is known: whoever meets it before holds itself
        below = node.value if isinstance(node, yaml.SequenceNode) else [part for pair in node.value for part in pair]
        known[id(node)] = 1 + sum(_expanded_size(part, known) for part in below)
    return known[id(node)]
