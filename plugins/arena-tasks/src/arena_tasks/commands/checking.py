"""``arena scenario check``: which problems of a file can be run, and why the others cannot."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import ClassVar

from arena_core.commands import Command, align_columns, read_words
from arena_tasks.scenario_files.problem import PersonDefaults, reading_notes
from arena_tasks.scenario_files.scenario_file import read_scenario_file
from arena_tasks.scenario_files.site import KINDS, Site, compose_run

USAGE = "arena scenario check FILE [world=... robot=... pedestrians=... task.KEY=...]"
SOME_IMPOSSIBLE = 1  # exit status; 2 is that of an error


class CheckCommand(Command):
    """Check each problem of a file in a world, for a robot and a model of people."""

    help: ClassVar[str] = f"which problems of a file can be run: {USAGE}"

    def run(self, arguments: Sequence[str]) -> int:
        """Print a line for each problem; return 0 where all are possible, 1 where some are not.

        Raise ArenaError for an unreadable file.
        """
        if "-h" in arguments or "--help" in arguments:
            print(self.help)
            return 0
        words = read_words(USAGE, arguments, names=1, overrides=KINDS)
        path = Path(words.names[0])
        node = compose_run(path, words.overrides)
        task = node["task"]
        file = read_scenario_file(path, PersonDefaults(task["pedestrian_speed"], task["pedestrian_radius"]))
        site = Site(path, node)
        findings = [(problem.name, site.reason_against(problem)) for problem in file.problems]
        impossible = [reason for _, reason in findings if reason]
        print(
            "\n".join(
                align_columns([(name, "impossible" if reason else "possible", reason) for name, reason in findings])
            )
        )
        if notes := reading_notes(file.problems):
            print(f"read otherwise: {notes}")
        print(
            f"{path}: {len(findings) - len(impossible)} of {len(findings)} problems possible in {site.world.name} "
            f"for {site.robot.name}"
        )
        return SOME_IMPOSSIBLE if impossible else 0
