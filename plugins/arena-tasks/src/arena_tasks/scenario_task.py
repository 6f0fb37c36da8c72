"""Problems from a file, in the order of the file, again and again."""

from __future__ import annotations

from bisect import bisect_right
from itertools import accumulate

from arena_core import ConfigurationError, Positive, Robot, Scenario, TaskMode, WorldSource, local_path
from arena_tasks.content import content_hash
from arena_tasks.feasibility import Feasibility
from arena_tasks.pack import checked_pack, hash_of
from arena_tasks.problem import PersonDefaults
from arena_tasks.scenario_file import read_scenarios


class ScenarioTask(TaskMode):
    """Each problem comes as often as it says in a row, then the next one; each repetition has random streams of its own.

    ``path`` is a JSON file, our own or of arena-tools; the map is ``world``'s, whatever the file says. What the file leaves open is
    ``pedestrian_speed`` m/s, ``pedestrian_radius`` m, ``goal_radius`` m and ``time_limit`` s. A file in a pack must be as it was packed.
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
        file = local_path(path)
        self._pack = checked_pack(file.parent)
        if self._pack:
            self._pack.check_lists(file)
        self._problems = read_scenarios(file, PersonDefaults(pedestrian_speed, pedestrian_radius))
        self._ends = list(accumulate(problem.repeats for problem in self._problems))
        self._file_hash = hash_of(file)
        self._checks = [Feasibility(file, problem, robot, problem.goal_radius or goal_radius) for problem in self._problems]
        self._world = world
        self._goal_radius = goal_radius
        self._time_limit = time_limit
        if world.world(0, 0).grid is world.world(1, 1).grid:  # a fixed world: say what is impossible before anything runs
            for check in self._checks:
                world.world(0, 0).grid.derive(check)

    def scenario(self, seed: int, index: int) -> Scenario:
        """Return problem ``index``; raise ImpossibleScenario when it does not fit the world."""
        number, repetition = self._place(index)
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
            content_hash=content_hash(self._file_hash, world.grid, self._pack),
        )

    def _place(self, index: int) -> tuple[int, int]:
        """Return which problem comes at ``index``, and how often it came before."""
        rounds, position = divmod(index, self._ends[-1])
        number = bisect_right(self._ends, position)
        repeats = self._problems[number].repeats
        return number, rounds * repeats + position - (self._ends[number] - repeats)
