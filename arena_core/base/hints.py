"""What a name that does not exist may have meant."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from difflib import get_close_matches
from typing import Any

MOST = 3  # guesses
LIKELY = 0.8  # likeness of names, as difflib counts it, from which on one is guessed before the same name elsewhere
DEEPEST = 6  # levels of a configuration that are searched


def did_you_mean(name: str, beside: Iterable[str], below: Iterable[str] = ()) -> str:
    """Return ``; did you mean ...?`` with those of the same name ``below`` (a.b.name) and the nearest name ``beside``, or nothing.

    Of those below that are only alike, one is guessed where there is nothing better.
    """
    paths = sorted(below, key=lambda path: (path.count("."), path))
    here, alike = list(beside), [path for path in paths if _last(path) == name]
    found = list(dict.fromkeys([*get_close_matches(name, here, n=1, cutoff=LIKELY), *alike, *get_close_matches(name, here, n=1)]))
    if not found and (near := get_close_matches(name, {_last(path): None for path in paths}, n=1)):
        found = [path for path in paths if _last(path) == near[0]]
    return f"; did you mean {' or '.join(found[:MOST])}?" if found else ""


def keys_below(node: Mapping[Any, Any], levels: int = DEEPEST) -> Iterator[str]:
    """Yield the keys that lie at least one level within a mapping, with those that lead there: ``limits.vx_max``."""
    for key, inner in node.items():
        if isinstance(inner, Mapping) and levels:
            yield from (f"{key}.{name}" for name in inner)
            yield from (f"{key}.{path}" for path in keys_below(inner, levels - 1))


def _last(path: str) -> str:
    return path.rpartition(".")[2]
