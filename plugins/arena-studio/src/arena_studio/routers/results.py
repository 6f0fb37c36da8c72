"""``/api/results``: the episodes of all runs of a project, filtered, compared, exported."""

from __future__ import annotations

import itertools
import math
from datetime import datetime
from threading import Lock
from time import monotonic
from typing import TYPE_CHECKING, Annotated, Any

from fastapi import APIRouter, Response
from pydantic import BaseModel, Field, StringConstraints

from arena_core import Runs
from arena_core.files import csv_text
from arena_studio.episode_table import EpisodeTable, Query
from arena_studio.errors import Missing
from arena_studio.project import Project

if TYPE_CHECKING:
    from pandas import DataFrame

LARGEST_PAGE = 500  # rows
FRESH = 1.0  # s for which a look at the disk is good
HIDDEN = ("config_hash", "code", "scenario_hash")  # columns that no one reads; the export has them
Name = Annotated[str, StringConstraints(max_length=400)]
Values = Annotated[list[Name], Field(max_length=1000)]


class ResultsRequest(BaseModel):
    """What a page wants to see."""

    allowed: dict[Name, Values] = Field(default_factory=dict, max_length=50)
    text: Name = ""
    order: Name = ""
    falling: bool = False
    page: Annotated[int, Field(ge=0, le=10**6)] = 0
    size: Annotated[int, Field(ge=1, le=LARGEST_PAGE)] = 50
    baseline: Name = ""

    def query(self) -> Query:
        """Return which episodes, in which order."""
        return Query(
            {name: values for name, values in self.allowed.items() if values}, self.text, self.order, self.falling
        )


class Results:
    """The table of a project, looked at again at most once in ``FRESH`` seconds, and comparisons, one at a time."""

    def __init__(self, project: Project) -> None:
        self.project = project
        self.table = EpisodeTable(project.root)
        self._looked = -math.inf
        self._looking, self._comparing = Lock(), Lock()

    def refresh(self) -> None:
        """Read what has changed."""
        with self._looking:
            if monotonic() - self._looked > FRESH:
                self.table.refresh()
                self._looked = monotonic()

    def page(self, asked: ResultsRequest) -> dict[str, Any]:
        """Return one page of rows, how many there are in all, what can be filtered by, and what is wrong with runs."""
        self.refresh()
        query = asked.query()
        chosen = self.table.select(query)
        rows = chosen.iloc[asked.page * asked.size : (asked.page + 1) * asked.size]
        columns = [str(name) for name in chosen.columns if name not in HIDDEN]
        return {
            **{
                "total": len(chosen),
                "columns": columns,
                "rows": plain_rows(rows[columns]),
                "counts": self.table.counts(query),
            },
            **{
                "troubles": list(self.table.troubles.values()),
                "gone": self.table.gone,
                "summary": _success_summary(chosen),
            },
        }

    def compare(self, asked: ResultsRequest) -> list[dict[str, Any]]:
        """Compare the planners of all runs that have an episode among those asked for, with the core's statistics."""
        self.refresh()
        with self._comparing:
            return plain_rows(self._read_runs(asked).compare(asked.baseline or None))

    def report(self, asked: ResultsRequest) -> str:
        """Write a report over the same runs to a new folder; return it."""
        self.refresh()
        name = f"reports/{datetime.now().strftime('%Y-%m-%d_%H-%M-%S-%f')}"
        with self._comparing:
            self._read_runs(asked).report(self.project.path(name), asked.baseline or None)
        return name

    def _read_runs(self, asked: ResultsRequest) -> Runs:
        folders = self.table.folders(asked.query())
        if not folders:
            raise Missing("no run has such an episode")
        return Runs.below(*folders)


def make_router(project: Project) -> APIRouter:
    """Return the routes of the page Results."""
    routes, results = APIRouter(prefix="/api/results"), Results(project)

    @routes.post("/page")
    def page(asked: ResultsRequest) -> dict[str, Any]:
        return results.page(asked)

    @routes.post("/compare")
    def compare(asked: ResultsRequest) -> list[dict[str, Any]]:
        return results.compare(asked)

    @routes.post("/report")
    def report(asked: ResultsRequest) -> dict[str, str]:
        return {"folder": results.report(asked)}

    @routes.post("/export")
    def export(asked: ResultsRequest) -> Response:
        """Return all rows of a query as CSV."""
        results.refresh()
        headers = {"Content-Disposition": 'attachment; filename="episodes.csv"'}
        chosen = results.table.select(asked.query())
        rows = chosen.itertuples(index=False, name=None)
        return Response(
            csv_text(itertools.chain([map(str, chosen.columns)], rows)), media_type="text/csv", headers=headers
        )

    return routes


def plain_rows(table: DataFrame) -> list[dict[str, Any]]:
    """Return rows as JSON knows them: whole numbers without a point, nothing where there is no number."""
    return [{str(name): _plain_value(value) for name, value in row.items()} for row in table.to_dict("records")]


def _plain_value(value: Any) -> Any:
    if isinstance(value, float):
        if not math.isfinite(value):
            return None if math.isnan(value) else "inf" if value > 0 else "-inf"
        return int(value) if value.is_integer() and abs(value) < 2**53 else value
    return value.item() if hasattr(value, "item") else value


def _success_summary(chosen: DataFrame) -> list[dict[str, Any]]:
    """Return for each planner and robot how many of its episodes succeeded."""
    if chosen.empty or "success" not in chosen.columns:
        return []
    grouped = chosen.groupby(["preset", "robot"], observed=True, sort=True)["success"].agg(["size", "sum"])
    return [
        {"preset": str(key[0]), "robot": str(key[1]), "episodes": int(size), "succeeded": int(done)}
        for key, size, done in zip(grouped.index, grouped["size"], grouped["sum"], strict=True)
    ]
