"""Lines that tell the user of something that is no error."""

from __future__ import annotations

import sys
from functools import cache
from multiprocessing import parent_process


@cache
def tell(line: str) -> None:
    """Print a line on stderr: once in a process, and never from a worker, which builds what the main process built before it."""
    if parent_process() is None:
        print(f"arena: {line}", file=sys.stderr)
