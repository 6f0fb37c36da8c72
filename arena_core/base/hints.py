"""What a name that does not exist may have meant."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from difflib import get_close_matches
from typing import Any

MOST = 3  # guesses
LIKELY = 0.8  # likeness of names, as difflib counts it, from which on one is taken for a slip of the other
DEEPEST = 6  # levels of a configuration that are searched


def did_you_mean(name: str, beside: Iterable[str], below: Iterable[str] = ()) -> str:
    """Return ``; did you mean ...?``: the name ``beside`` that it is a slip of, or the same name ``below`` (a.b.name),
    or one like it.

    Nothing where there is none.
    """
    found = _close_names(name, list(beside), sorted(below, key=lambda path: (path.count("."), path)))
    return f"; did you mean {' or '.join(found[:MOST])}?" if found else ""


def _close_names(name: str, beside: list[str], paths: list[str]) -> list[str]:
    if likely := get_close_matches(name, beside, n=1, cutoff=LIKELY):
        return likely
    found = [path for path in paths if _last_part(path) == name] + get_close_matches(name, beside, n=1)
    like = [] if found else get_close_matches(name, {_last_part(path): None for path in paths}, n=1)
    return found or [path for path in paths if _last_part(path) in like]


def keys_below(node: Mapping[Any, Any], levels: int = DEEPEST) -> Iterator[str]:
    """Yield the keys that lie at least one level within a mapping, with those that lead there: ``limits.vx_max``."""
    for key, inner in node.items():
        if isinstance(inner, Mapping) and levels:
            yield from (f"{key}.{name}" for name in inner)
            yield from (f"{key}.{path}" for path in keys_below(inner, levels - 1))


def _last_part(path: str) -> str:
    return path.rpartition(".")[2]
