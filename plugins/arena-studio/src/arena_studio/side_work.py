"""What runs in the process beside the server: reads requests as lines of JSON, answers each with one line."""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Mapping
from importlib import import_module
from pathlib import Path
from typing import IO, Any

from arena_core import ArenaError
from arena_core.commands import describe_error
from arena_core.files import reading_within

WORK: Mapping[str, str] = {  # what can be asked for, and which function of this package does it
    "kinds": "scene_work:kinds",
    "list": "scene_work:listed",
    "open": "scene_work:opened",
    "text": "scene_work:text",
    "check": "scene_work:checked",
    "map": "scene_work:map_cells",
    "export": "scene_work:exported",
    "preview": "preview_work:preview",
    "draws": "draw_work:draws",
    "rules": "draw_work:rules_text",
    "levels": "curriculum_work:levels",
    "check levels": "curriculum_work:checked",
    "curricula": "curriculum_work:listed",
    "packs": "curriculum_work:packs",
    "pack": "curriculum_work:pack",
    "compose": "compose_work:composed",
    "form": "compose_work:form",
    "world kinds": "world_work:world_kinds",
    "furniture": "mapping.furnishing:furniture_kinds",
    "draw": "world_work:drawn",
    "world": "world_work:world",
    "measures": "world_work:measures",
    "ends": "world_work:ends",
}


def answer_request(line: bytes) -> dict[str, Any]:
    """Return the answer to a request, or its error in one line."""
    request = json.loads(line)
    try:
        module, _, name = WORK[request["what"]].partition(":")
        with reading_within(Path.cwd()):
            return {"answer": getattr(import_module(f"arena_studio.{module}"), name)(**request["given"])}
    except ArenaError as error:
        return {"error": str(error)}
    except (Exception, MemoryError) as error:  # a planner of anybody's may raise anything
        return {"error": f"{request['what']} failed: {describe_error(error)}"}


def main() -> None:
    """Answer until the server has gone. What plugins print goes to standard error."""
    out: IO[bytes] = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    for line in sys.stdin.buffer:
        out.write(json.dumps(answer_request(line)).encode() + b"\n")
        out.flush()


if __name__ == "__main__":
    main()
