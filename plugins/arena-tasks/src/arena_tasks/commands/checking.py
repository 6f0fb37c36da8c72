"""``arena scenario check``: which problems of a file can be run, and why the others cannot."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from arena_core import (
    ArenaError,
    Command,
    ConfigurationError,
    PedestrianModel,
    Robot,
    Scenario,
    World,
    aligned,
    compose,
    furnished,
    load_registry,
    option_files,
    plain,
    read_words,
)
from arena_tasks.scenario_files.feasibility import Feasibility
from arena_tasks.scenario_files.problem import PersonDefaults, Problem, noted
from arena_tasks.scenario_files.scenario_file import read_scenario_file

USUAL = {"world": "scenario_map", "robot": "turtlebot3", "pedestrians": "social_force"}  # what is checked unless told otherwise
KINDS = (*USUAL, "task")
USAGE = "arena scenario check FILE [world=... robot=... pedestrians=... task.KEY=...]"
SOME_IMPOSSIBLE = 1  # exit status; 2 is that of an error


class CheckCommand(Command):
    """Check each problem of a file in a world, for a robot and a model of people."""

    help: ClassVar[str] = f"which problems of a file can be run: {USAGE}"

    def run(self, arguments: Sequence[str]) -> int:
        """Print a line for each problem; return 0 where all are possible, 1 where some are not. Raise ArenaError for an unreadable file."""
        if "-h" in arguments or "--help" in arguments:
            print(self.help)
            return 0
        words = read_words(USAGE, arguments, names=1, overrides=KINDS)
        path = Path(words.names[0])
        node = _composed(path, words.overrides)
        task = node["task"]
        file = read_scenario_file(path, PersonDefaults(task["pedestrian_speed"], task["pedestrian_radius"]))
        site = _Site(path, node)
        findings = [(problem.name, site.reason_against(problem)) for problem in file.problems]
        impossible = [reason for _, reason in findings if reason]
        print("\n".join(aligned([(name, "impossible" if reason else "possible", reason) for name, reason in findings])))
        if notes := noted(file.problems):
            print(f"read otherwise: {notes}")
        print(f"{path}: {len(findings) - len(impossible)} of {len(findings)} problems possible in {site.world.name} for {site.robot.name}")
        return SOME_IMPOSSIBLE if impossible else 0


class _Site:
    """Where the problems of a file are to be run, and by whom."""

    def __init__(self, path: Path, node: dict[str, Any]) -> None:
        registry = load_registry()
        self._path = path
        self.robot: Robot = registry.build("robot", node["robot"])
        self.world: World = registry.build("world", node["world"]).world(0, 0)
        self._people: PedestrianModel = registry.build("pedestrians", node["pedestrians"])
        self._goal_radius, self._time_limit = node["task"]["goal_radius"], node["task"]["time_limit"]

    def reason_against(self, problem: Problem) -> str:
        """Return why a problem cannot be run here, in one line; empty where it can."""
        goal_radius = problem.goal_radius or self._goal_radius
        try:
            furnished(problem.placed_in(self.world)).derive(Feasibility(self._path, problem, self.robot, goal_radius))
            self._people.reset(np.zeros(1, np.int64), [self._scenario(problem, goal_radius)], 1)
        except ArenaError as error:
            return str(error).removeprefix(f"{self._path}: ")
        return ""

    def _scenario(self, problem: Problem, goal_radius: float) -> Scenario:
        return Scenario(
            name=problem.name,
            seed=0,
            world=problem.placed_in(self.world),
            start=problem.start,
            goal=problem.goal,
            pedestrians=problem.pedestrians,
            obstacles=problem.obstacles,
            goal_radius=goal_radius,
            time_limit=problem.time_limit or self._time_limit,
        )


def _composed(path: Path, overrides: Sequence[str]) -> dict[str, Any]:
    """Return the components of a run of the file, in the map that it names unless a world is given; raise ConfigurationError."""
    quoted = "'" + str(path).replace("\\", "\\\\").replace("'", "\\'") + "'"
    usual = [f"{kind}={name}" for kind, name in USUAL.items() if not any(word.startswith(f"{kind}=") for word in overrides)]
    node = plain(compose([*usual, "task=scenario", f"task.path={quoted}", *overrides], "component"))
    if "robot" not in node:  # which is optional in a configuration of single components
        allowed = ", ".join(option_files("robot", load_registry().manager))
        raise ConfigurationError(f"{next(word for word in overrides if word.startswith('robot='))}; allowed: {allowed}")
    return node
