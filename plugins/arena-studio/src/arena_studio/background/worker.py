"""What runs in the process beside the server: reads requests as lines of JSON, answers each with one line."""

from __future__ import annotations

import json
import os
import sys
from importlib import import_module
from pathlib import Path
from typing import IO, Any

from arena_core import ArenaError
from arena_core.commands import describe_error
from arena_core.files import reading_within
from arena_studio.background import requests

REQUESTS = {request.__name__: request for request in vars(requests).values() if hasattr(request, "work")}


def answer_request(line: bytes) -> dict[str, Any]:
    """Return the answer to a request, or its error in one line."""
    sent = json.loads(line)
    kind = REQUESTS[sent["request"]]
    try:
        module, _, name = kind.work.partition(":")
        with reading_within(Path.cwd()):
            work = getattr(import_module(f"arena_studio.{module}"), name)
            return {"answer": work(kind.model_construct(**sent["given"]))}  # the server has checked it
    except ArenaError as error:
        return {"error": str(error)}
    except (Exception, MemoryError) as error:  # a planner of anybody's may raise anything
        return {"error": f"{kind.what} failed: {describe_error(error)}"}


def main() -> None:
    """Answer until the server has gone. What plugins print goes to standard error."""
    out: IO[bytes] = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    for line in sys.stdin.buffer:
        out.write(json.dumps(answer_request(line)).encode() + b"\n")
        out.flush()


if __name__ == "__main__":
    main()
