"""``arena scenario show``: what a scenario file holds."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import ClassVar

import numpy as np

from arena_core import ConfigurationError, PedestrianSpec
from arena_core.commands import Command, align_columns
from arena_core.files import option_files
from arena_core.hosting import load_registry
from arena_core.scenes import Door
from arena_tasks.commands.packing import ANYBODY
from arena_tasks.commands.scenario_table import scenario_path
from arena_tasks.scenario_files.card import card_lines
from arena_tasks.scenario_files.problem import Problem, reading_notes
from arena_tasks.scenario_files.scenario_file import ScenarioFile, read_scenario_file

PROBLEMS = ("problem", "repeats", "start", "goal", "straight", "people", "obstacles", "time limit")
PEOPLE = ("problem", "person", "position", "waypoints", "round", "speed", "radius", "behaviour")
DOORS = ("problem", "door", "middle", "open", "again every")
TELLING = ("type", "start_up_mode", "waypoint_mode", "group")  # of a behaviour; of the rest their number


class ShowCommand(Command):
    """Print what a scenario file of any format holds, or one of a pack."""

    help: ClassVar[str] = "what a file holds, in any format: arena scenario show FILE or PACK/NAME"

    def run(self, arguments: Sequence[str]) -> int:
        """Print a table of problems, one of people and one of doors."""
        if "-h" in arguments or "--help" in arguments:
            print(self.help)
            return 0
        if len(arguments) != 1 or arguments[0].startswith("-"):
            raise ConfigurationError(f"arena scenario show {' '.join(arguments)}; allowed: arena scenario show FILE")
        path = _named_file(arguments[0])
        print("\n".join(describe_file(path, read_scenario_file(path, ANYBODY))))
        return 0


def _named_file(word: str) -> Path:
    """Return the file that a word names: the scenario file of a pack where it is an option of ``scenario``."""
    option = option_files("scenario", load_registry().manager).get(word)
    return Path(word) if option is None or Path(word).exists() else scenario_path(option)


def describe_file(path: Path, file: ScenarioFile) -> list[str]:
    """Return the lines about a file: its head, its problems, its people."""
    head = [f"{path}{': ' if file.title else ''}{file.title}", *([f"map: {file.map}"] if file.map else [])]
    head += card_lines(file.card) if file.card else []
    people = [(problem.name, *_person_row(person)) for problem in file.problems for person in problem.pedestrians]
    doors = [
        (problem.name, str(number), *_door_row(door))
        for problem in file.problems
        for number, door in enumerate(problem.doors)
    ]
    tables = [[PROBLEMS, *map(_problem_row, file.problems)], *([[PEOPLE, *people]] if people else [])]
    tables += [[DOORS, *doors]] if doors else []
    notes = reading_notes(file.problems)
    return (
        head
        + [line for table in tables for line in ("", *align_columns(table))]
        + (["", f"read otherwise: {notes}"] if notes else [])
    )


def _problem_row(problem: Problem) -> tuple[str, ...]:
    return (
        problem.name,
        str(problem.repeats),
        f"({problem.start.x:.2f}, {problem.start.y:.2f})",
        f"({problem.goal.x:.2f}, {problem.goal.y:.2f})",
        f"{problem.start.distance(problem.goal):.1f} m",
        str(len(problem.pedestrians)),
        str(len(problem.obstacles)),
        "the task's" if problem.time_limit is None else f"{problem.time_limit:g} s",
    )


def _person_row(person: PedestrianSpec) -> tuple[str, ...]:
    ways = person.waypoints_xy
    length = np.hypot(*(ways - np.roll(ways, 1, axis=0)).T).sum()
    telling = [f"{key}={person.behaviour[key]}" for key in TELLING if person.behaviour.get(key, "default") != "default"]
    rest = len(person.behaviour.keys() - set(TELLING))
    return (
        str(person.id),
        f"({person.position_xy[0]:.2f}, {person.position_xy[1]:.2f})",
        str(len(ways)) if len(ways) else "stands",
        f"{length:.1f} m",
        f"{person.desired_speed:g} m/s",
        f"{person.radius:g} m",
        ", ".join([*telling, *([f"{rest} more" if telling else f"{rest} keys"] if rest else [])]),
    )


def _door_row(door: Door) -> tuple[str, ...]:
    x, y = door.vertices_xy.mean(axis=0)
    times = [f"{begin:g} .. {end:g} s" if end < np.inf else f"from {begin:g} s" for begin, end in door.open.tolist()]
    return f"({x:.2f}, {y:.2f})", ", ".join(times), "-" if door.period is None else f"{door.period:g} s"
