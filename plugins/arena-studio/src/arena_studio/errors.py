"""What a page can be told of beside a wrong request: each error has its own status of HTTP."""

from __future__ import annotations

from arena_core import ArenaError


class Missing(ArenaError):
    """There is no such file or run; the message names it."""


class Conflict(ArenaError):
    """A file is not what it was when the page read it; nothing was overwritten."""


class TooLarge(ArenaError):
    """A body or a file is larger than the studio takes; the message names the limit."""


class Refused(ArenaError):
    """The request comes from another page, or does not know the token."""


STATUS: dict[type[ArenaError], int] = {Missing: 404, Conflict: 409, TooLarge: 413, Refused: 403}


def status_of(error: ArenaError) -> int:
    """Return the status of HTTP for an error: 400 unless it has one of its own."""
    return next((status for kind, status in STATUS.items() if isinstance(error, kind)), 400)
