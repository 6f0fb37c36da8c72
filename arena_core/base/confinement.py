"""Which files a program that serves others may read: those of one folder, and those that are installed."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from functools import cache
from pathlib import Path

_places: ContextVar[tuple[str, ...] | None] = ContextVar("places of files", default=None)


@contextmanager
def reading_within(*places: Path) -> Iterator[None]:
    """Have the readers of this package take only files that lie, links followed, in one of ``places`` or among what is
    installed.

    It holds for this context: a request, and the threads and tasks that answer it.
    """
    token = _places.set(tuple(os.path.realpath(place) for place in places))
    try:
        yield
    finally:
        _places.reset(token)


def is_readable(path: Path) -> bool:
    """Return whether a file may be read here, be it there or not."""
    places = _places.get()
    if places is None:
        return True
    try:
        real = os.path.realpath(path)
    except (OSError, ValueError):  # a name that no file can have
        return False
    return any(_lies_in(real, place) for place in places) or any(
        _lies_in(real, place) for place in _installed_folders()
    )


@cache
def _installed_folders() -> tuple[str, ...]:
    """Return the folders that Python imports from, but for the one that it runs in and those above it."""
    here = os.getcwd()
    found = {os.path.realpath(place) for place in (sys.prefix, *sys.path) if place}
    package = Path(os.path.realpath(__file__)).parents[1]
    own = str(package), str(package.parent / "conf")  # the latter in a checkout: in a wheel it lies in the package
    return tuple(sorted({*own, *(place for place in found if not _lies_in(here, place))}))


def _lies_in(path: str, place: str) -> bool:
    return path == place or path.startswith(place.rstrip(os.sep) + os.sep)
