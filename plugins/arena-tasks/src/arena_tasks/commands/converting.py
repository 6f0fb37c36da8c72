"""``arena scenario convert``: a scenario file from one format into another."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import ClassVar, Literal

from arena_core import ConfigurationError
from arena_core.commands import Command, Words, read_words
from arena_core.files import write_text_whole
from arena_tasks.commands.packing import ANYBODY
from arena_tasks.scenario_files.arena_rosnav_writer import arena_rosnav_text, world_name
from arena_tasks.scenario_files.arena_rosnav_writer import unsupported_parts as left_out_by_arena_rosnav
from arena_tasks.scenario_files.arena_tools_writer import arena_tools_text, flatland_model_text, unsupported_parts
from arena_tasks.scenario_files.problem import Problem, reading_notes
from arena_tasks.scenario_files.scenario_file import FORMAT, ScenarioFile, read_scenario_file, save_scenarios

ARENA_TOOLS, ARENA_ROSNAV = "arena-tools", "arena-rosnav"
FORMATS = (FORMAT, ARENA_TOOLS, ARENA_ROSNAV)
MODEL = ".model.yaml"
KEYS = ("out", "format", "problem", "map")
USAGE = f"arena scenario convert IN out=FILE [format={'|'.join(FORMATS)}] [problem=NAME] [map=MAP.yaml]"


class ConvertCommand(Command):
    """Read a scenario file of any format and write it in ours, that of arena-tools or that of arena-rosnav."""

    help: ClassVar[str] = f"convert a file: {USAGE}"

    def run(self, arguments: Sequence[str]) -> int:
        """Write the file, print its name and say what its format has no place for."""
        if "-h" in arguments or "--help" in arguments:
            print(self.help)
            return 0
        words = read_words(USAGE, arguments, names=None, keys=KEYS)
        source, target = words.source_and_target()
        given = words.value("format", Literal[FORMATS], FORMAT)
        file = read_scenario_file(source, ANYBODY)
        problems = _choose_problems(file, source, words, given)
        if given == FORMAT:
            map_file = (
                os.path.relpath(words.keys["map"], target.parent)
                if "map" in words.keys
                else _map_from(file, source, target.parent)
            )
            save_scenarios(target, problems, file.title, map_file)
        else:
            write = _write_arena_tools if given == ARENA_TOOLS else _write_arena_rosnav
            write(target, problems[0], words.keys.get("map", _map_from(file, source, Path.cwd())))
        if notes := reading_notes(problems):
            print(f"read otherwise: {notes}")
        print(f"written: {target}")
        return 0


def _choose_problems(file: ScenarioFile, source: Path, words: Words, written: str) -> list[Problem]:
    """Return the problems to write: the one that is named, or all; other programs have one in a file."""
    names = ", ".join(problem.name for problem in file.problems)
    chosen = [problem for problem in file.problems if words.keys.get("problem", problem.name) == problem.name]
    if not chosen:
        raise ConfigurationError(f"problem is {words.keys['problem']}; allowed, in {source}: {names}")
    if written != FORMAT and len(chosen) > 1:
        raise ConfigurationError(
            f"{source} holds {len(chosen)} problems; allowed in format {written}: one, by problem= and one of {names}"
        )
    return chosen


def _map_from(file: ScenarioFile, source: Path, folder: Path) -> str:
    """Return the map that a file names, as seen from ``folder``; empty where it names none."""
    return os.path.relpath(source.parent / file.map, folder) if file.map else ""


def _write_arena_tools(target: Path, problem: Problem, map_path: str) -> None:
    """Write a problem, and its obstacles as Flatland models beside it, which it names by their files."""
    stems = _write_models(target, problem)
    write_text_whole(target, arena_tools_text(problem, map_path, [f"{stem}{MODEL}" for stem in stems]))
    _print_left_out(unsupported_parts(problem))


def _write_arena_rosnav(target: Path, problem: Problem, map_path: str) -> None:
    """Write a problem, and its obstacles as Flatland models beside it, which it names; of the
    map the world's name counts.
    """
    write_text_whole(target, arena_rosnav_text(problem, world_name(map_path), _write_models(target, problem)))
    _print_left_out(left_out_by_arena_rosnav(problem))


def _write_models(target: Path, problem: Problem) -> list[str]:
    """Write the models of a problem's obstacles beside a file, and return their names without MODEL."""
    stems = [f"{target.stem}.obstacle_{number}" for number in range(len(problem.obstacles))]
    for stem, obstacle in zip(stems, problem.obstacles, strict=True):
        write_text_whole(target.parent / f"{stem}{MODEL}", flatland_model_text(obstacle))
        print(f"written: {target.parent / stem}{MODEL}")
    return stems


def _print_left_out(left_out: Sequence[str]) -> None:
    for what in left_out:
        print(f"left out: {what}")
