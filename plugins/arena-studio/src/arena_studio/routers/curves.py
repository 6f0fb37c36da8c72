"""``/api/curves``: tunings, ladders and trainings of a project, and what each has come to."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Annotated, Any

from fastapi import APIRouter, Query

from arena_studio.curves.folders import Kind, find_studies, study_at
from arena_studio.curves.ladders import read_ladder
from arena_studio.curves.trainings import read_training
from arena_studio.project import LONGEST_NAME, Project
from arena_tuning.standing import read_standing

READERS: Mapping[Kind, Callable[[Path], dict[str, Any]]] = {
    "tuning": read_standing,
    "ladder": read_ladder,
    "training": read_training,
}
Place = Annotated[str, Query(max_length=LONGEST_NAME)]


def make_router(project: Project) -> APIRouter:
    """Return the routes of the page Curves."""
    routes = APIRouter(prefix="/api/curves")

    @routes.get("")
    def listed() -> dict[str, Any]:
        return {"folders": [asdict(one) for one in find_studies(project)]}

    @routes.get("/folder")
    def opened(path: Place) -> dict[str, Any]:
        study = study_at(project, path)
        found = READERS[study.kind](project.root / study.path)
        return {**asdict(study), "found": found}

    return routes
