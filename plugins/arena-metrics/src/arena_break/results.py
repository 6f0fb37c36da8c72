"""What a search leaves: a scenario pack, the records that prove it, pictures, and a card."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from arena_break.confirming import Hard
from arena_break.driving import Site, drive_file
from arena_break.judging import CLEAR, certified_clearance
from arena_break.request import Request
from arena_break.searching import Search
from arena_core.commands import print_notice
from arena_core.files import csv_text, write_text_whole
from arena_core.hosting import Registry
from arena_core.records import installed_versions
from arena_reference.explaining import explain_run
from arena_tasks.commands.packing import make_pack
from arena_tasks.scenario_files.problem import Problem
from arena_tasks.scenario_files.scenario_file import save_scenarios
from arena_worlds.formats.map_writer import write_map

PACK, EVIDENCE, PICTURES = "pack", "evidence", "pictures"
CARD, TABLE = "card.json", "problems.csv"
SIDE = 320  # pixels of a picture's panel
SEED_STEP = 1000  # between the numbers of a seed's problems and those of the next
BEFORE = 1.5  # s before it was decided that a picture shows, too
COLUMNS = ("name", "people", "cause", "whom", "at", "until", "instead", "time_certified", "clearance", "found_as")


@dataclass(frozen=True, slots=True, eq=False)
class Proven:
    """A problem of the pack with what was found out about it."""

    hard: Hard
    explanation: str
    row: Mapping[str, Any]


def write_ground(request: Request) -> Path:
    """Write the world's map to the pack; return its YAML file."""
    path = request.folder / PACK / "maps" / f"{request.course.world.name}.yaml"
    if not path.exists():
        path.parent.mkdir(parents=True, exist_ok=True)
        write_map(path, request.course.world.grid)
    return path


def write_pack(request: Request, site: Site, problems: Sequence[Problem]) -> Path:
    """Write the problems as a scenario pack; return the scenario file."""
    folder = request.folder / PACK
    file = folder / "scenarios" / f"{request.name}.json"
    file.parent.mkdir(parents=True, exist_ok=True)
    facts = request.facts
    title = (
        f"{len(problems)} problems in which {facts['preset']} fails on {facts['robot']} and the clairvoyant keeps "
        f"{request.bounds.margin.people:g} m from people (seed {request.seed}, {request.budget} problems)"
    )
    save_scenarios(file, problems, title, f"../maps/{site.map_file.name}")
    make_pack(folder, {"id": f"hard_{request.name}", "title": title, "licence": "MIT"})
    return file


def prove(
    request: Request, site: Site, problems: Sequence[Problem], found_as: Mapping[str, str], registry: Registry
) -> list[Proven]:
    """Drive the pack itself: by the planner under every seed of noise, and by the clairvoyant; explain each failure."""
    file, place, keys = write_pack(request, site, problems), request.folder / EVIDENCE, request.bounds.keys
    driven = drive_file(site, file, place, keys)
    (certified,) = drive_file(site, file, place, keys[:1], clairvoyant=True)
    told = {one.episode: one for one in explain_run(driven[0][problems[0].name].run, registry, None)}
    found = []
    for problem in problems:
        episodes = [by_name[problem.name] for by_name in driven]
        clear = certified_clearance(certified[problem.name], request.bounds.margin.people)
        explained = told[int(episodes[0].row["episode"])]
        decided = next((one for one in explained.contacts if one.decided), None)
        hard = Hard(problem, episodes, certified[problem.name], clear if clear is not None else float("nan"))
        row = {
            "name": problem.name,
            "people": len(problem.pedestrians),
            "cause": decided.cause if decided else "",
            "whom": decided.whom if decided else "",
            "at": decided.stamp if decided else None,
            "until": decided.avoidable_until if decided and decided.lead == decided.lead else None,
            "instead": decided.instead if decided else "",
            "time_certified": _number(certified[problem.name].row.get("time_to_goal")),
            "clearance": round(hard.clear, 3),
            "found_as": found_as[problem.name],
            "keys": {
                str(key): {"outcome": one.row["outcome"], "collisions": _number(one.row.get("collisions"))}
                for key, one in zip(keys, episodes, strict=True)
            },
        }
        found.append(Proven(hard, decided.sentence() if decided else "", row))
    return found


def write_results(request: Request, search: Search, counts: Mapping[str, int], proven: Sequence[Proven]) -> list[str]:
    """Write pictures, table and card; return what to print."""
    folder = request.folder
    for one in proven:
        _draw(folder / PICTURES / f"{one.hard.problem.name}.png", one)
    card = {
        **request.facts,
        "search": {
            "problems": search.tried,
            "batches": search.batches,
            "failures": search.failures,
            "uncertified": search.uncertified,
            "hard": len(search.hard),
            "curve": search.curve,
            **counts,
        },
        "versions": {name: text for name, text in installed_versions().items() if name in ("ribs", "numpy")},
        "problems": [{**one.row, "told": one.explanation} for one in proven],
    }
    write_text_whole(folder / CARD, json.dumps(card, indent=1, allow_nan=False) + "\n")
    rows = [[one.row[name] for name in COLUMNS] for one in proven]
    write_text_whole(folder / TABLE, csv_text([COLUMNS, *rows]))
    return [_line(one) for one in proven]


def renamed(problems: Sequence[Problem], name: str, seed: int) -> list[Problem]:
    """Return problems under the names that they have in the pack: no two searches against a planner share one."""
    return [replace(one, name=f"{name}_{SEED_STEP * seed + number:02d}") for number, one in enumerate(problems)]


def _line(one: Proven) -> str:
    said = one.explanation.partition(": ")[2] or "no contact"
    row = one.row
    return (
        f"{row['name']}: {row['people']} people; {said}; the clairvoyant needs {row['time_certified']} s "
        f"and keeps {row['clearance']} m{' or more' if row['clearance'] >= CLEAR else ''}"
    )


def _draw(target: Path, one: Proven) -> None:
    """Draw moments of the failure above those of the clairvoyant: the start, before and when it is decided, the end."""
    try:
        from arena_drawing.film import write_picture
        from arena_viewer.document import read_recorded
        from arena_viewer.stills import EpisodeStills, view_bounds
    except ImportError:
        print_notice(f"{target} is not drawn; allowed: arena-viewer beside arena-metrics")
        return
    episodes = (one.hard.episodes[0], one.hard.certificate)
    if any(episode.error for episode in episodes):
        return
    target.parent.mkdir(parents=True, exist_ok=True)
    shown = [read_recorded(episode.run.folder, int(episode.row["episode"])) for episode in episodes]
    window, decided = view_bounds(shown), float(one.row["at"] or 0.0)
    rows = []
    for recorded in shown:
        stills = EpisodeStills(recorded, SIDE, window, recorded.name)
        stamps = (0.0, max(decided - BEFORE, 0.0), min(decided, stills.end), stills.end)
        rows.append(np.concatenate([stills.at(stamp) for stamp in stamps], axis=1))
    write_picture(target, np.concatenate(rows, axis=0))


def _number(value: Any) -> float | None:
    try:
        found = float(value)
    except (TypeError, ValueError):
        return None
    return round(found, 3) if found == found else None
