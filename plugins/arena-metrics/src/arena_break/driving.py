"""Drive problems as ordinary runs of a scenario file: by the planner searched against, and by the clairvoyant."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from arena_core import EpisodeRecord, Run
from arena_core.commands import key_value
from arena_core.files import LIMITS, read_json, read_text
from arena_core.hosting import RunFolderError, run_jobs
from arena_tasks.scenario_files.problem import Problem
from arena_tasks.scenario_files.scenario_file import content_of, save_scenarios, scenario_text

FIXED = ("report=false", "metrics=[si]", "task=scenario", "world=ros_map")
USUAL = ("localizer=amcl", "tracker=kalman")  # as the ladder has them
PLANNED = ("planner", "localizer", "tracker", "predictor", "local_map", "global_planner", "waypoints", "timing")
CERTIFIED = ("planner=clairvoyant", "localizer=ground_truth", "timing.mode=ideal")
FILE = "problems.json"


@dataclass(frozen=True, slots=True, eq=False)
class Episode:
    """What came of a problem: its row of ``episodes.csv``, and the run that holds its record."""

    row: Mapping[str, Any]
    run: Run

    @property
    def strict(self) -> bool:
        """Return whether the goal was reached in time without any contact."""
        return str(self.row.get("strict_success", "")) in ("1.0", "1")

    @property
    def error(self) -> str:
        """Return what ended the episode, empty where nothing raised."""
        return str(self.row["error"]) if self.row["outcome"] == "error" else ""

    def record(self) -> EpisodeRecord:
        """Return its record; raise InputFileError where there is none."""
        return self.run.record(int(self.row["episode"]))


@dataclass(frozen=True, slots=True)
class Site:
    """Where problems are driven: the map's YAML file, and the words of the run (planner, robot, whatever else)."""

    map_file: Path
    words: tuple[str, ...]
    margin: tuple[float, float]  # m from people and from walls that the clairvoyant keeps

    def planner_words(self) -> list[str]:
        """Return the words of a run by the planner."""
        given = {key_value(word)[0] for word in self.words}
        return [*(word for word in USUAL if key_value(word)[0] not in given), *self.words]

    def clairvoyant_words(self) -> list[str]:
        """Return the words of a run by the clairvoyant: what is not of the robot's brain stays."""
        kept = [word for word in self.words if key_value(word)[0].partition(".")[0] not in PLANNED]
        people, walls = self.margin
        tries = [(0.05, 64), (0.025, 160)]
        attempts = ",".join(f"{{cell:{cell},width:{width},walls:{walls},people:{people}}}" for cell, width in tries)
        return [*CERTIFIED, *kept, f"planner.attempts=[{attempts}]"]


def write_problems(path: Path, problems: Sequence[Problem], title: str, map_file: Path) -> None:
    """Write a scenario file, or check that it holds these problems already; raise RunFolderError where it does not."""
    map_name = os.path.relpath(map_file, path.parent)
    if path.exists():
        if read_text(path, LIMITS.json_bytes, "what `arena break` wrote") != scenario_text(
            content_of(problems, title, map_name)
        ):
            raise RunFolderError(f"{path} holds other problems; allowed: the folder as it was left, or another out=DIR")
        return
    path.parent.mkdir(parents=True, exist_ok=True)
    save_scenarios(path, problems, title, map_name)


def drive(
    site: Site, folder: Path, problems: Sequence[Problem], keys: Sequence[int], *, clairvoyant: bool = False
) -> list[dict[str, Episode]]:
    """Drive all problems under each seed of noise; return the episodes of each seed by problem's name.

    What is finished in ``folder`` is not driven again. A problem that its world refuses is in none of them.
    """
    if not problems:
        return [{} for _ in keys]
    file = folder / FILE
    write_problems(file, problems, f"{len(problems)} problems of a search", site.map_file)
    return drive_file(site, file, folder, keys, clairvoyant=clairvoyant)


def drive_file(
    site: Site, file: Path, folder: Path, keys: Sequence[int], *, clairvoyant: bool = False
) -> list[dict[str, Episode]]:
    """Drive each problem of a scenario file once under each seed of noise, as ``drive`` does."""
    count = len(read_json(file, "what `arena break` wrote")["scenarios"])
    who = "clairvoyant" if clairvoyant else "planner"
    chosen = site.clairvoyant_words() if clairvoyant else site.planner_words()
    places = [folder / f"{who}_{key}" for key in keys]
    common = [*FIXED, *chosen, f"world.path={quoted(site.map_file)}", f"task.path={quoted(file)}", f"episodes={count}"]
    jobs = {
        place: [*common, f"seed={key}", *(["resume=true"] if place.exists() else [])]
        for place, key in zip(places, keys, strict=True)
    }
    run_jobs(jobs)
    return [read_episodes(Run(place)) for place in places]


def read_episodes(run: Run) -> dict[str, Episode]:
    """Return the first episode of each problem of a run, by the problem's name."""
    rows: Iterable[dict[str, Any]] = run.episodes.sort_values("episode").to_dict("records")
    found: dict[str, Episode] = {}
    for row in rows:
        name, _, repetition = str(row["scenario"]).rpartition("/")
        if repetition == "0000":
            found[name] = Episode(row, run)
    return found


def quoted(path: Path) -> str:
    """Return an absolute path as a word of Hydra holds it."""
    text = str(path.absolute()).replace("\\", "\\\\").replace("'", "\\'")
    return f"'{text}'"
