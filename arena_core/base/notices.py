"""Lines that tell the user of something that is no error, and what stands beside a run's bar."""

from __future__ import annotations

import sys
from functools import cache
from multiprocessing import parent_process

_untold: list[str] = []


class Activity:
    """What a run is at while no episode ends: ``doing``, empty most of the time, stands beside its bar."""

    doing = ""


activity = Activity()


@cache
def print_notice(line: str) -> None:
    """Print a line on stderr, once in a process; a worker keeps it for the main process, which asks for
    what it has ``take_notices``.
    """
    if parent_process() is None:
        print(f"arena: {line}", file=sys.stderr)
    else:
        _untold.append(line)


def take_notices() -> list[str]:
    """Return, once, the lines that this worker has kept."""
    lines = list(_untold)
    _untold.clear()
    return lines
