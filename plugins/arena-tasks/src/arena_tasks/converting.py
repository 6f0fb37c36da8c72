"""``arena scenario convert``: a scenario file from one format into another."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import ClassVar

from arena_core import Command, ConfigurationError, write_text_whole
from arena_tasks.arena_tools_writer import arena_tools_text, flatland_model_text, left_out
from arena_tasks.packing import ANYBODY
from arena_tasks.problem import Problem
from arena_tasks.scenario_file import FORMAT, ScenarioFile, read_scenario_file, save_scenarios

ARENA_TOOLS = "arena-tools"
FORMATS = (FORMAT, ARENA_TOOLS)
KEYS = {"format": "|".join(FORMATS), "problem": "NAME", "map": "MAP.yaml"}


class ConvertCommand(Command):
    """Read a scenario file of any format and write it in ours or that of arena-tools."""

    help: ClassVar[str] = "convert a file: arena scenario convert IN OUT " + " ".join(f"[{key}={value}]" for key, value in KEYS.items())

    def run(self, arguments: Sequence[str]) -> int:
        """Write OUT, print its name and say what its format has no place for."""
        if "-h" in arguments or "--help" in arguments:
            print(self.help)
            return 0
        source, target, words = _given(arguments)
        file = read_scenario_file(source, ANYBODY)
        problems = _chosen(file, source, words)
        if words.get("format", FORMAT) == ARENA_TOOLS:
            _write_arena_tools(target, problems, words.get("map", _map_from(file, source, Path.cwd())))
        else:
            map_file = os.path.relpath(words["map"], target.parent) if "map" in words else _map_from(file, source, target.parent)
            save_scenarios(target, problems, file.title, map_file)
        print(f"written: {target}")
        return 0


def _given(arguments: Sequence[str]) -> tuple[Path, Path, dict[str, str]]:
    """Return IN, OUT and the words; raise ConfigurationError."""
    files = [Path(word) for word in arguments if "=" not in word]
    words = dict(word.split("=", 1) for word in arguments if "=" in word)
    if len(files) != 2:
        raise ConfigurationError(f"arena scenario convert has {len(files)} files; allowed: IN OUT, then {', '.join(KEYS)}")
    for key, value in words.items():
        if key not in KEYS or not value:
            raise ConfigurationError(f"arena scenario convert: {key}={value}; allowed: {' '.join(f'{k}={v}' for k, v in KEYS.items())}")
    if words.get("format", FORMAT) not in FORMATS:
        raise ConfigurationError(f"format is {words['format']}; allowed: {' or '.join(FORMATS)}")
    return files[0], files[1], words


def _chosen(file: ScenarioFile, source: Path, words: Mapping[str, str]) -> list[Problem]:
    """Return the problems to write: the one that is named, or all; arena-tools has one in a file."""
    names = ", ".join(problem.name for problem in file.problems)
    chosen = [problem for problem in file.problems if words.get("problem", problem.name) == problem.name]
    if not chosen:
        raise ConfigurationError(f"problem is {words['problem']}; allowed, in {source}: {names}")
    if words.get("format") == ARENA_TOOLS and len(chosen) > 1:
        raise ConfigurationError(
            f"{source} holds {len(chosen)} problems; allowed in format {ARENA_TOOLS}: one, by problem= and one of {names}"
        )
    return chosen


def _map_from(file: ScenarioFile, source: Path, folder: Path) -> str:
    """Return the map that a file names, as seen from ``folder``; empty where it names none."""
    return os.path.relpath(source.parent / file.map, folder) if file.map else ""


def _write_arena_tools(target: Path, problems: Sequence[Problem], map_path: str) -> None:
    """Write a problem, and its obstacles as Flatland models beside it, which it names."""
    (problem,) = problems
    models = [f"{target.stem}.obstacle_{number}.model.yaml" for number in range(len(problem.obstacles))]
    for name, obstacle in zip(models, problem.obstacles, strict=True):
        write_text_whole(target.parent / name, flatland_model_text(obstacle))
        print(f"written: {target.parent / name}")
    write_text_whole(target, arena_tools_text(problem, map_path, models))
    for what in left_out(problem):
        print(f"left out: {what}")
