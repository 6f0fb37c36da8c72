"""``arena scenario convert``: a scenario file from one format into another."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import ClassVar

from arena_core import Command, ConfigurationError, write_text_whole
from arena_tasks.arena_rosnav_writer import arena_rosnav_text, world_name
from arena_tasks.arena_rosnav_writer import left_out as left_out_by_arena_rosnav
from arena_tasks.arena_tools_writer import arena_tools_text, flatland_model_text, left_out
from arena_tasks.packing import ANYBODY
from arena_tasks.problem import Problem, noted
from arena_tasks.scenario_file import FORMAT, ScenarioFile, read_scenario_file, save_scenarios

ARENA_TOOLS, ARENA_ROSNAV = "arena-tools", "arena-rosnav"
FORMATS = (FORMAT, ARENA_TOOLS, ARENA_ROSNAV)
MODEL = ".model.yaml"
KEYS = {"format": "|".join(FORMATS), "problem": "NAME", "map": "MAP.yaml"}


class ConvertCommand(Command):
    """Read a scenario file of any format and write it in ours, that of arena-tools or that of arena-rosnav."""

    help: ClassVar[str] = "convert a file: arena scenario convert IN OUT " + " ".join(f"[{key}={value}]" for key, value in KEYS.items())

    def run(self, arguments: Sequence[str]) -> int:
        """Write OUT, print its name and say what its format has no place for."""
        if "-h" in arguments or "--help" in arguments:
            print(self.help)
            return 0
        source, target, words = _given(arguments)
        file = read_scenario_file(source, ANYBODY)
        problems = _chosen(file, source, words)
        given = words.get("format", FORMAT)
        if given == FORMAT:
            map_file = os.path.relpath(words["map"], target.parent) if "map" in words else _map_from(file, source, target.parent)
            save_scenarios(target, problems, file.title, map_file)
        else:
            write = _write_arena_tools if given == ARENA_TOOLS else _write_arena_rosnav
            write(target, problems[0], words.get("map", _map_from(file, source, Path.cwd())))
        if notes := noted(problems):
            print(f"read otherwise: {notes}")
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
    """Return the problems to write: the one that is named, or all; other programs have one in a file."""
    names = ", ".join(problem.name for problem in file.problems)
    chosen = [problem for problem in file.problems if words.get("problem", problem.name) == problem.name]
    if not chosen:
        raise ConfigurationError(f"problem is {words['problem']}; allowed, in {source}: {names}")
    if words.get("format", FORMAT) != FORMAT and len(chosen) > 1:
        raise ConfigurationError(
            f"{source} holds {len(chosen)} problems; allowed in format {words['format']}: one, by problem= and one of {names}"
        )
    return chosen


def _map_from(file: ScenarioFile, source: Path, folder: Path) -> str:
    """Return the map that a file names, as seen from ``folder``; empty where it names none."""
    return os.path.relpath(source.parent / file.map, folder) if file.map else ""


def _write_arena_tools(target: Path, problem: Problem, map_path: str) -> None:
    """Write a problem, and its obstacles as Flatland models beside it, which it names by their files."""
    stems = _write_models(target, problem)
    write_text_whole(target, arena_tools_text(problem, map_path, [f"{stem}{MODEL}" for stem in stems]))
    _tell(left_out(problem))


def _write_arena_rosnav(target: Path, problem: Problem, map_path: str) -> None:
    """Write a problem, and its obstacles as Flatland models beside it, which it names; of the map the world's name counts."""
    write_text_whole(target, arena_rosnav_text(problem, world_name(map_path), _write_models(target, problem)))
    _tell(left_out_by_arena_rosnav(problem))


def _write_models(target: Path, problem: Problem) -> list[str]:
    """Write the models of a problem's obstacles beside a file, and return their names without MODEL."""
    stems = [f"{target.stem}.obstacle_{number}" for number in range(len(problem.obstacles))]
    for stem, obstacle in zip(stems, problem.obstacles, strict=True):
        write_text_whole(target.parent / f"{stem}{MODEL}", flatland_model_text(obstacle))
        print(f"written: {target.parent / stem}{MODEL}")
    return stems


def _tell(left_out: Sequence[str]) -> None:
    for what in left_out:
        print(f"left out: {what}")
