"""Where the problems of a file are to be run, and by whom: what a configuration makes of it."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from arena_core import ArenaError, ConfigurationError, PedestrianModel, PedestrianSpec, Robot, Scenario, World
from arena_core.files import option_files
from arena_core.hosting import compose, load_registry, to_plain
from arena_core.scenes import add_furniture
from arena_tasks.scenario_files.feasibility import Feasibility, Finding
from arena_tasks.scenario_files.problem import Problem

# what is checked unless told otherwise
USUAL = {"world": "scenario_map", "robot": "turtlebot3", "pedestrians": "social_force"}
KINDS = (*USUAL, "task")


class Site:
    """The world, the robot and the model of people in which the problems of the file at ``path`` are to be run."""

    def __init__(self, path: Path, node: dict[str, Any]) -> None:
        registry = load_registry()
        self._path = path
        self.robot: Robot = registry.build("robot", node["robot"])
        self.world: World = registry.build("world", node["world"]).world(0, 0)
        self._people: PedestrianModel = registry.build("pedestrians", node["pedestrians"])
        self.goal_radius, self._time_limit = node["task"]["goal_radius"], node["task"]["time_limit"]

    def reason_against(self, problem: Problem) -> str:
        """Return why a problem cannot be run here, in one line; empty where it can."""
        return next((finding.line for finding in self.findings(problem)), "")

    def findings(self, problem: Problem) -> Iterator[Finding]:
        """Yield all that keeps a problem from being run here: first what lies wrong, then what
        the model of people refuses.
        """
        check = Feasibility(self._path, problem, self.robot, problem.goal_radius or self.goal_radius)
        misplaced = set[str]()
        for finding in check.findings(add_furniture(problem.placed_in(self.world))):
            misplaced.add(finding.key)
            yield finding
        people = [
            pair for pair in zip(problem.keys.people, problem.pedestrians, strict=True) if pair[0] not in misplaced
        ]
        alone = [(key, self._people_objection(problem, (person,))) for key, person in people]
        yield from (Finding(key, math.nan, math.nan, why) for key, why in alone if why)
        together = (
            "" if misplaced or any(why for _, why in alone) else self._people_objection(problem, problem.pedestrians)
        )
        if together:
            yield Finding("", math.nan, math.nan, together)

    def _people_objection(self, problem: Problem, people: tuple[PedestrianSpec, ...]) -> str:
        """Return why the model of people does not take these of a problem's, empty where it does."""
        try:
            self._people.reset(np.zeros(1, np.int64), [self._make_scenario(problem, people)], 1)
        except ArenaError as error:
            return str(error).removeprefix(f"{self._path}: ")
        return ""

    def _make_scenario(self, problem: Problem, people: tuple[PedestrianSpec, ...]) -> Scenario:
        return Scenario(
            name=problem.name,
            seed=0,
            world=problem.placed_in(self.world),
            start=problem.start,
            goal=problem.goal,
            pedestrians=people,
            obstacles=problem.obstacles,
            doors=problem.doors,
            goal_radius=problem.goal_radius or self.goal_radius,
            time_limit=problem.time_limit or self._time_limit,
        )


def compose_run(path: Path, overrides: Sequence[str]) -> dict[str, Any]:
    """Return the components of a run of the file, in the map that it names unless a world is
    given; raise ConfigurationError.
    """
    quoted = "'" + str(path).replace("\\", "\\\\").replace("'", "\\'") + "'"
    usual = [
        f"{kind}={name}" for kind, name in USUAL.items() if not any(word.startswith(f"{kind}=") for word in overrides)
    ]
    node = to_plain(compose([*usual, "task=scenario", f"task.path={quoted}", *overrides], "component"))
    if "robot" not in node:  # which is optional in a configuration of single components
        allowed = ", ".join(option_files("robot", load_registry().manager))
        raise ConfigurationError(f"{next(word for word in overrides if word.startswith('robot='))}; allowed: {allowed}")
    return node
