"""``arena scenario draw``: a picture of what a scenario file holds, on its map, without a browser."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import ClassVar

from arena_core import ConfigurationError
from arena_core.commands import Command, Words, read_words
from arena_core.hosting import require_extra
from arena_core.parameters import NonNegativeInt
from arena_tasks.scenario_files.problem import PersonDefaults, Problem, reading_notes
from arena_tasks.scenario_files.scenario_file import ScenarioFile, read_scenario_file
from arena_tasks.scenario_files.site import KINDS, Site, compose_run

KEYS = ("out", "scene")
USAGE = "arena scenario draw FILE [out=FILE.png] [scene=N] [world=... robot=...]"
MOST = 12  # scenes in one picture


class DrawCommand(Command):
    """Draw the problems of a file on their map."""

    help: ClassVar[str] = f"a picture of a file: {USAGE}"

    def run(self, arguments: Sequence[str]) -> int:
        """Write the picture and print its name."""
        if "-h" in arguments or "--help" in arguments:
            print(self.help)
            return 0
        require_extra("arena scenario draw", ["arena_drawing"], "arena-tasks[draw]")
        words = read_words(USAGE, arguments, names=1, keys=KEYS, overrides=KINDS)
        path = Path(words.names[0])
        target = Path(words.keys.get("out", path.with_suffix(".png").name))
        if target.suffix != ".png":
            raise ConfigurationError(f"out is {target.name}; allowed: a name that ends in .png")
        node = compose_run(path, words.overrides)
        file = read_scenario_file(
            path, PersonDefaults(node["task"]["pedestrian_speed"], node["task"]["pedestrian_radius"])
        )
        _write_drawing(choose_problems(file, path, words), Site(path, node), target)
        if notes := reading_notes(file.problems):
            print(f"read otherwise: {notes}")
        print(f"written: {target}")
        return 0


def choose_problems(file: ScenarioFile, path: Path, words: Words) -> Sequence[Problem]:
    """Return the problem that ``scene`` numbers, or all of a file; raise ConfigurationError where there are
    too many, or no such one.
    """
    number = words.value("scene", NonNegativeInt | None, None)
    last = len(file.problems) - 1
    if number is not None and number > last:
        raise ConfigurationError(f"scene is {number}; allowed, in {path}: 0 .. {last}")
    if number is None and last >= MOST:
        raise ConfigurationError(
            f"{path} holds {last + 1} scenes; allowed in one picture: {MOST}, or one by scene=0 .. {last}"
        )
    return file.problems if number is None else [file.problems[number]]


def _write_drawing(problems: Sequence[Problem], site: Site, target: Path) -> None:
    from arena_drawing.film import write_picture
    from arena_tasks.commands.picture import draw_problems

    write_picture(target, draw_problems(problems, site.world, site.robot, site.goal_radius))
