"""Problems from a file, in the order of the file, again and again."""

from __future__ import annotations

from pathlib import Path

from arena_core import ConfigurationError, Positive, Robot, Scenario, TaskMode, WorldSource
from arena_tasks.feasibility import Feasibility
from arena_tasks.problem import PersonDefaults
from arena_tasks.scenario_file import read_scenarios


class ScenarioTask(TaskMode):
    """Scenario ``index`` is problem ``index`` modulo their number; each repetition has random streams of its own.

    ``path`` is a JSON file, our own or of arena-tools; the map is ``world``'s, whatever the file says. What the file leaves open is
    ``pedestrian_speed`` m/s, ``pedestrian_radius`` m, ``goal_radius`` m and ``time_limit`` s.
    """

    def __init__(
        self,
        robot: Robot,
        world: WorldSource,
        path: str | None,
        pedestrian_speed: Positive,
        pedestrian_radius: Positive,
        goal_radius: Positive,
        time_limit: Positive,
    ) -> None:
        if path is None:
            raise ConfigurationError("task.path is null; allowed: a scenario file, as in task.path=scenario.json")
        file = Path(path)
        self._problems = read_scenarios(file, PersonDefaults(pedestrian_speed, pedestrian_radius))
        self._checks = [Feasibility(file, problem, robot, problem.goal_radius or goal_radius) for problem in self._problems]
        self._world = world
        self._goal_radius = goal_radius
        self._time_limit = time_limit
        if world.world(0, 0).grid is world.world(1, 1).grid:  # a fixed world: say what is impossible before anything runs
            for check in self._checks:
                world.world(0, 0).grid.derive(check)

    def scenario(self, seed: int, index: int) -> Scenario:
        """Return problem ``index``; raise ImpossibleScenario when it does not fit the world."""
        repetition, number = divmod(index, len(self._problems))
        problem, world = self._problems[number], self._world.world(seed, index)
        world.grid.derive(self._checks[number])
        return Scenario(
            name=f"{problem.name}/{repetition:04d}",
            seed=seed,
            world=world,
            start=problem.start,
            goal=problem.goal,
            pedestrians=problem.pedestrians,
            obstacles=problem.obstacles,
            goal_radius=problem.goal_radius or self._goal_radius,
            time_limit=problem.time_limit or self._time_limit,
        )
