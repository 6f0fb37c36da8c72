"""What the robots of runs cost the people there, kept as findings beside the records."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from arena_core import ArenaError, EpisodeRecord, Run
from arena_core.commands import one_line
from arena_core.hosting import Benchmark, Registry, build_benchmark
from arena_core.records import Findings, read_record, record_path, write_findings
from arena_reference.findings import check_simulated
from arena_reference.people_cost import COLUMNS, cost_row, empty_row, free_row
from arena_reference.redriving import scenario_of
from arena_reference.twins import drive_twins

KIND = "cost"  # of the findings
AS_RECORDED = "people walk as recorded, whatever a robot does"
NO_PEOPLE = "no people"
OF_A_TEAM = "the people met several robots, and none is taken out alone"
Row = Mapping[str, float | str]


def cost_of_run(run: Run, registry: Registry) -> Findings:
    """Find what the robot cost the people in each episode of a run, write it beside the records and return it.

    Raises ArenaError for a run that no simulator drove.
    """
    rows = run.episodes.to_dict("records")
    for record in (record_path(run.folder, int(row["episode"])) for row in rows[:1]):
        if record.is_file():
            check_simulated(run.folder, read_record(record))
    benchmark = build_benchmark(run.config, registry)
    found = {int(row["episode"]): _cost_of_episode(run, row, benchmark, registry) for row in rows}
    findings = Findings(KIND, benchmark.code.digest, COLUMNS, found)
    write_findings(run.folder, findings)
    return findings


def _cost_of_episode(run: Run, row: Mapping[str, Any], benchmark: Benchmark, registry: Registry) -> Row:
    number = int(row["episode"])
    path = record_path(run.folder, number)
    if not path.is_file():
        return empty_row(f"no record: {one_line(str(row.get('error', '')))}")
    return cost_of_record(benchmark, registry, read_record(path), number, row.get("stage"))


def cost_of_record(
    benchmark: Benchmark, registry: Registry, record: EpisodeRecord, number: int, stage: object = None
) -> Row:
    """Return what the robot cost the people of an episode, by ``COLUMNS``; ``stage`` as a row of a run has it."""
    if "team" in record.meta:
        return empty_row(OF_A_TEAM)
    if not record["pedestrian_positions"].size:
        return empty_row(NO_PEOPLE)
    people = registry.component("pedestrians", benchmark.config["pedestrians"]["name"]).resolve()
    if getattr(people, "through_walls", False):
        return free_row(record, AS_RECORDED)
    try:
        return cost_row(record, drive_twins(benchmark, record, scenario_of(benchmark, number, stage)))
    except ArenaError as error:
        return empty_row(one_line(str(error)))
