"""Explanations of the failures of a run: what happened, who caused it, and until when it could have been avoided."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from arena_core import ArenaError, ConfigurationError, EpisodeRecord, Run
from arena_core.commands import one_line
from arena_core.hosting import Benchmark, Registry, Truth, build_benchmark, compose, to_plain
from arena_core.parameters import read_settings
from arena_core.records import read_record, record_path
from arena_reference.causes import Contact, cause_of, contacts_of
from arena_reference.explanations import ExplainedEpisode, Explanation, write_explanations
from arena_reference.findings import check_simulated
from arena_reference.incidents import incidents_of
from arena_reference.moments import drive_again, in_words, last_avoidable
from arena_reference.redriving import RecordDiffers, scenario_of
from arena_reference.ways import SearchSettings, Way, WayFinder

NAN = math.nan
STEP = 0.25  # s between the places of a way out
OF_A_TEAM = "in a team no way out is looked for"
LOOK_BACK = 15.0  # s before a contact, from which on a way out is looked for


def explain_run(run: Run, registry: Registry, episodes: list[int] | None) -> list[ExplainedEpisode]:
    """Explain the episodes of a run, or some of them; write it beside its records where all are asked for."""
    rows = run.episodes.to_dict("records")
    there = {int(row["episode"]) for row in rows}
    if missing := sorted(set(episodes or ()) - there):
        raise ConfigurationError(f"episode is {missing[0]}; allowed: one of the {len(there)} of {run.folder}")
    for record in (record_path(run.folder, number) for number in sorted(there)[:1]):
        if record.is_file():
            check_simulated(run.folder, read_record(record))
    benchmark = build_benchmark(run.config, registry)
    finder = _finder(benchmark)
    wanted = [row for row in rows if episodes is None or int(row["episode"]) in episodes]
    found = [_explain_row(run, row, benchmark, finder) for row in wanted]
    if episodes is None:
        write_explanations(run.folder, found, benchmark.code.digest)
    return found


def _finder(benchmark: Benchmark) -> WayFinder:
    settings = to_plain(compose(["planner=clairvoyant"]))["planner"]
    chosen = {key: settings[key] for key in SearchSettings.__slots__}
    search = read_settings(chosen, SearchSettings, "planner")
    return WayFinder(benchmark.robot, search, benchmark.navigator.control_period)


def _explain_row(run: Run, row: dict[str, object], benchmark: Benchmark, finder: WayFinder) -> ExplainedEpisode:
    number = int(str(row["episode"]))
    try:
        record = run.record(number)
    except ArenaError as error:
        if str(row.get("error", "")):
            failed = Explanation(number, "error", "", 0.0, True, NAN, NAN, "", one_line(str(row["error"])))
            return ExplainedEpisode(number, [failed], [])
        raise error
    contacts = list(explain_episode(number, record, benchmark, finder, row.get("stage")))
    return ExplainedEpisode(number, contacts, incidents_of(record))


def explain_episode(
    number: int, record: EpisodeRecord, benchmark: Benchmark, finder: WayFinder, stage: object = None
) -> Iterator[Explanation]:
    """Yield what is known of each contact of an episode, or of its failure without any."""
    cause = cause_of(record)
    if cause is None:
        return
    contacts = contacts_of(record)
    if not contacts:
        yield Explanation(number, cause.what, cause.whom, cause.stamp, True, NAN, NAN, "", "")
        return
    steps, differs = list[tuple[float, Truth]](), OF_A_TEAM
    if "team" not in record.meta:
        scenario = scenario_of(benchmark, number, stage)
        steps, differs = _steps_of(drive_again(benchmark, record, scenario, *_span_of(contacts)))
    for index, contact in enumerate(contacts):
        what = cause.what if index == 0 else "ran into" if contact.caused else "was run into"
        since = max(contact.stamp - LOOK_BACK, contacts[index - 1].stamp if index else 0.0)
        worlds = [world for stamp, world in steps if since - 1e-9 <= stamp <= contact.stamp + 1e-9]
        if not worlds or (differs and steps[-1][0] < contact.stamp - benchmark.navigator.control_period - 1e-9):
            note = differs or "it began with the contact before"
            yield Explanation(number, what, contact.whom, contact.stamp, index == 0, NAN, NAN, "", note)
            continue
        moment = last_avoidable(worlds, finder, contact.stamp)
        if moment.stamp is None or moment.way is None:
            note = f"no way out was found in the {contact.stamp - since:.1f} s before"
            yield Explanation(number, what, contact.whom, contact.stamp, index == 0, NAN, NAN, "", note)
            continue
        words = in_words(moment.way)
        lead = contact.stamp - moment.stamp
        places = _places(moment.way)
        yield Explanation(number, what, contact.whom, contact.stamp, index == 0, moment.stamp, lead, words, "", places)


def _places(way: Way) -> list[tuple[float, float]]:
    """Return places (x, y) of a way, ``STEP`` s apart, to the millimetre."""
    stamps = way.period * np.arange(len(way.states))
    wanted = np.arange(0.0, stamps[-1] + STEP, STEP)
    xs, ys = (np.round(np.interp(wanted, stamps, way.states[:, axis]), 3).tolist() for axis in range(2))
    return list(zip(xs, ys, strict=True))


def _span_of(contacts: Sequence[Contact]) -> tuple[float, float]:
    """Return from when to when an episode is driven again for its contacts, s."""
    return contacts[0].stamp - LOOK_BACK, contacts[-1].stamp


def _steps_of(driven: Iterator[tuple[float, Truth]]) -> tuple[list[tuple[float, Truth]], str]:
    """Return time and truth of the steps of an episode that is driven again, as far as it goes as recorded, and why no
    farther.
    """
    steps: list[tuple[float, Truth]] = []
    try:
        for step in driven:
            steps.append(step)  # noqa: PERF402 - what was driven until it differs counts
    except RecordDiffers as error:
        return steps, str(error)
    return steps, ""
